#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "firmware/path_tracer/program/program_config.hpp"

/// The options of the firmware. Command line, sweeps, golden grids, statistics, `csx600 params` and the
/// documents take name, range, default and meaning from this table and from nowhere else.
namespace path_tracer {

/// Names of the enumerations' values, in the order of the values.
inline constexpr std::array kProgramNames = {"segments", "direct", "full"};
inline constexpr std::array kExecutionNames = {"mtap", "stream"};
inline constexpr std::array kPathsNames = {"unidirectional", "bidirectional"};
inline constexpr std::array kSamplerNames = {"philox", "sobol"};
inline constexpr std::array kLightSamplingNames = {"area", "solid_angle"};
inline constexpr std::array kEstimatorNames = {"light", "mis", "per_lobe"};
inline constexpr std::array kShadingNames = {"every_lobe", "present_lobes", "material_bins", "texture_bins"};
inline constexpr std::array kScratchpadNames = {"none", "nodes", "triangles", "fitting"};
inline constexpr std::array kTraversalNames = {"brute_force",   "temporary_bin", "refill",
                                               "lock_step",     "packets",       "shared_treelets",
                                               "large_packets", "ray_streams",   "ray_unit"};
inline constexpr std::array kNodeFormatNames = {"fp64", "fp32", "quantised8"};

inline const char* name_of(Program program) {
  return kProgramNames.at(std::size_t(program));
}
inline const char* name_of(Execution execution) {
  return kExecutionNames.at(std::size_t(execution));
}
inline const char* name_of(Paths paths) {
  return kPathsNames.at(std::size_t(paths));
}
inline const char* name_of(Sampler sampler) {
  return kSamplerNames.at(std::size_t(sampler));
}
inline const char* name_of(LightSampling sampling) {
  return kLightSamplingNames.at(std::size_t(sampling));
}
inline const char* name_of(Estimator estimator) {
  return kEstimatorNames.at(std::size_t(estimator));
}
inline const char* name_of(Shading shading) {
  return kShadingNames.at(std::size_t(shading));
}
inline const char* name_of(Scratchpad scratchpad) {
  return kScratchpadNames.at(std::size_t(scratchpad));
}
inline const char* name_of(Traversal traversal) {
  return kTraversalNames.at(std::size_t(traversal));
}
inline const char* name_of(NodeFormat format) {
  return kNodeFormatNames.at(std::size_t(format));
}

/// What an option holds, whatever its C++ type: a choice is held by its name.
using OptionValue = std::variant<std::int64_t, std::uint64_t, double, std::string>;

struct IntegerRange {
  std::int64_t low;
  std::int64_t high;
  std::int64_t multiple_of = 1;
};
using IntegerList = std::vector<std::int64_t>;
struct Unsigned64 {};
/// Without its ends.
struct OpenInterval {
  double low;
  double high;
};
using Names = std::vector<std::string>;
using AllowedValues = std::variant<IntegerRange, IntegerList, Unsigned64, OpenInterval, Names>;

/// What options are about; those of a group follow each other in the table.
enum class OptionGroup : std::uint8_t { bins, sampling, tree };
inline constexpr std::array kOptionGroupNames = {"stages and bins", "sampling", "finding triangles"};
const char* name_of(OptionGroup group);

/// One option: the only declaration of its name, default, range and meaning.
struct ProgramOption {
  std::string name;  ///< "bin_blocks" is --bin-blocks on the command line, firmware.bin_blocks in files
  std::string unit;  ///< "-" for a number without one and for names
  OptionValue default_value;  ///< of default_program()
  AllowedValues allowed;
  std::string meaning;

  OptionValue (*read)(const ProgramConfig&);
  void (*write)(ProgramConfig&, const OptionValue&);  ///< unchecked

  OptionGroup group = OptionGroup::bins;
  std::string chosen = {};  ///< how `csx600 render` chooses what was not given; "": it takes the default
};

/// Every option, group by group.
const std::vector<ProgramOption>& program_options();

/// nullptr for an unknown name.
const ProgramOption* find_option(std::string_view name);

/// The firmware of the table's defaults.
ProgramConfig default_program();

/// "an integer from 4 to 4096, a multiple of 4"
std::string allowed_text(const ProgramOption& option);

/// As command lines and files spell it; a number in the shortest form that reads back to the same.
std::string value_text(const OptionValue& value);

/// The value that a program has for an option, as text. The name is one of the table.
std::string option_text(const ProgramConfig& program, std::string_view name);

/// The value that a text stands for; none if the option does not allow it.
std::optional<OptionValue> value_of(const ProgramOption& option, std::string_view text);
bool is_allowed(const ProgramOption& option, const OptionValue& value);

}  // namespace path_tracer
