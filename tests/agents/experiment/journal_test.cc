#include "agents/experiment/journal.h"

#include <gmock/gmock.h>

#include "base/files.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;

// Whose every field says which action of which world it belongs to.
class TellingWorld final : public Environment {
 public:
  explicit TellingWorld(int& acted) : acted_(acted) {}
  std::vector<int> ActionCounts() const override { return {9, 9, 9, 9}; }
  Snapshot Start(StartKind, std::uint64_t seed) override { return "start" + std::to_string(seed); }
  Percept Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) override {
    value_ = static_cast<int>(snapshot.size() + 100 * sensor_seed);
    return {};
  }
  Outcome Act(int action) override {
    ++acted_;
    const int v = value_ + action;
    Outcome outcome;
    outcome.next = {v % 4, {0.1 * v, 1e-300}};
    outcome.reward = v / 7.0;
    outcome.done = outcome.true_success = v % 2 == 0;
    outcome.success = v % 2 == 1;
    outcome.truth = {v + 1,   v % 2 == 0, v % 2 == 1, v % 3 == 0, v / 3.0,
                     v / 5.0, v / 9.0,    v / 11.0,   v + 2};
    outcome.after = std::string("a\n\0\xff", 4) + std::to_string(v);
    outcome.sim_s = v / 13.0;
    outcome.log = {{"z", v}, {"a", "text"}};
    return outcome;
  }
  FrameWriter Frames() const override { return {}; }

 private:
  int& acted_;
  int value_ = 0;
};

class Journal : public FolderTest {
 protected:
  JournalEnvironment Opened(const std::string& actor = "1") {
    return {std::make_unique<TellingWorld>(acted_), dir_ / "journal", actor};
  }
  // Three actions, each in what the one before left. @returns all that came of them.
  static std::string Episode(Environment& environment, std::uint64_t noise = 5) {
    std::string all;
    Snapshot world = environment.Start(StartKind::kFolded, 1);
    for (int i = 0; i < 3; ++i) {
      environment.Begin(world, noise + static_cast<std::uint64_t>(i));
      Outcome outcome = environment.Act(i);
      const Truth& truth = outcome.truth;
      all += nlohmann::json({outcome.next.state, outcome.next.features, outcome.reward,
                             outcome.done, outcome.success, outcome.true_success, outcome.sim_s,
                             truth.layers_held, truth.bag_held, truth.cube_held, truth.cube_in_bag,
                             truth.lowest_point_m, truth.held_clear_s, truth.bag_area_px2,
                             truth.opening_area_px2, truth.state})
                 .dump() +
             outcome.log.dump() + outcome.after;
      world = std::move(outcome.after);
    }
    return all;
  }
  int acted_ = 0;
};

TEST_F(Journal, WhatWasDoneIsAnsweredAndNotDoneAgain) {
  int acted = 0;
  TellingWorld plain(acted);
  const std::string expected = Episode(plain);
  JournalEnvironment first = Opened();
  EXPECT_EQ(Episode(first), expected);
  EXPECT_EQ(acted_, 3);
  JournalEnvironment second = Opened();
  EXPECT_EQ(Episode(second), expected);
  EXPECT_EQ(acted_, 3);
}

TEST_F(Journal, OtherNoiseAndAnotherActorAreNotWhatWasDone) {
  JournalEnvironment first = Opened();
  Episode(first);
  Episode(first, 100);
  EXPECT_EQ(acted_, 6);
  JournalEnvironment other = Opened("2");
  Episode(other);
  EXPECT_EQ(acted_, 9);
}

TEST_F(Journal, WhatIsBrokenIsDoneAgain) {
  JournalEnvironment first = Opened();
  const std::string expected = Episode(first);
  for (const auto& one : fs::directory_iterator(dir_ / "journal")) {
    WriteFileAtomic(one.path(), "{\"next_state\": \"x\"}\n");
  }
  JournalEnvironment second = Opened(), third = Opened();
  EXPECT_EQ(Episode(second), expected);
  EXPECT_EQ(acted_, 6);
  EXPECT_EQ(Episode(third), expected);
  EXPECT_EQ(acted_, 6);
}

}  // namespace
}  // namespace gusset
