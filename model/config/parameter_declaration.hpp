#pragma once

#include <string>
#include <utility>
#include <vector>

#include "model/config/chip_parameters.hpp"

/// Ties a declaration of the parameter table to its field of ChipConfig. Only the table's own sources include
/// this.
namespace model {

inline ParameterValue to_value(bool field) {
  return field;
}
inline ParameterValue to_value(int field) {
  return std::int64_t{field};
}
inline ParameterValue to_value(std::uint64_t field) {
  return static_cast<std::int64_t>(field);
}
inline ParameterValue to_value(double field) {
  return field;
}
inline ParameterValue to_value(PioArbitration field) {
  return std::string(kPioArbitrationNames.at(static_cast<std::size_t>(field)));
}

inline void from_value(const ParameterValue& value, bool& field) {
  field = std::get<bool>(value);
}
inline void from_value(const ParameterValue& value, int& field) {
  field = static_cast<int>(std::get<std::int64_t>(value));
}
inline void from_value(const ParameterValue& value, std::uint64_t& field) {
  field = static_cast<std::uint64_t>(std::get<std::int64_t>(value));
}
inline void from_value(const ParameterValue& value, double& field) {
  field = std::get<double>(value) + 0.0;  // no negative zero
}
inline void from_value(const ParameterValue& value, PioArbitration& field) {
  const std::string& name = std::get<std::string>(value);
  for (std::size_t i = 0; i < kPioArbitrationNames.size(); ++i) {
    if (kPioArbitrationNames[i] == name) field = static_cast<PioArbitration>(i);
  }
}

/// A field of ChipConfig, `group` and `member` being pointers to members.
template <auto group, auto member>
struct Field {
  static ParameterValue read(const ChipConfig& config) { return to_value(config.*group.*member); }
  static void write(ChipConfig& config, const ParameterValue& value) {
    from_value(value, config.*group.*member);
  }
};

template <auto group, auto member>
ParameterInfo integer(std::string key, std::string unit, std::int64_t default_value, IntegerRange range,
                      Confidence confidence, std::string meaning) {
  using F = Field<group, member>;
  return {std::move(key), std::move(unit),    default_value, range,
          confidence,     std::move(meaning), &F::read,      &F::write};
}

template <auto group, auto member>
ParameterInfo real(std::string key, std::string unit, double default_value, RealRange range,
                   Confidence confidence, std::string meaning) {
  using F = Field<group, member>;
  return {std::move(key), std::move(unit),    default_value, range,
          confidence,     std::move(meaning), &F::read,      &F::write};
}

/// Declares process, voltage and the energy parameters (energy_parameters.cpp).
void declare_energy(std::vector<ParameterInfo>& table);
/// Declare the search unit's parameters and areas (search_unit_parameters.cpp).
void declare_search_unit(std::vector<ParameterInfo>& table);
void declare_area(std::vector<ParameterInfo>& table);

}  // namespace model
