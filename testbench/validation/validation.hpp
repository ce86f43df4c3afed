#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "firmware/cn/simd/level.hpp"
#include "model/config/chip_config.hpp"

namespace testbench {

/// How a published figure is meant.
enum class Published : std::uint8_t { value, at_least, at_most };

/// A figure of the chip that is known from elsewhere, beside the model's. Nothing in the model was fitted to
/// it.
struct Figure {
  std::string what;
  std::string unit;
  std::string chip;  ///< preset
  double model = 0;
  Published kind = Published::value;
  double published_low = 0;
  double published_high = 0;  ///< the same as low unless a range was published
  std::string source;
  std::string note;  ///< what the model lacks, where it is off

  /// From the nearest published value; 0 within the range or on the right side of a bound.
  double error_percent() const;
};

/// Where the cycles of one run went, in percent of it.
struct CycleShares {
  std::string run;
  std::string chip;
  std::vector<std::pair<std::string, double>> percent;  ///< by cause, those above zero
};

/// Programmed I/O that nothing else disturbs and that nothing overlaps.
struct TransferPoint {
  int pes = 0;
  int bytes_per_pe = 0;
  int packet_offset_bytes = 0;  ///< of each PE's piece
  double load_bytes_per_second = 0;
  double save_bytes_per_second = 0;
};

struct Validation {
  std::vector<Figure> figures;
  std::vector<CycleShares> shares;
  std::vector<TransferPoint> transfers;  ///< on preset csx600
};

struct ValidationOptions {
  /// The chip of a preset, with the user's changes.
  std::function<model::ChipConfig(const std::string& preset)> chip;
  cn::Level level = cn::widest_level();
  int jobs = 1;
};

/// Runs the examples (firmware/examples) on the chip, each in a process of its own, and checks what they
/// computed. Throws InputError for a chip that they do not fit, RunError for a wrong result. `progress` is
/// told the share done.
Validation validate(const ValidationOptions& options, const std::function<void(double)>& progress = {});

/// Tables for people.
std::string validation_text(const Validation& validation);
/// The figures, one a line.
std::string validation_csv(const Validation& validation);
nlohmann::ordered_json to_json(const Validation& validation);

}  // namespace testbench
