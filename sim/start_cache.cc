#include "sim/start_cache.h"

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace gusset {
namespace {

std::uint64_t Fnv1a(const std::string& text) {
  std::uint64_t h = 0xcbf29ce484222325ull;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return h;
}

std::string Hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::optional<std::string> ReadAll(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace

StartCache::StartCache() {
  const char* set = std::getenv("GUSSET_CACHE");
  const char* xdg = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  if (set) {
    folder_ = set;
  } else if (xdg && *xdg) {
    folder_ = std::filesystem::path(xdg) / "gusset";
  } else if (home && *home) {
    folder_ = std::filesystem::path(home) / ".cache" / "gusset";
  }
  if (folder_.empty()) return;
  // Another build may step the cloth otherwise, so its starts are not this one's.
  const std::optional<std::string> program = ReadAll("/proc/self/exe");
  if (!program) {
    folder_.clear();
    return;
  }
  program_ = Hex(Fnv1a(*program));
}

std::filesystem::path StartCache::FileOf(const std::string& key) const {
  return folder_ / "starts" / program_ / (Hex(Fnv1a(key)) + ".start");
}

std::optional<std::string> StartCache::Find(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  const std::optional<std::string> text = ReadAll(FileOf(key));
  // key, newline, hash of the value, newline, value
  const std::size_t head = key.size() + 18;
  if (!text || text->size() < head || text->compare(0, key.size(), key) != 0) return std::nullopt;
  std::string value = text->substr(head);
  if (text->compare(key.size(), 18, "\n" + Hex(Fnv1a(value)) + "\n") != 0) return std::nullopt;
  return value;
}

void StartCache::Keep(const std::string& key, const std::string& value) const {
  if (folder_.empty()) return;
  const std::filesystem::path file = FileOf(key);
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  const std::filesystem::path part = file.string() + "." + std::to_string(getpid()) + ".part";
  bool written = false;
  {
    std::ofstream out(part, std::ios::binary);
    out << key << '\n' << Hex(Fnv1a(value)) << '\n' << value;
    out.close();
    written = out.good();
  }
  if (written) std::filesystem::rename(part, file, error);
  if (!written || error) std::filesystem::remove(part, error);
}

}  // namespace gusset
