#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gusset {

/// Inclusive bounds of a number; outside them a config is refused.
struct Range {
  double lo = 0;
  double hi = 0;
};

/// What a config struct shows its fields to. A config struct is plain data with defaults and one
/// member `template <class V> void Fields(V& v)` (or `void Fields(ConfigVisitor& v)`) that lists
/// every field once: the same list reads a file, checks bounds and writes the resolved config.
class ConfigVisitor {
 public:
  virtual ~ConfigVisitor() = default;
  virtual void operator()(const char* key, double& value, Range bounds) = 0;
  virtual void operator()(const char* key, int& value, Range bounds) = 0;
  virtual void operator()(const char* key, bool& value) = 0;
  /// @param choices if not empty, the only values allowed.
  virtual void operator()(const char* key, std::string& value,
                          const std::vector<std::string>& choices) = 0;
  /// A list of numbers whose length must stay `value.size()`.
  virtual void operator()(const char* key, std::vector<double>& value, Range bounds) = 0;
};

/// A TOML document (or several, later ones winning) that remembers where each value came from, so
/// that an error can say `bag1.toml:12: cloth.friction = 3 is not within [0.2, 0.8]`.
class ConfigTree {
 public:
  ConfigTree();
  ~ConfigTree();
  ConfigTree(ConfigTree&&) noexcept;
  ConfigTree& operator=(ConfigTree&&) noexcept;
  ConfigTree(const ConfigTree& other);
  ConfigTree& operator=(const ConfigTree& other);

  /// Reads `file` over what is there. @throws InputError if it cannot be read or parsed.
  void Load(const std::filesystem::path& file);
  /// As Load, from text; `name` stands for the file in errors.
  void Parse(std::string_view text, std::string_view name);
  /// Forgets every key that has the value `file` gives it, as if that file had never been read.
  /// @throws InputError if it cannot be read or parsed.
  void Forget(const std::filesystem::path& file);
  /// One `--set` argument, `section.key=value` (value as in TOML; a bare word is a string).
  /// @param origin  what errors call the source, if another option stands for the assignment.
  void Set(std::string_view assignment, std::string_view origin = "--set");

  /// As Set, for a text that is not to be quoted.
  void SetText(std::string_view key, const std::string& text, std::string_view origin);

  /// Fills `config` from table `section` (dotted; "" is the root) and marks what it read as known.
  /// @throws InputError for a wrong type or a value out of bounds.
  template <class Config>
  void Read(std::string_view section, Config& config) {
    const std::unique_ptr<ConfigVisitor> reader = Reader(section);
    config.Fields(*reader);
  }
  /// Keys that no Read has asked for are errors. @throws InputError naming the first one.
  void RefuseUnknown() const;
  /// True if there is a table or a key of this name.
  bool Has(std::string_view name) const;
  /// Refuses the value of `key` for a reason that its bounds do not know, as where two values do
  /// not go together. @throws InputError "file:line: key = value why", without file if none gave
  /// it.
  [[noreturn]] void Refuse(std::string_view key, double value, const std::string& why) const;
  /// Refuses `key` if a file or an option gives it. @throws InputError as Refuse.
  void RefuseIfGiven(std::string_view key, const std::string& why) const;

 private:
  std::unique_ptr<ConfigVisitor> Reader(std::string_view section);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Bounds check without a file, for configs made in code. @throws InputError.
std::unique_ptr<ConfigVisitor> BoundsChecker(std::string_view section);
/// Appends `[section]` with every field to `out`, in TOML, numbers to the last digit.
std::unique_ptr<ConfigVisitor> TomlWriter(std::string_view section, std::string& out);

template <class Config>
void ValidateOrThrow(std::string_view section, Config config) {
  const std::unique_ptr<ConfigVisitor> checker = BoundsChecker(section);
  config.Fields(*checker);
}

template <class Config>
void AppendToml(std::string_view section, Config config, std::string& out) {
  const std::unique_ptr<ConfigVisitor> writer = TomlWriter(section, out);
  config.Fields(*writer);
}

/// What AppendToml wrote, which has one value per line and no comments, as section.key: value.
std::map<std::string, std::string> FlattenResolved(const std::string& toml);

/// The folder with bags, robots, published results and the report's page: $GUSSET_ASSETS, else the
/// source tree's assets/.
/// @throws InputError if it is not a folder.
std::filesystem::path AssetsFolder();

}  // namespace gusset
