#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "firmware/cn/simd/level.hpp"
#include "model/config/chip_config.hpp"

namespace testbench {

/// Whether a published figure is a value or a bound.
enum class Published : std::uint8_t { value, at_least, at_most };

/// A published figure of the chip beside the model's. Nothing in the model was fitted to it.
struct Figure {
  std::string what;
  std::string unit;
  std::string chip;  ///< preset
  double model = 0;
  Published kind = Published::value;
  double published_low = 0;
  double published_high = 0;  ///< equal to published_low unless a range was published
  std::string source;
  std::string note;  ///< what the model lacks if its figure is off

  /// Error against the nearest published value; 0 within the range or on the right side of a bound.
  double error_percent() const;
};

/// The cycles of one run by cause, in percent of the run.
struct CycleShares {
  std::string run;
  std::string chip;
  std::vector<std::pair<std::string, double>> percent;  ///< by cause; only causes above zero
};

/// Bandwidth of programmed I/O alone, without other traffic and without overlap.
struct TransferPoint {
  int pes = 0;
  int bytes_per_pe = 0;
  int packet_offset_bytes = 0;  ///< offset of each PE's piece within a packet
  double load_bytes_per_second = 0;
  double save_bytes_per_second = 0;
};

struct Validation {
  std::vector<Figure> figures;
  std::vector<CycleShares> shares;
  std::vector<TransferPoint> transfers;  ///< with preset csx600
};

struct ValidationOptions {
  /// Returns the chip of a preset with the user's changes.
  std::function<model::ChipConfig(const std::string& preset)> chip;
  cn::Level level = cn::widest_level();
  int jobs = 1;
};

/// Runs the examples (firmware/examples) on the chip, each in a process of its own, and checks their results.
/// Throws InputError for a chip that they do not fit, RunError for a wrong result. `progress` receives the
/// share of finished runs.
Validation validate(const ValidationOptions& options, const std::function<void(double)>& progress = {});

/// The figures as readable tables.
std::string validation_text(const Validation& validation);
/// The figures as CSV, one per line.
std::string validation_csv(const Validation& validation);
nlohmann::ordered_json to_json(const Validation& validation);

}  // namespace testbench
