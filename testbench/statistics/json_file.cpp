#include "testbench/statistics/json_file.hpp"

#include <algorithm>

#include "testbench/system/error.hpp"
#include "testbench/system/nesting.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// The characters of a text, for a parser, and the line that it has come to.
class LineCounter {
 public:
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;
  using iterator_category = std::input_iterator_tag;

  LineCounter(const char* place, std::size_t& line) : place_(place), line_(&line) {}
  reference operator*() const { return *place_; }
  LineCounter& operator++() {
    *line_ += *place_++ == '\n';
    return *this;
  }
  bool operator==(const LineCounter& other) const { return place_ == other.place_; }
  bool operator!=(const LineCounter& other) const { return place_ != other.place_; }

 private:
  const char* place_;
  std::size_t* line_;
};

/// Follows a parser to the value at a path.
class PathFinder : public nlohmann::json_sax<Json> {
 public:
  PathFinder(const std::string& wanted, const std::size_t& line) : wanted_(wanted), line_(line) {}

  std::size_t found() const { return found_; }

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(std::int64_t) override { return value(); }
  bool number_unsigned(std::uint64_t) override { return value(); }
  bool number_float(double, const std::string&) override { return value(); }
  bool string(std::string&) override { return value(); }
  bool binary(Json::binary_t&) override { return value(); }
  bool start_object(std::size_t) override { return open(false); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_array() override { return close(); }
  bool key(std::string& name) override {
    levels_.back().name = name;
    return look();
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  struct Level {
    bool is_array;
    std::size_t index;
    std::string name;
  };

  bool value() {
    const bool goes_on = levels_.empty() || !levels_.back().is_array || look();
    if (!levels_.empty()) ++levels_.back().index;
    return goes_on;
  }
  bool open(bool is_array) {
    if (!levels_.empty() && levels_.back().is_array && !look()) return false;
    levels_.push_back({is_array, 0, ""});
    return true;
  }
  bool close() {
    levels_.pop_back();
    if (!levels_.empty()) ++levels_.back().index;
    return true;
  }
  /// Whether to go on: no longer once the wanted value is there.
  bool look() {
    std::string path;
    for (const Level& level : levels_)
      path += (path.empty() ? "" : ".") + (level.is_array ? std::to_string(level.index) : level.name);
    if (path != wanted_) return true;
    found_ = line_;
    return false;
  }

  const std::string& wanted_;
  const std::size_t& line_;
  std::size_t found_ = 1;
  std::vector<Level> levels_;
};

/// The line of the text, from 1, in which the value at `path` begins; 1 for the whole text.
std::size_t line_of(const std::string& text, const std::string& path) {
  std::size_t line = 1;
  PathFinder finder(path, line);
  Json::sax_parse(LineCounter(text.data(), line), LineCounter(text.data() + text.size(), line), &finder);
  return finder.found();
}

bool is_of(JsonType type, const Json& json) {
  switch (type) {
    case JsonType::text:
      return json.is_string();
    case JsonType::flag:
      return json.is_boolean();
    case JsonType::count:
      return json.is_number_unsigned() || (json.is_number_integer() && json >= 0);
    case JsonType::number:
      return json.is_number();
    case JsonType::number_or_none:
      return json.is_number() || json.is_null();
    case JsonType::scalar:
      return json.is_primitive();
    case JsonType::list:
      return json.is_array();
    case JsonType::object:
      return json.is_object();
    case JsonType::any:
      return true;
  }
  return false;
}

const char* name_of(JsonType type) {
  switch (type) {
    case JsonType::text:
      return "a text";
    case JsonType::flag:
      return "true or false";
    case JsonType::count:
      return "an integer of 0 or more";
    case JsonType::number:
      return "a number";
    case JsonType::number_or_none:
      return "a number or null";
    case JsonType::scalar:
      return "one value";
    case JsonType::list:
      return "a list";
    case JsonType::object:
      return "an object";
    case JsonType::any:
      return "any value";
  }
  return "";
}

std::string found_text(const Json& json) {
  constexpr std::size_t kLongest = 40;
  if (json.is_structured()) return json.is_array() ? "a list" : "an object";
  const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

/// Looks for a row's values below `json`.
class SchemaCheck {
 public:
  SchemaCheck(const SchemaRow& row, const std::string& text, const std::string& origin,
              std::size_t first_line)
      : row_(row), text_(text), origin_(origin), first_line_(first_line) {}

  /// @param path of `json`
  /// @param rest of the row's key, from there
  void require(const Json& json, const std::string& path, const std::string& rest) const {
    if (rest.empty()) {
      if (!is_of(row_.type, json)) refuse(path, path, found_text(json), name_of(row_.type));
      return;
    }
    const std::string name = rest.substr(0, rest.find('.'));
    const std::string behind = name.size() == rest.size() ? "" : rest.substr(name.size() + 1);
    const std::string prefix = path.empty() ? "" : path + ".";
    if (name == "*") {
      if (!json.is_structured()) refuse(path, path, found_text(json), "a list or an object");
      std::size_t index = 0;
      for (const auto& [member, value] : json.items())
        require(value, prefix + (json.is_array() ? std::to_string(index++) : member), behind);
    } else if (!json.is_object()) {
      refuse(path, path, found_text(json), "an object");
    } else if (const auto found = json.find(name); found != json.end()) {
      require(*found, prefix + name, behind);
    } else if (row_.required) {
      refuse(prefix + name, path, "none", name_of(behind.empty() ? row_.type : JsonType::object));
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& key, const std::string& place, const std::string& found,
                           const std::string& allowed) const {
    const std::size_t line = first_line_ - 1 + line_of(text_, place);
    throw InputError(origin_ + ":" + std::to_string(line) + ": " + key + ": found " + found +
                     "; allowed: " + allowed);
  }

  const SchemaRow& row_;
  const std::string& text_;
  const std::string& origin_;
  std::size_t first_line_;
};

}  // namespace

std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

namespace {

/// Of one object: for each new member, the JSON library looks through those before it.
constexpr std::size_t kMostMembers = 10'000;
/// Of a key and those that it lies in: what flattens a file writes the whole path of each value.
constexpr std::size_t kMostPathCharacters = 512;

/// Parses a text whose objects have at most kMostMembers members.
Json parse_few_members(const std::string& text, const std::string& origin) {
  std::vector<std::size_t> members;  // of the objects that are open
  return Json::parse(text, [&](int, Json::parse_event_t event, Json&) {
    if (event == Json::parse_event_t::object_start) members.push_back(0);
    if (event == Json::parse_event_t::object_end) members.pop_back();
    if (event == Json::parse_event_t::key && ++members.back() > kMostMembers)
      throw InputError(origin + ": found an object of more than " + std::to_string(kMostMembers) +
                       " members; allowed: at most so many");
    return true;
  });
}

/// @param length of the path to `json`
void require_short_paths(const Json& json, std::size_t length, const std::string& origin) {
  if (length > kMostPathCharacters)
    throw InputError(origin + ": found a key of " + std::to_string(length) +
                     " characters, with those that it lies in; allowed: at most " +
                     std::to_string(kMostPathCharacters));
  if (json.is_object())
    for (const auto& [name, value] : json.items())
      require_short_paths(value, length + name.size() + 1, origin);
  if (!json.is_array()) return;
  for (const Json& element : json) {
    const bool is_named = element.is_object() && element.contains("name") && element["name"].is_string();
    const std::size_t name_size = is_named ? element["name"].get_ref<const std::string&>().size() : 1;
    require_short_paths(element, length + name_size + 1, origin);
  }
}

}  // namespace

Json parse_json_object(const std::string& text, const std::string& origin, const std::string& allowed,
                       std::size_t first_line) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InputError(origin + ": found an empty file; allowed: " + allowed);
  require_shallow_json(text, origin, first_line);
  try {
    Json json = parse_few_members(text, origin);
    if (!json.is_object()) throw InputError(origin + ": found no JSON object; allowed: " + allowed);
    require_short_paths(json, 0, origin);
    return json;
  } catch (const Json::parse_error& error) {
    const std::size_t end = std::min(text.size(), std::size_t(error.byte));
    const auto line =
        std::ptrdiff_t(first_line) + std::count(text.begin(), text.begin() + std::ptrdiff_t(end), '\n');
    throw InputError(origin + ":" + std::to_string(line) +
                     ": found no JSON object that is whole; allowed: " + allowed);
  } catch (const Json::exception&) {
    throw InputError(origin + ": found a number out of range; allowed: " + allowed);
  }
}

void require_schema(const Json& json, const Schema& schema, const std::string& text,
                    const std::string& origin, std::size_t first_line) {
  for (const SchemaRow& row : schema) SchemaCheck(row, text, origin, first_line).require(json, "", row.key);
}

}  // namespace testbench
