#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "testbench/film/film.hpp"
#include "testbench/statistics/render_report.hpp"

namespace testbench {

/// Where and how often a render in passes keeps what it has.
struct CheckpointOptions {
  std::filesystem::path file;
  double every_seconds = 60;  ///< of wall time, at least; kept at the first end of a pass behind it
  bool resumes = false;       ///< goes on from the file, which must exist
  std::string identity;       ///< what determines the result and is in no RenderRequest: program, importance
};

/// What the passes so far have come to.
struct PassSums {
  Film film;
  int passes = 0;
  std::uint64_t segments = 0;
  double cpu_seconds = 0;                        ///< of all ranks
  std::optional<double> simulated_seconds = {};  ///< of each pass that of the chip that took longest
  nlohmann::ordered_json parts = nlohmann::ordered_json::array();  ///< each pass's own statistics
};

/// Names everything that determines image and statistics of a render; its options have their image. 64
/// hexadecimal digits.
std::string checkpoint_digest(const Scene& scene, const RenderRequest& request, const std::string& identity,
                              int ranks);

/// Puts the sums in place of the file, which holds at any moment all of a checkpoint. The one before it stays
/// as FILE.previous. Both survive a loss of power. Throws as write_bytes_atomically() does.
void write_checkpoint(const std::filesystem::path& file, const PassSums& sums, const std::string& digest);

/// Reads what write_checkpoint() wrote for a render with the same digest, film and sums. Throws InputError
/// for any other file.
PassSums read_checkpoint(const std::filesystem::path& file, const Scene& scene, FilmSums sums,
                         const std::string& digest);

}  // namespace testbench
