#include "base/config.h"

// toml++ 3.3 asserts on some malformed input where it should throw parse_error.
#define TOML_ASSERT(expression) static_cast<void>(0)
#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <type_traits>
#include <utility>
#include <variant>

#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

// What no config field can be: a date, a list of strings, a list of tables.
struct Unusable {};
using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, Unusable>;

struct Entry {
  Value value;
  std::string origin;  // "bag1.toml:12" or "--set"
};

// A config file is written by hand; anything larger is another kind of file.
constexpr std::size_t kMaxConfigBytes = 4 << 20;
// One key of many parts fills one line; toml++ needs stack for each part, and time for each two.
constexpr std::size_t kMaxLineBytes = 10000;

std::string Dotted(std::string_view section, std::string_view key) {
  return section.empty() ? std::string(key) : std::string(section) + "." + std::string(key);
}

// Shortest text that reads back to the same bits.
std::string Shortest(double x) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, x).ptr;
  return {buffer, end};
}

std::string Quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04X", static_cast<unsigned char>(c));
      out += escape;
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string Shown(const Value& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, bool>) return v ? "true" : "false";
        if constexpr (std::is_same_v<T, std::int64_t>) return std::to_string(v);
        if constexpr (std::is_same_v<T, double>) return Shortest(v);
        if constexpr (std::is_same_v<T, std::string>) return Quoted(v);
        if constexpr (std::is_same_v<T, std::vector<double>>) return "a list of numbers";
        return "a date, or a list of something other than numbers";
      },
      value);
}

// "bag1.toml:12: cloth.friction = 3 "; without a file just the key and its value.
[[noreturn]] void Refuse(const std::string& origin, const std::string& key,
                         const std::string& shown, const std::string& why) {
  throw InputError((origin.empty() ? "" : origin + ": ") + key + " = " + shown + " " + why);
}

// A negated comparison, so that NaN is refused too; infinity is never within finite bounds, and
// unbounded ranges do not make it meaningful.
bool Within(double x, Range bounds) { return std::isfinite(x) && x >= bounds.lo && x <= bounds.hi; }

[[noreturn]] void RefuseBounds(const std::string& origin, const std::string& key,
                               const std::string& shown, Range bounds) {
  Refuse(origin, key, shown,
         "is not within [" + Shortest(bounds.lo) + ", " + Shortest(bounds.hi) + "]");
}

void CheckBounds(const std::string& origin, const std::string& key, double x, Range bounds) {
  if (!Within(x, bounds)) RefuseBounds(origin, key, Shortest(x), bounds);
}

void CheckChoice(const std::string& origin, const std::string& key, const std::string& text,
                 const std::vector<std::string>& choices) {
  if (choices.empty() || std::ranges::find(choices, text) != choices.end()) return;
  std::string list;
  for (const std::string& choice : choices) list += (list.empty() ? "" : ", ") + Quoted(choice);
  Refuse(origin, key, Quoted(text), "is not one of " + list);
}

Value ToValue(const toml::node& node) {
  if (const auto* b = node.as_boolean()) return b->get();
  if (const auto* i = node.as_integer()) return i->get();
  if (const auto* d = node.as_floating_point()) return d->get();
  if (const auto* s = node.as_string()) return s->get();
  const auto* array = node.as_array();
  if (array == nullptr) return Unusable{};
  std::vector<double> numbers;
  for (const toml::node& element : *array) {
    if (!element.is_number()) return Unusable{};
    numbers.push_back(*element.value<double>());
  }
  return numbers;
}

// 1 and 1.0 are the same.
bool Same(const Value& a, const Value& b) {
  const auto* list_a = std::get_if<std::vector<double>>(&a);
  const auto* list_b = std::get_if<std::vector<double>>(&b);
  return list_a != nullptr && list_b != nullptr ? *list_a == *list_b : Shown(a) == Shown(b);
}

// Levenshtein's distance: how many letters to change, add or drop.
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

struct ConfigTree::Impl {
  std::map<std::string, Entry> entries;         // by dotted key
  std::map<std::string, std::string> sections;  // dotted table name -> origin
  std::set<std::string> known_keys;
  std::set<std::string> known_sections;

  void Flatten(const toml::table& table, const std::string& prefix, const std::string& name,
               bool with_lines) {
    for (const auto& [key, node] : table) {
      const std::string path = Dotted(prefix, key.str());
      const std::string origin =
          with_lines ? name + ":" + std::to_string(node.source().begin.line) : name;
      if (const auto* inner = node.as_table()) {
        sections.insert_or_assign(path, origin);
        Flatten(*inner, path, name, with_lines);
      } else {
        entries.insert_or_assign(path, Entry{ToValue(node), origin});
      }
    }
  }

  std::string NearestKnown(const std::string& key) const {
    const std::set<std::string>& candidates = known_keys;
    std::string best;
    // A third of the letters wrong is no longer a slip of the pen.
    std::size_t least = std::max<std::size_t>(2, key.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
      const std::size_t distance = EditDistance(key, candidate);
      if (distance < least) {
        least = distance;
        best = candidate;
      }
    }
    return best;
  }
};

namespace {

class TreeReader final : public ConfigVisitor {
 public:
  TreeReader(const std::map<std::string, Entry>& entries, std::set<std::string>& known,
             std::string section)
      : entries_(entries), known_(known), section_(std::move(section)) {}

  void operator()(const char* key, double& value, Range bounds) override {
    const Found found = Find(key);
    if (found.entry == nullptr) return;
    double number = 0;
    if (const auto* d = std::get_if<double>(&found.entry->value)) {
      number = *d;
    } else if (const auto* i = std::get_if<std::int64_t>(&found.entry->value)) {
      number = static_cast<double>(*i);
    } else {
      WrongType(found, "must be a number");
    }
    CheckBounds(found.entry->origin, found.path, number, bounds);
    value = number;
  }

  void operator()(const char* key, int& value, Range bounds) override {
    const Found found = Find(key);
    if (found.entry == nullptr) return;
    const auto* i = std::get_if<std::int64_t>(&found.entry->value);
    if (i == nullptr) WrongType(found, "must be a whole number");
    if (!Within(static_cast<double>(*i), bounds)) {
      RefuseBounds(found.entry->origin, found.path, std::to_string(*i), bounds);
    }
    if (*i != static_cast<int>(*i)) WrongType(found, "does not fit into 32 bits");
    value = static_cast<int>(*i);
  }

  void operator()(const char* key, bool& value) override {
    const Found found = Find(key);
    if (found.entry == nullptr) return;
    const auto* b = std::get_if<bool>(&found.entry->value);
    if (b == nullptr) WrongType(found, "must be true or false");
    value = *b;
  }

  void operator()(const char* key, std::string& value,
                  const std::vector<std::string>& choices) override {
    const Found found = Find(key);
    if (found.entry == nullptr) return;
    const auto* text = std::get_if<std::string>(&found.entry->value);
    if (text == nullptr) WrongType(found, "must be a text in quotes");
    CheckChoice(found.entry->origin, found.path, *text, choices);
    value = *text;
  }

  void operator()(const char* key, std::vector<double>& value, Range bounds) override {
    const Found found = Find(key);
    if (found.entry == nullptr) return;
    const auto* list = std::get_if<std::vector<double>>(&found.entry->value);
    const std::string wanted = std::to_string(value.size()) + " numbers";
    if (list == nullptr) WrongType(found, "must be a list of " + wanted);
    if (list->size() != value.size()) {
      WrongType(found, "must have " + wanted + ", not " + std::to_string(list->size()));
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
      CheckBounds(found.entry->origin, found.path + "[" + std::to_string(i) + "]", (*list)[i],
                  bounds);
    }
    value = *list;
  }

 private:
  struct Found {
    std::string path;
    const Entry* entry = nullptr;
  };

  Found Find(const char* key) {
    Found found{Dotted(section_, key)};
    known_.insert(found.path);
    const auto it = entries_.find(found.path);
    if (it != entries_.end()) found.entry = &it->second;
    return found;
  }

  [[noreturn]] static void WrongType(const Found& found, const std::string& why) {
    Refuse(found.entry->origin, found.path, Shown(found.entry->value), why);
  }

  const std::map<std::string, Entry>& entries_;
  std::set<std::string>& known_;
  std::string section_;
};

class Checker final : public ConfigVisitor {
 public:
  explicit Checker(std::string_view section) : section_(section) {}
  void operator()(const char* key, double& value, Range bounds) override {
    CheckBounds("", Dotted(section_, key), value, bounds);
  }
  void operator()(const char* key, int& value, Range bounds) override {
    CheckBounds("", Dotted(section_, key), value, bounds);
  }
  void operator()(const char*, bool&) override {}
  void operator()(const char* key, std::string& value,
                  const std::vector<std::string>& choices) override {
    CheckChoice("", Dotted(section_, key), value, choices);
  }
  void operator()(const char* key, std::vector<double>& value, Range bounds) override {
    for (std::size_t i = 0; i < value.size(); ++i) {
      CheckBounds("", Dotted(section_, key) + "[" + std::to_string(i) + "]", value[i], bounds);
    }
  }

 private:
  std::string section_;
};

class Writer final : public ConfigVisitor {
 public:
  Writer(std::string_view section, std::string& out) : out_(out) {
    if (section.empty()) return;
    if (!out_.empty()) out_ += "\n";
    out_.append("[").append(section).append("]\n");
  }
  void operator()(const char* key, double& value, Range) override { Line(key, Float(value)); }
  void operator()(const char* key, int& value, Range) override { Line(key, std::to_string(value)); }
  void operator()(const char* key, bool& value) override { Line(key, value ? "true" : "false"); }
  void operator()(const char* key, std::string& value, const std::vector<std::string>&) override {
    Line(key, Quoted(value));
  }
  void operator()(const char* key, std::vector<double>& value, Range) override {
    std::string list;
    for (const double x : value) list += (list.empty() ? "" : ", ") + Float(x);
    Line(key, "[" + list + "]");
  }

 private:
  // TOML tells floats from integers by the point or the exponent.
  static std::string Float(double x) {
    const std::string text = Shortest(x);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
  }
  void Line(const char* key, const std::string& value) {
    out_ += std::string(key) + " = " + value + "\n";
  }

  std::string& out_;
};

bool IsBareWord(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.' ||
           c == '/';
  });
}

bool IsDottedKey(std::string_view text) {
  if (text.empty() || text.front() == '.' || text.back() == '.') return false;
  if (text.find("..") != std::string_view::npos) return false;
  return std::ranges::all_of(text, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.';
  });
}

std::string OneLine(std::string_view text) {
  std::string out(text);
  std::ranges::replace_if(
      out, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return out;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) {
    text.remove_prefix(1);
  }
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) {
    text.remove_suffix(1);
  }
  return text;
}

}  // namespace

ConfigTree::ConfigTree() : impl_(std::make_unique<Impl>()) {}
ConfigTree::~ConfigTree() = default;
ConfigTree::ConfigTree(ConfigTree&&) noexcept = default;
ConfigTree& ConfigTree::operator=(ConfigTree&&) noexcept = default;
ConfigTree::ConfigTree(const ConfigTree& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
ConfigTree& ConfigTree::operator=(const ConfigTree& other) {
  *impl_ = *other.impl_;
  return *this;
}

void ConfigTree::Load(const std::filesystem::path& file) {
  Parse(ReadFile(file, kMaxConfigBytes), file.string());
}

void ConfigTree::Parse(std::string_view text, std::string_view name) {
  int line = 1;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end - at > kMaxLineBytes) {
      throw InputError(std::string(name) + ":" + std::to_string(line) + ": is longer than " +
                       std::to_string(kMaxLineBytes) + " bytes");
    }
    at = end + 1;
  }
  try {
    impl_->Flatten(toml::parse(text), "", std::string(name), true);
  } catch (const toml::parse_error& e) {
    throw InputError(std::string(name) + ":" + std::to_string(e.source().begin.line) + ": " +
                     OneLine(e.description()));
  }
}

void ConfigTree::Forget(const std::filesystem::path& file) {
  ConfigTree other;
  other.Load(file);
  for (const auto& [key, entry] : other.impl_->entries) {
    const auto mine = impl_->entries.find(key);
    if (mine != impl_->entries.end() && Same(mine->second.value, entry.value)) {
      impl_->entries.erase(mine);
    }
  }
}

void ConfigTree::Set(std::string_view assignment, std::string_view origin) {
  const std::string source(origin);
  const std::size_t equals = assignment.find('=');
  const std::string_view key = Trimmed(assignment.substr(0, equals));
  if (assignment.size() > kMaxLineBytes) {
    throw InputError(source + ": " + std::string(assignment.substr(0, 40)) + "... is longer than " +
                     std::to_string(kMaxLineBytes) + " bytes");
  }
  if (equals == std::string_view::npos || !IsDottedKey(key)) {
    throw InputError(source + ": " + OneLine(assignment) + " is not section.key=value");
  }
  const std::string value(Trimmed(assignment.substr(equals + 1)));
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value);
  } catch (const toml::parse_error&) {
    if (!IsBareWord(value)) {
      throw InputError(source + ": " + std::string(key) + " = " + OneLine(value) +
                       " is not a TOML value");
    }
    parsed.insert_or_assign("value", value);
  }
  if (parsed.size() != 1) throw InputError(source + ": " + OneLine(assignment) + " sets two keys");
  toml::table renamed;
  renamed.insert_or_assign(key, std::move(*parsed.get("value")));
  impl_->Flatten(renamed, "", source, false);
}

void ConfigTree::SetText(std::string_view key, const std::string& text, std::string_view origin) {
  Set(std::string(key) + "=" + Quoted(text), origin);
}

std::unique_ptr<ConfigVisitor> ConfigTree::Reader(std::string_view section) {
  // Every table on the way to a section is known once the section is.
  for (std::size_t dot = 0; dot != std::string_view::npos;) {
    dot = section.find('.', dot + 1);
    impl_->known_sections.emplace(section.substr(0, dot));
  }
  const auto value = impl_->entries.find(std::string(section));
  if (value != impl_->entries.end()) {
    throw InputError(value->second.origin + ": " + std::string(section) +
                     " is a table, not a value");
  }
  return std::make_unique<TreeReader>(impl_->entries, impl_->known_keys, std::string(section));
}

void ConfigTree::RefuseUnknown() const {
  for (const auto& [key, entry] : impl_->entries) {
    if (impl_->known_keys.contains(key)) continue;
    const std::string nearest = impl_->NearestKnown(key);
    throw InputError(entry.origin + ": unknown key " + key +
                     (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
  }
  for (const auto& [section, origin] : impl_->sections) {
    if (impl_->known_sections.contains(section)) continue;
    if (impl_->known_keys.contains(section)) {
      throw InputError(origin + ": " + section + " is a value, not a table");
    }
    throw InputError(origin + ": unknown table " + section);
  }
}

bool ConfigTree::Has(std::string_view name) const {
  return impl_->sections.contains(std::string(name)) ||
         impl_->entries.contains(std::string(name)) ||
         std::ranges::any_of(impl_->entries, [prefix = std::string(name) + "."](const auto& e) {
           return e.first.starts_with(prefix);
         });
}

void ConfigTree::Refuse(std::string_view key, double value, const std::string& why) const {
  const auto entry = impl_->entries.find(std::string(key));
  gusset::Refuse(entry == impl_->entries.end() ? "" : entry->second.origin, std::string(key),
                 Shortest(value), why);
}

void ConfigTree::RefuseIfGiven(std::string_view key, const std::string& why) const {
  const auto entry = impl_->entries.find(std::string(key));
  if (entry == impl_->entries.end()) return;
  gusset::Refuse(entry->second.origin, std::string(key), Shown(entry->second.value), why);
}

std::unique_ptr<ConfigVisitor> BoundsChecker(std::string_view section) {
  return std::make_unique<Checker>(section);
}

std::unique_ptr<ConfigVisitor> TomlWriter(std::string_view section, std::string& out) {
  return std::make_unique<Writer>(section, out);
}

std::map<std::string, std::string> FlattenResolved(const std::string& toml) {
  std::map<std::string, std::string> values;
  std::istringstream lines(toml);
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) section = line.substr(1, line.find(']') - 1) + ".";
    const std::size_t equals = line.find(" = ");
    if (equals != std::string::npos) {
      values[section + line.substr(0, equals)] = line.substr(equals + 3);
    }
  }
  return values;
}

std::filesystem::path AssetsFolder() {
  const char* chosen = std::getenv("GUSSET_ASSETS");
  const std::filesystem::path folder = chosen != nullptr ? chosen : GUSSET_SOURCE_ASSETS;
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw InputError(folder.string() +
                     ": no such folder of assets; set GUSSET_ASSETS to the assets folder");
  }
  return folder;
}

}  // namespace gusset
