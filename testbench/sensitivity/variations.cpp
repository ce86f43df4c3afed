#include "testbench/sensitivity/variations.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "model/config/chip_parameters.hpp"

namespace testbench {
namespace {

using model::ParameterInfo;
using model::ParameterValue;

/// To as many digits as people write.
double rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.10g", value);
  return std::strtod(text, nullptr);
}

/// Tries the values of one parameter.
class Varier {
 public:
  Varier(const model::ChipConfig& chip, const ParameterInfo& parameter, Variations& variations)
      : chip_(chip), parameter_(parameter), variations_(variations), value_(parameter.read(chip)) {}

  void vary(double share) {
    if (const auto* const choice = std::get_if<model::Choice>(&parameter_.allowed))
      return alternatives(*choice);
    if (const auto* const is_on = std::get_if<bool>(&value_)) return add(VariationKind::alternative, !*is_on);
    if (is_zero()) return vary_zero();
    if (const auto* const number = std::get_if<double>(&value_)) {
      add(VariationKind::lower, rounded(*number * (1 - share)));
      add(VariationKind::higher, rounded(*number * (1 + share)));
    } else {
      add_integer(VariationKind::lower, integer(-share), std::get<std::int64_t>(value_) / 2);
      add_integer(VariationKind::higher, integer(share), std::get<std::int64_t>(value_) * 2);
    }
  }

 private:
  bool is_zero() const { return value_ == ParameterValue(0.0) || value_ == ParameterValue(std::int64_t{0}); }

  void vary_zero() {
    if (parameter_.unit.rfind("cycles", 0) != 0) return leave_out("it is 0, of which there is no share");
    if (std::holds_alternative<double>(value_)) return add(VariationKind::alternative, 1.0);
    add(VariationKind::alternative, std::int64_t{1});
  }

  /// The value and a share of it, on the parameter's grid.
  std::int64_t integer(double share) const {
    const auto& range = std::get<model::IntegerRange>(parameter_.allowed);
    const std::int64_t value = std::get<std::int64_t>(value_);
    if (range.power_of_two) return share < 0 ? value / 2 : value * 2;
    const auto steps =
        std::max<std::int64_t>(1, std::llround(double(value) * std::abs(share) / double(range.multiple_of)));
    return value + (share < 0 ? -steps : steps) * range.multiple_of;
  }

  void alternatives(const model::Choice& choice) {
    for (const std::string_view name : choice)
      if (ParameterValue(std::string(name)) != value_) add(VariationKind::alternative, std::string(name));
  }

  void add(VariationKind kind, const ParameterValue& value) {
    if (const std::string reason = try_to_add(kind, value); !reason.empty()) leave_out(reason);
  }

  /// Sizes must often be multiples of one another: half and twice as many are where a share is not.
  void add_integer(VariationKind kind, std::int64_t value, std::int64_t otherwise) {
    const std::string reason = try_to_add(kind, value);
    if (!reason.empty() && !try_to_add(kind, otherwise).empty()) leave_out(reason);
  }

  /// Why the chip cannot be; "" if it can.
  std::string try_to_add(VariationKind kind, const ParameterValue& value) {
    Variation variation{parameter_.key, kind, model::value_text(value),
                        parameter_.effect == model::Effect::stream, chip_};
    try {
      model::set_parameter_value(variation.chip, parameter_.key, value, "");
      model::validate(variation.chip);
    } catch (const model::ConfigError& error) {
      return error.what();
    }
    variations_.list.push_back(std::move(variation));
    return "";
  }

  void leave_out(const std::string& reason) { variations_.left_out.push_back({parameter_.key, reason}); }

  const model::ChipConfig& chip_;
  const ParameterInfo& parameter_;
  Variations& variations_;
  ParameterValue value_;
};

}  // namespace

Variations variations_of(const model::ChipConfig& chip, double share, const std::vector<std::string>& only) {
  Variations variations;
  for (const ParameterInfo& parameter : model::parameter_table()) {
    const auto begins_key = [&](const std::string& text) { return parameter.key.rfind(text, 0) == 0; };
    if (!only.empty() && std::none_of(only.begin(), only.end(), begins_key)) continue;
    Varier(chip, parameter, variations).vary(share);
  }
  return variations;
}

}  // namespace testbench
