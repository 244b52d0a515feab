#include "sim/snapshot.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "base/error.h"
#include "base/fnv1a.h"

namespace gusset {
namespace {

constexpr std::string_view kMagic = "gusset snapshot 2\n";

class Writer {
 public:
  void Value(bool value) { Value(static_cast<std::uint8_t>(value)); }
  template <class T>
  void Value(const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  void Values(const T* data, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) Value(data[i]);
  }
  void Size(std::size_t n) { Value(static_cast<std::uint64_t>(n)); }

  std::string bytes{kMagic};
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {
    if (!bytes.starts_with(kMagic)) throw InputError("not a gusset snapshot");
    at_ = kMagic.size();
  }
  void Value(bool& value) {
    std::uint8_t byte;
    Value(byte);
    if (byte > 1) throw InputError("snapshot holds a truth value that is none");
    value = byte == 1;
  }
  template <class T>
  void Value(T& value) {
    if (bytes_.size() - at_ < sizeof value) throw InputError("snapshot is cut short");
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) throw InputError("snapshot holds a number that is not finite");
    }
  }
  template <class T>
  void Values(T* data, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) Value(data[i]);
  }
  std::size_t Size() {
    std::uint64_t n;
    Value(n);
    // No list is longer than one entry per byte that is left.
    if (n > bytes_.size() - at_) throw InputError("snapshot is cut short");
    return static_cast<std::size_t>(n);
  }
  void End() const {
    if (at_ != bytes_.size()) throw InputError("snapshot has more bytes than it should");
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

// One list of fields serves both directions: Stream is Writer or Reader.
template <class Stream, class World, class Robot>
void Visit(Stream& s, World& world, Robot& robot) {
  constexpr bool kReading = std::is_same_v<Stream, Reader>;
  const auto list = [&](auto& values, auto each) {
    if constexpr (kReading) {
      values.resize(s.Size());
    } else {
      s.Size(values.size());
    }
    for (auto& value : values) each(value);
  };
  const auto vec3 = [&](auto& v) { s.Values(v.data(), 3); };
  const auto plain = [&](auto& v) { s.Value(v); };
  const auto pose = [&](auto& X) { s.Values(X.matrix().data(), 16); };
  s.Value(world.time_s);
  list(world.cloth.x, vec3);
  list(world.cloth.v, vec3);
  list(world.cloth.bend_set, plain);
  list(world.cloth.stretch_set, plain);
  list(world.cloth.shear_set, plain);
  list(world.cloth.held, [&](auto& held) {
    s.Values(held.node.data(), 3);
    s.Values(held.weight.data(), 3);
    s.Values(held.p_T.data(), 3);
    s.Value(held.share);
    s.Value(held.layer);
  });
  list(world.cloth.tether_m, plain);
  list(world.cloth.tether_to, plain);
  s.Value(world.cloth.hold_limit_N);
  s.Value(world.cloth.pad_half_width_m);
  s.Value(world.cloth.pad_height_m);
  pose(world.cube.X_WB);
  vec3(world.cube.v_m_s);
  vec3(world.cube.w_rad_s);
  s.Value(world.cube_held);
  pose(world.X_TCube);
  s.Value(world.hold_force_N);
  s.Value(world.rest_s);
  s.Value(world.held_clear_s);
  if constexpr (kReading) {
    const std::size_t joints = s.Size();
    if (joints > static_cast<std::size_t>(kMaxArmJoints)) {
      throw InputError("snapshot is of another robot");
    }
    robot.q.resize(static_cast<Eigen::Index>(joints));
  } else {
    s.Size(static_cast<std::size_t>(robot.q.size()));
  }
  s.Values(robot.q.data(), static_cast<std::size_t>(robot.q.size()));
  s.Value(robot.opening_m);
  s.Value(robot.holding);
}

}  // namespace

std::string PackSnapshot(const WorldState& world, const SimRobotState& robot) {
  Writer writer;
  Visit(writer, world, robot);
  writer.Value(Fnv1a(writer.bytes));  // any bit that changes is found
  return std::move(writer.bytes);
}

void UnpackSnapshot(const std::string& bytes, WorldState& world, SimRobotState& robot) {
  std::uint64_t sum = 0;
  const std::size_t end = bytes.size() - std::min(bytes.size(), sizeof sum);
  std::memcpy(&sum, bytes.data() + end, bytes.size() - end);
  const std::string_view content(bytes.data(), end);
  Reader reader(content);
  if (Fnv1a(content) != sum) throw InputError("snapshot is damaged");
  Visit(reader, world, robot);
  reader.End();
}

}  // namespace gusset
