#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/cn/simd/level.hpp"
#include "firmware/path_tracer/program/program_config.hpp"
#include "firmware/path_tracer/program/run_counts.hpp"
#include "firmware/path_tracer/program/work.hpp"
#include "model/config/chip_config.hpp"
#include "model/config/timing_style.hpp"
#include "model/faults/fault.hpp"
#include "testbench/film/film.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/observe/observation_options.hpp"
#include "testbench/run/chip_statistics.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

class TimingStream;

struct RenderOptions {
  model::ChipConfig chip;
  path_tracer::ProgramConfig program;
  path_tracer::Work work;
  /// The paths to trace, if not those of `work`; no sample of a pixel twice.
  std::vector<path_tracer::CameraSampleRecord> camera_samples = {};
  std::shared_ptr<const MonoImage> image = {};  ///< make_image() of the scene, for several renders of it
  /// make_normal_light_survey() of the scene, for renders of it by several programs.
  std::shared_ptr<const LightSurvey> light_survey = {};
  model::TimingStyle timing = model::TimingStyle::loosely_timed;
  cn::Level level = cn::widest_level();
  FilmSums film_sums = FilmSums::means_and_variances;
  ObservationOptions observation;  ///< on the chip only
  /// Native runs find hits through the simulator's tree (search_natively()).
  bool searches_natively = false;
  std::vector<model::Fault> faults = {};  ///< on a chip of one array, loosely timed (require_faults())
  bool check_hazards = false;  ///< with kernels that report their accesses (model/hazards/hazard_checker.hpp)
};

struct RenderResult {
  explicit RenderResult(Film empty) : film(std::move(empty)) {}

  Film film;
  path_tracer::RunCounts counts;
  TextureUses textures;
  std::optional<ChipStatistics> chip;  ///< of a run on the SystemC chip; of all chips of the board together
  std::vector<ChipStatistics> chips = {};  ///< of each chip of a board; empty if there is one
  std::string observation_failures;        ///< files that could not be completed, in one line
  model::FaultCounts faults = {};
  bool is_partial = false;  ///< interrupted: all of its paths are whole, but some are missing
  double cpu_seconds = 0;   ///< of the run itself, without loading and writing
  double wall_seconds = 0;
};

/// Takes the share of camera paths issued; returns false to interrupt the run: no further path begins.
using RenderProgress = std::function<bool(double share)>;

/// The firmware on the SystemC model: on each array of each chip of the board (board.chips, chip.arrays). The
/// samples of every pixel are divided among the arrays, and the film is that of one array, to the bit. Chips
/// have a DDR and a copy of the scene each, the arrays of a chip share both; all chips are behind one host
/// link. At most one render a process, as SystemC elaborates once.
/// Throws InputError for what does not fit the chip, RunError for a run that failed.
RenderResult render_on_chip(const Scene& scene, const RenderOptions& options,
                            const RenderProgress& progress = {});

/// The same firmware without SystemC: the same image, no time. What the firmware asks of its machine is added
/// to `record`, an empty stream, unless it is null.
RenderResult render_natively(const Scene& scene, const RenderOptions& options,
                             const RenderProgress& progress = {}, TimingStream* record = nullptr);

/// The scene's image for renders with these chip and program. Throws InputError.
std::shared_ptr<const MonoImage> make_image(const Scene& scene, const RenderOptions& options);

/// Throws InputError when a list of so many camera samples needs more mono memory than the chip has; before
/// the list is made.
void require_list_memory(std::uint64_t samples, const model::ChipConfig& chip);

/// Lets native runs find hits the fastest way that the simulator has, instead of the program's: the image is
/// the same, since every way finds the same hits, and nothing of the chip's ways is counted.
void search_natively(RenderOptions& options);

/// Throws InputError when scene and bins need more mono memory than the chip has.
void require_mono_memory(const MonoImage& image, const model::ChipConfig& chip);

/// Throws RunError if what was to be observed could not be written.
void require_observed(const RenderResult& result);

using cn::widest_level;

}  // namespace testbench
