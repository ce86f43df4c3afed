#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "model/config/chip_config.hpp"

namespace model {

/// A chip that cannot be: unknown key or preset, value of the wrong type or out of range, unreadable file.
/// The message is one line that names where the value came from, the key, what was found and what is allowed.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How well the value of a parameter is known.
enum class Confidence : std::uint8_t {
  vendor,    // ClearSpeed says so: site, manual, white paper, driver source, patent
  measured,  // a third party measured it
  stated,    // a third party reports it without having measured it
  inferred,  // arithmetic on a cited fact, or from the paper's tables
  assumed,   // no readable source; a default to sweep over
};

inline constexpr std::array<std::string_view, 5> kConfidenceNames = {"vendor", "measured", "stated",
                                                                     "inferred", "assumed"};
/// In the order of PioArbitration.
inline constexpr std::array<std::string_view, 3> kPioArbitrationNames = {
    "strict_fifo", "reads_overtake_writes", "queue_per_direction"};

std::string_view confidence_name(Confidence confidence);

/// What a parameter holds, whatever its C++ type: a choice is held by its name.
using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;

struct IntegerRange {
  std::int64_t low;
  std::int64_t high;
  std::int64_t multiple_of = 1;
  bool power_of_two = false;
};
struct RealRange {
  double low;
  double high;
};
struct TrueOrFalse {};
using Choice = std::vector<std::string_view>;
using Allowed =
    std::variant<TrueOrFalse, IntegerRange, RealRange, Choice>;  // alternatives as in ParameterValue

/// What a parameter can change.
enum class Effect : std::uint8_t {
  timing,  ///< when things happen: what the firmware asks of its machine, and so the image, stays the same
  stream,  ///< also what the firmware asks of its machine
};

/// One parameter: the only declaration of its key, default, range, source and effect.
struct ParameterInfo {
  std::string key;   ///< "pio.setup_cycles": group and field of ChipConfig
  std::string unit;  ///< "-": the number has none
  ParameterValue default_value;
  Allowed allowed;
  Confidence confidence;  ///< how well the default is known
  std::string meaning;    ///< sources in brackets: ids of parameter_sources()

  ParameterValue (*read)(const ChipConfig&);
  void (*write)(ChipConfig&, const ParameterValue&);  ///< unchecked

  Effect effect = Effect::timing;
};

/// Every parameter, group by group.
const std::vector<ParameterInfo>& parameter_table();

struct ParameterSource {
  std::string_view id;
  std::string_view title;
};
/// The sources that bracketed ids in meanings stand for.
const std::vector<ParameterSource>& parameter_sources();

/// nullptr for an unknown key.
const ParameterInfo* find_parameter(std::string_view key);

/// "an integer from 8 to 1024, a multiple of 8"
std::string allowed_text(const ParameterInfo& parameter);

/// As `--set` and TOML files read it; reals in the shortest form that reads back to the same number.
std::string value_text(const ParameterValue& value);

/// The chip of the table's defaults: preset csx600.
ChipConfig default_chip_config();

/// Sets one parameter. `origin` says where the value is from ("chip.toml:7", "--set"). Throws ConfigError and
/// leaves `config` as it was if the key is unknown, or the value has the wrong type or is out of range.
void set_parameter(ChipConfig& config, std::string_view key, std::string_view text, std::string_view origin);
void set_parameter_value(ChipConfig& config, std::string_view key, const ParameterValue& value,
                         std::string_view origin);

/// Throws ConfigError for an unknown key.
std::string parameter_text(const ChipConfig& config, std::string_view key);

/// Checks every range, and what must hold between parameters (a DDR page is a multiple of the cache line,
/// ...); once all values are set. Throws ConfigError, which begins with `origin` if there is one.
void validate(const ChipConfig& config, std::string_view origin = {});

}  // namespace model
