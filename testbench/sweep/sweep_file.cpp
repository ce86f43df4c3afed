#include "testbench/sweep/sweep_file.hpp"

#include <cmath>
#include <filesystem>
#include <set>

#include "testbench/files/input_file.hpp"
#include "testbench/plug_in/firmware_path.hpp"
#include "testbench/plug_in/plug_in_settings.hpp"
#include "testbench/run/toml_settings.hpp"
#include "testbench/statistics/renamed_keys.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/nesting.hpp"

namespace testbench {
namespace {

constexpr const char* kNameCharacters = "abcdefghijklmnopqrstuvwxyz0123456789_";
constexpr std::size_t kMostSteps = 100'000;
constexpr std::size_t kMostAxisValues = 200'000;  ///< of all keys on axes

toml::table parse(const std::string& path) {
  const std::string text = read_input_file(path, "a readable TOML file", kMostTomlBytes);
  require_shallow_toml(text, path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    throw InputError(path + ":" + std::to_string(error.source().begin.line) +
                     ": not TOML: " + std::string(error.description()));
  }
}

/// Reads one file.
class SweepReader {
 public:
  explicit SweepReader(const std::string& path) { sweep_.path = path; }

  SweepFile read() {
    const toml::table file = parse(sweep_.path);
    for (const auto& [name, node] : file) {
      const std::string key(name.str());
      if (key == "axis") {
        read_axes(node);
      } else if (key == "audit") {
        read_audit(node);
      } else if (key == "constraint") {
        sweep_.constraints = read_expressions(node, key);
      } else if (key == "derived") {
        sweep_.derived = read_expressions(node, key);
      } else {
        read_base(node, key);
      }
    }
    return std::move(sweep_);
  }

 private:
  [[noreturn]] void refuse(const toml::node& node, const std::string& key, const std::string& found,
                           const std::string& allowed) const {
    throw InputError(line_of(sweep_.path, node) + ": " + key + ": found " + found + "; allowed: " + allowed);
  }

  Setting setting(const toml::node& node, const std::string& key, const std::string& value) const {
    Setting made{key, value, line_of(sweep_.path, node)};
    const bool names_file = key == "scene" || (key == kFirmwareKey && is_firmware_file(value)) ||
                            (key == "chip" && std::filesystem::path(value).extension() == ".toml");
    if (names_file && !std::filesystem::path(value).is_absolute())
      made.value = (std::filesystem::path(sweep_.path).parent_path() / value).lexically_normal().string();
    require_setting(made);
    return made;
  }

  void read_base(const toml::node& node, const std::string& key) {
    if (const toml::table* const group = node.as_table()) {
      for (const auto& [name, value] : *group) read_base(value, key + "." + std::string(name.str()));
      return;
    }
    const std::optional<std::string> value = scalar_text(node);
    if (!value) refuse(node, key, found_text(node), "one value; a list belongs in an [[axis]]");
    require_once(node, key);
    sweep_.base.push_back(setting(node, key, *value));
  }

  void read_audit(const toml::node& node) {
    const toml::table* const audit = node.as_table();
    if (audit == nullptr) refuse(node, "audit", found_text(node), "audit.share and audit.seed");
    for (const auto& [name, value] : *audit) {
      const std::string key = "audit." + std::string(name.str());
      if (key == "audit.share") {
        const auto share = value.value<double>();
        if (!share || !(*share >= 0 && *share <= 1))
          refuse(value, key, found_text(value), "a number from 0 to 1");
        sweep_.audit_share = *share;
      } else if (key == "audit.seed") {
        const auto seed = value.value_exact<std::int64_t>();
        if (!seed || *seed < 0) refuse(value, key, found_text(value), "an integer of 0 or more");
        sweep_.audit_seed = std::uint64_t(*seed);
      } else {
        refuse(value, key, "an unknown key", "audit.share and audit.seed");
      }
    }
  }

  std::vector<NamedExpression> read_expressions(const toml::node& node, const std::string& group) const {
    const toml::table* const table = node.as_table();
    if (table == nullptr) refuse(node, group, found_text(node), "[" + group + "] with name = \"expression\"");
    std::vector<NamedExpression> expressions;
    for (const auto& [name, value] : *table)
      expressions.push_back(read_expression(value, group, std::string(name.str())));
    return expressions;
  }

  NamedExpression read_expression(const toml::node& node, const std::string& group,
                                  const std::string& name) const {
    const std::string key = group + "." + name;
    if (name.empty() || name.find_first_not_of(kNameCharacters) != std::string::npos)
      refuse(node, group, "'" + name + "'", "names of a-z, 0-9 and _");
    const toml::table* const with_unit = node.as_table();
    const toml::node* const text = with_unit != nullptr ? with_unit->get("expression") : &node;
    if (text == nullptr || !text->is_string())
      refuse(node, key, found_text(node), R"("expression" or { expression = "...", unit = "..." })");
    NamedExpression made{name, Expression(**text->as_string(), line_of(sweep_.path, node) + ": " + key), "-"};
    if (with_unit == nullptr) return made;
    for (const auto& [part, value] : *with_unit) {
      if (part == "expression") continue;
      if (part != "unit" || !value.is_string())
        refuse(value, key, "'" + std::string(part.str()) + "'", "expression and unit, which are texts");
      made.unit = **value.as_string();
    }
    return made;
  }

  void read_axes(const toml::node& node) {
    const toml::array* const axes = node.as_array();
    if (axes == nullptr || axes->empty() || !axes->is_array_of_tables())
      refuse(node, "axis", found_text(node), "[[axis]], each with one key or more");
    for (const toml::node& axis : *axes) {
      sweep_.axes.emplace_back();
      read_axis(*axis.as_table());
      if (sweep_.axes.back().keys.empty()) refuse(axis, "axis", "no key", "one key or more");
    }
  }

  static bool is_range(const toml::table& table) { return table.contains("from") || table.contains("to"); }

  void read_axis(const toml::table& table) {
    for (const auto& [key, node] : leaves_of(table, is_range)) {
      const toml::table* const as_range = node->as_table();
      add_key(*node, key, as_range != nullptr ? range(*as_range, key) : list(*node, key));
    }
  }

  void add_key(const toml::node& node, const std::string& key, const std::vector<std::string>& values) {
    SweepAxis& axis = sweep_.axes.back();
    require_once(node, key);
    require_few(node, key, values.size());
    if (axis.keys.empty()) axis.steps.resize(values.size());
    if (values.size() != axis.steps.size())
      refuse(node, key, std::to_string(values.size()) + " values",
             std::to_string(axis.steps.size()) + ", as many as " + axis.keys.front() +
                 " of the same axis has (keys of one axis change together)");
    axis.keys.push_back(key);
    for (std::size_t i = 0; i < values.size(); ++i) axis.steps[i].push_back(setting(node, key, values[i]));
  }

  std::vector<std::string> list(const toml::node& node, const std::string& key) const {
    const toml::array* const array = node.as_array();
    const std::string allowed = "a list of values, or { from, to } with step, factor or count";
    if (array == nullptr) refuse(node, key, found_text(node), allowed);
    if (array->empty()) refuse(node, key, "an empty list", allowed);
    if (array->size() > kMostSteps)
      refuse(node, key, std::to_string(array->size()) + " values", "at most " + std::to_string(kMostSteps));
    std::vector<std::string> values;
    std::set<std::string> known;
    for (const toml::node& element : *array) {
      const std::optional<std::string> value = scalar_text(element);
      if (!value) refuse(element, key, found_text(element) + " in a list", "values");
      if (!known.insert(*value).second && sweep_.axes.back().keys.empty())
        refuse(element, key, "'" + *value + "' twice", "each value once");
      values.push_back(*value);
    }
    return values;
  }

  double number(const toml::table& table, const std::string& key, const char* name) const {
    const toml::node* const node = table.get(name);
    const std::optional<double> value = node != nullptr ? node->value<double>() : std::nullopt;
    if (node == nullptr)
      refuse(table, key, std::string("a range without ") + name, "{ from, to } and how to get there");
    if (!value || !std::isfinite(*value))
      refuse(*node, key + "." + name, found_text(*node), "a finite number");
    return *value;
  }

  /// { from, to, step | factor | count }; with `count`, geometric = true for equal ratios.
  std::vector<std::string> range(const toml::table& table, const std::string& key) const {
    static const std::set<std::string> kNames = {"from", "to", "step", "factor", "count", "geometric"};
    for (const auto& [name, node] : table)
      if (kNames.count(std::string(name.str())) == 0)
        refuse(node, key, "'" + std::string(name.str()) + "' in a range",
               "from, to and one of step, factor, count");
    if (table.contains("step") + table.contains("factor") + table.contains("count") != 1)
      refuse(table, key, "a range with none or several of step, factor, count", "exactly one of them");
    const double from = number(table, key, "from");
    const double to = number(table, key, "to");
    if (from == to)
      refuse(table, key, "a range from " + model::value_text(from) + " to itself",
             "two different ends, or a list of one value");
    const bool whole = table["from"].is_integer() && table["to"].is_integer();
    if (table.contains("step")) return stepped(table, key, from, to);
    if (table.contains("factor")) return multiplied(table, key, from, to);
    return counted(table, key, from, to, whole);
  }

  std::vector<std::string> stepped(const toml::table& table, const std::string& key, double from,
                                   double to) const {
    const double step = number(table, key, "step");
    const double steps = (to - from) / step;
    if (step == 0 || steps < 0 || steps >= kMostSteps)
      refuse(table, key, "a step of " + model::value_text(step),
             "one that leads from `from` to `to` in fewer than " + std::to_string(kMostSteps) + " steps");
    std::vector<std::string> values;
    for (int i = 0; i <= static_cast<int>(steps + 1e-9); ++i)
      values.push_back(model::value_text(from + i * step));
    return values;
  }

  std::vector<std::string> multiplied(const toml::table& table, const std::string& key, double from,
                                      double to) const {
    const double factor = number(table, key, "factor");
    if (!(factor > 1) || !(from > 0) || to < from)
      refuse(table, key, "a factor of " + model::value_text(factor),
             "one above 1, from a positive number up to a larger one");
    std::vector<std::string> values;
    for (double value = from; value <= to * (1 + 1e-12); value *= factor) {
      values.push_back(model::value_text(value));
      if (values.size() > kMostSteps)
        refuse(table, key, "more steps", "at most " + std::to_string(kMostSteps));
    }
    return values;
  }

  std::vector<std::string> counted(const toml::table& table, const std::string& key, double from, double to,
                                   bool whole) const {
    const double count = number(table, key, "count");
    const bool geometric = table["geometric"].value_or(false);
    if (count < 2 || count > kMostSteps || count != std::floor(count))
      refuse(table, key, "a count of " + model::value_text(count),
             "an integer from 2 to " + std::to_string(kMostSteps));
    if (geometric && !(from > 0 && to > 0))
      refuse(table, key, "geometric steps from or to a number that is not positive", "positive numbers");
    std::vector<std::string> values;
    for (int i = 0; i < static_cast<int>(count); ++i) {
      const double share = i / (count - 1);
      const double value = geometric ? from * std::pow(to / from, share) : from + (to - from) * share;
      std::string text = model::value_text(whole ? std::round(value) : value);
      if (values.empty() || values.back() != text) values.push_back(std::move(text));
    }
    return values;
  }

  void require_once(const toml::node& node, const std::string& key) {
    if (!seen_.insert(key).second) refuse(node, key, "twice in the sweep", "once, as a value or on an axis");
  }

  /// Before `count` values of a key are added to the last axis.
  void require_few(const toml::node& node, const std::string& key, std::size_t count) {
    axis_values_ += count;
    if (axis_values_ > kMostAxisValues)
      refuse(node, key, std::to_string(axis_values_) + " values on all axes",
             "at most " + std::to_string(kMostAxisValues));
    if (sweep_.axes.back().keys.empty()) points_ *= count;
    if (points_ > kMostSweepPoints)
      refuse(node, "axis", "a product of " + std::to_string(points_) + " points",
             "at most " + std::to_string(kMostSweepPoints));
  }

  SweepFile sweep_;
  std::set<std::string> seen_;  ///< keys
  std::size_t axis_values_ = 0;
  std::uint64_t points_ = 1;
};

}  // namespace

void require_setting(const Setting& setting) {
  if (is_plug_in_key(setting.key)) return;  // the firmware's own file says what is allowed
  if (!is_setting(setting.key)) require_current_key(setting.origin, setting.key);
  require_allowed(setting);
}

std::vector<std::string> SweepFile::keys() const {
  std::vector<std::string> all;
  for (const SweepAxis& axis : axes) all.insert(all.end(), axis.keys.begin(), axis.keys.end());
  return all;
}

std::uint64_t SweepFile::points() const {
  std::uint64_t product = 1;
  for (const SweepAxis& axis : axes) product *= axis.steps.size();
  return product;
}

SweepFile load_sweep_file(const std::string& path) {
  return SweepReader(path).read();
}

}  // namespace testbench
