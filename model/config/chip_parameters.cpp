#include "model/config/chip_parameters.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>

namespace model {
namespace {

/// Calls the handler of the alternative that `variant` holds.
template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

/// Fewest insertions, deletions and replacements of a character that turn `from` into `to` (Levenshtein).
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

const std::string& nearest_key(std::string_view key) {
  const auto nearer = [key](const ParameterInfo& a, const ParameterInfo& b) {
    return edit_distance(key, a.key) < edit_distance(key, b.key);
  };
  return std::min_element(parameter_table().begin(), parameter_table().end(), nearer)->key;
}

std::string with_origin(std::string_view origin, const std::string& message) {
  return origin.empty() ? message : std::string(origin) + ": " + message;
}

const ParameterInfo& known_parameter(std::string_view key, std::string_view origin) {
  if (const ParameterInfo* parameter = find_parameter(key)) return *parameter;
  throw ConfigError(with_origin(origin, "unknown parameter '" + std::string(key) + "'; nearest known: '" +
                                            nearest_key(key) +
                                            "'; allowed: the keys listed by 'csx600 params'"));
}

[[noreturn]] void refuse(const ParameterInfo& parameter, std::string_view found, std::string_view origin) {
  throw ConfigError(with_origin(
      origin, parameter.key + ": found '" + std::string(found) + "'; allowed: " + allowed_text(parameter)));
}

/// Describes a value of the wrong type by its type, too, which the text alone does not show ("150", 150.0).
std::string typed_text(const ParameterValue& value) {
  constexpr std::array<std::string_view, 4> kTypes = {"boolean ", "integer ", "real ", "string "};
  return std::string(kTypes[value.index()]) + value_text(value);
}

template <class Number>
std::optional<ParameterValue> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return ParameterValue(number);
}

/// Reads `text` as the kind of value that `parameter` holds; std::nullopt if it is not one.
std::optional<ParameterValue> parse(const ParameterInfo& parameter, std::string_view text) {
  const Overloaded parser{[&](const TrueOrFalse&) -> std::optional<ParameterValue> {
                            if (text == "true") return ParameterValue(true);
                            if (text == "false") return ParameterValue(false);
                            return std::nullopt;
                          },
                          [&](const IntegerRange&) { return parse_number<std::int64_t>(text); },
                          [&](const RealRange&) { return parse_number<double>(text); },
                          [&](const Choice&) { return std::optional<ParameterValue>(std::string(text)); }};
  return std::visit(parser, parameter.allowed);
}

/// Checks kind and range. NaN is in no range.
bool is_allowed(const ParameterInfo& parameter, const ParameterValue& value) {
  if (parameter.allowed.index() != value.index()) return false;
  const Overloaded check{
      [](const TrueOrFalse&) { return true; },
      [&](const IntegerRange& range) {
        const std::int64_t number = std::get<std::int64_t>(value);
        return number >= range.low && number <= range.high && number % range.multiple_of == 0 &&
               (!range.power_of_two || (number & (number - 1)) == 0);
      },
      [&](const RealRange& range) {
        const double number = std::get<double>(value);
        return number >= range.low && number <= range.high;
      },
      [&](const Choice& names) {
        return std::find(names.begin(), names.end(), std::get<std::string>(value)) != names.end();
      }};
  return std::visit(check, parameter.allowed);
}

/// Shortest text that reads back to `number`; without an exponent where that stays readable.
std::string real_text(double number) {
  std::array<char, 64> buffer;
  const double magnitude = std::fabs(number);
  const bool plain = magnitude == 0 || (magnitude >= 1e-5 && magnitude < 1e16);
  const std::to_chars_result result =
      plain ? std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::fixed)
            : std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  return {buffer.data(), result.ptr};
}

/// A rule between two parameters, whose message names both. The range of each alone has been checked.
void require(bool holds, const ChipConfig& config, std::string_view key, const std::string& allowed,
             std::string_view other_key, std::string_view origin) {
  if (holds) return;
  throw ConfigError(with_origin(origin, std::string(key) + ": found '" + parameter_text(config, key) +
                                            "'; allowed: " + allowed + " " + std::string(other_key) + " (" +
                                            parameter_text(config, other_key) + ")"));
}

void validate_search_unit(const ChipConfig& config, std::string_view origin) {
  const ChipConfig::SearchUnit& unit = config.search_unit;
  if (unit.units == 0) return;
  const std::string multiple = "a multiple of";
  require(unit.cache_bytes % (unit.cache_line_bytes * unit.cache_ways) == 0, config,
          "search_unit.cache_bytes",
          "a multiple of search_unit.cache_line_bytes (" + std::to_string(unit.cache_line_bytes) + ") times",
          "search_unit.cache_ways", origin);
  require(unit.cache_line_bytes <= config.clear_connect.packet_bytes, config, "search_unit.cache_line_bytes",
          "at most", "clear_connect.packet_bytes", origin);
  require(config.ddr.page_bytes % unit.cache_line_bytes == 0, config, "ddr.page_bytes", multiple,
          "search_unit.cache_line_bytes", origin);
  require(unit.first_address >= config.ddr.size_bytes, config, "search_unit.first_address", "at least",
          "ddr.size_bytes", origin);
  const ChipConfig::OnChipSram& sram = config.on_chip_sram;
  const bool is_before = unit.first_address + unit.buffer_bytes <= sram.first_address;
  const bool is_behind = unit.first_address >= sram.first_address + sram.size_bytes;
  require(sram.size_bytes == 0 || is_before || is_behind, config, "search_unit.first_address",
          "addresses outside the on-chip SRAM, which begins at", "on_chip_sram.first_address", origin);
  require(config.chip.arrays == 1, config, "search_unit.units", "0 on a chip of several arrays,",
          "chip.arrays", origin);
}

}  // namespace

std::string_view confidence_name(Confidence confidence) {
  return kConfidenceNames[static_cast<std::size_t>(confidence)];
}

const ParameterInfo* find_parameter(std::string_view key) {
  for (const ParameterInfo& parameter : parameter_table()) {
    if (parameter.key == key) return &parameter;
  }
  return nullptr;
}

std::string allowed_text(const ParameterInfo& parameter) {
  const Overloaded describe{
      [](const TrueOrFalse&) { return std::string("true or false"); },
      [](const IntegerRange& range) {
        const std::string text = (range.power_of_two ? "a power of two from " : "an integer from ") +
                                 std::to_string(range.low) + " to " + std::to_string(range.high);
        return range.multiple_of == 1 ? text : text + ", a multiple of " + std::to_string(range.multiple_of);
      },
      [](const RealRange& range) {
        return "a number from " + real_text(range.low) + " to " + real_text(range.high);
      },
      [](const Choice& names) {
        std::string text;
        for (const std::string_view name : names)
          text += (text.empty() ? "one of " : ", ") + std::string(name);
        return text;
      }};
  return std::visit(describe, parameter.allowed);
}

std::string value_text(const ParameterValue& value) {
  const Overloaded write{[](bool flag) { return std::string(flag ? "true" : "false"); },
                         [](std::int64_t number) { return std::to_string(number); },
                         [](double number) { return real_text(number); },
                         [](const std::string& name) { return name; }};
  return std::visit(write, value);
}

ChipConfig default_chip_config() {
  ChipConfig config{};
  config.preset = "csx600";
  for (const ParameterInfo& parameter : parameter_table()) parameter.write(config, parameter.default_value);
  return config;
}

void set_parameter(ChipConfig& config, std::string_view key, std::string_view text, std::string_view origin) {
  const ParameterInfo& parameter = known_parameter(key, origin);
  const std::optional<ParameterValue> value = parse(parameter, text);
  if (!value || !is_allowed(parameter, *value)) refuse(parameter, text, origin);
  parameter.write(config, *value);
}

void set_parameter_value(ChipConfig& config, std::string_view key, const ParameterValue& value,
                         std::string_view origin) {
  const ParameterInfo& parameter = known_parameter(key, origin);
  if (parameter.allowed.index() != value.index()) refuse(parameter, typed_text(value), origin);
  if (!is_allowed(parameter, value)) refuse(parameter, value_text(value), origin);
  parameter.write(config, value);
}

std::string parameter_text(const ChipConfig& config, std::string_view key) {
  return value_text(known_parameter(key, {}).read(config));
}

void validate(const ChipConfig& config, std::string_view origin) {
  for (const ParameterInfo& parameter : parameter_table()) {
    const ParameterValue value = parameter.read(config);
    if (!is_allowed(parameter, value)) refuse(parameter, value_text(value), origin);
  }
  const ChipConfig::Control& control = config.control;
  const ChipConfig::Ddr& ddr = config.ddr;
  const std::string multiple = "a multiple of";
  require(control.data_cache_bytes % control.cache_line_bytes == 0, config, "control.data_cache_bytes",
          multiple, "control.cache_line_bytes", origin);
  require(config.clear_connect.packet_bytes >= config.clear_connect.bytes_per_cycle, config,
          "clear_connect.packet_bytes", "at least", "clear_connect.bytes_per_cycle", origin);
  require(ddr.page_bytes % control.cache_line_bytes == 0, config, "ddr.page_bytes", multiple,
          "control.cache_line_bytes", origin);
  require(ddr.page_bytes % config.clear_connect.packet_bytes == 0, config, "ddr.page_bytes", multiple,
          "clear_connect.packet_bytes", origin);
  require(ddr.page_miss_cycles >= ddr.page_hit_cycles, config, "ddr.page_miss_cycles", "at least",
          "ddr.page_hit_cycles", origin);
  require(ddr.size_bytes % (std::uint64_t(ddr.banks) * std::uint64_t(ddr.page_bytes)) == 0, config,
          "ddr.size_bytes", "a multiple of ddr.banks (" + std::to_string(ddr.banks) + ") times",
          "ddr.page_bytes", origin);
  const ChipConfig::OnChipSram& sram = config.on_chip_sram;
  const auto line_bytes = std::uint64_t(control.cache_line_bytes);
  require(sram.size_bytes == 0 || sram.first_address >= ddr.size_bytes, config, "on_chip_sram.first_address",
          "at least", "ddr.size_bytes", origin);
  require(sram.size_bytes == 0 || sram.first_address % line_bytes == 0, config, "on_chip_sram.first_address",
          multiple, "control.cache_line_bytes", origin);
  require(sram.size_bytes % line_bytes == 0, config, "on_chip_sram.size_bytes", multiple,
          "control.cache_line_bytes", origin);
  validate_search_unit(config, origin);
  require(ddr.refresh_interval_cycles == 0 || ddr.refresh_cycles < ddr.refresh_interval_cycles, config,
          "ddr.refresh_cycles", "less than", "ddr.refresh_interval_cycles", origin);
}

}  // namespace model
