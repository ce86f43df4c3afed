#include "testbench/statistics/chip_config_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "model/config/chip_parameters.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// A real number without a fraction is written as chip files write it, without a point.
Json parameter_json(const model::ParameterValue& value) {
  constexpr double kExactIntegers = 0x1p53;
  if (const double* const real = std::get_if<double>(&value))
    if (*real == std::floor(*real) && std::abs(*real) < kExactIntegers) return std::int64_t(*real);
  return std::visit([](const auto& held) { return Json(held); }, value);
}

}  // namespace

Json chip_config_json(const model::ChipConfig& chip) {
  Json json = {{"preset", chip.preset}};
  for (const model::ParameterInfo& parameter : model::parameter_table()) {
    std::string path = parameter.key;
    std::replace(path.begin(), path.end(), '.', '/');
    json[Json::json_pointer("/" + path)] = parameter_json(parameter.read(chip));
  }
  return json;
}

}  // namespace testbench
