#include <algorithm>
#include <memory>
#include <numeric>
#include <string>

#include "model/time/run_until_idle.hpp"
#include "testbench/observe/observation.hpp"
#include "testbench/run/host_pc.hpp"
#include "testbench/run/render_job.hpp"
#include "testbench/sampling/sample_counts.hpp"

namespace testbench {
namespace {

int arrays_of_board(const model::ChipConfig& chip) {
  return chip.board.chips * chip.chip.arrays;
}

/// The `part`-th of so many parts of [0, all): where it begins.
std::size_t begin_of_part(std::size_t all, int part, int parts) {
  return all * std::size_t(part) / std::size_t(parts);
}

/// Every sample of the work, one by one.
std::vector<path_tracer::CameraSampleRecord> all_samples(const Scene& scene, const RenderOptions& options) {
  const auto pixels = std::size_t(scene.film.width) * std::size_t(scene.film.height);
  const path_tracer::Work& work = options.work;
  return list_samples(SampleCounts(pixels, work.first_sample),
                      SampleCounts(pixels, work.first_sample + work.samples), options.program.pixel_stride);
}

/// What each array of the board renders: some samples of every pixel, or where there are fewer samples than
/// arrays, or a list of them, a part of the list. Throws InputError when there are fewer paths than arrays.
std::vector<RenderOptions> shares_of(const Scene& scene, const RenderOptions& options) {
  const int arrays = arrays_of_board(options.chip);
  if (arrays == 1) return {options};
  RenderOptions whole = options;
  if (whole.camera_samples.empty() && whole.work.samples < arrays)
    whole.camera_samples = all_samples(scene, options);
  if (!whole.camera_samples.empty() && whole.camera_samples.size() < std::size_t(arrays))
    throw InputError("board.chips: found " + std::to_string(arrays) + " arrays for " +
                     std::to_string(whole.camera_samples.size()) + " paths; allowed: at most one a path");
  std::vector<RenderOptions> shares(std::size_t(arrays), options);
  for (int i = 0; i < arrays; ++i) {
    RenderOptions& share = shares[std::size_t(i)];
    if (whole.camera_samples.empty()) {
      const auto samples = std::size_t(options.work.samples);
      const auto first = static_cast<int>(begin_of_part(samples, i, arrays));
      share.work.first_sample += first;
      share.work.samples = static_cast<int>(begin_of_part(samples, i + 1, arrays)) - first;
    } else {
      const auto& list = whole.camera_samples;
      share.camera_samples.assign(list.begin() + std::ptrdiff_t(begin_of_part(list.size(), i, arrays)),
                                  list.begin() + std::ptrdiff_t(begin_of_part(list.size(), i + 1, arrays)));
    }
  }
  return shares;
}

/// The images of a chip's arrays. They share the scene, which the first one brings; each has bins and a list
/// of its own.
std::vector<MonoImage> images_of_arrays(const MonoImage& scene, const std::vector<RenderOptions>& shares,
                                        int first, const model::ChipConfig& chip) {
  std::vector<MonoImage> images;
  for (int i = 0; i < chip.chip.arrays; ++i) {
    images.push_back(i == 0 ? scene : MonoImage{scene.layout, {}});
    if (i > 0) path_tracer::place_bins(images.back().layout, images[std::size_t(i - 1)].layout.total_bytes);
    add_list(images.back(), shares[std::size_t(first + i)].camera_samples);
  }
  require_mono_memory(images.back(), chip);
  return images;
}

/// Tells the caller how far all arrays are together.
class SharedProgress {
 public:
  SharedProgress(std::size_t arrays, const RenderProgress& progress) : progress_(progress), shares_(arrays) {}

  RenderProgress of_array(std::size_t array) {
    if (!progress_) return {};
    return [this, array](double share) {
      shares_[array] = share;
      return progress_(std::accumulate(shares_.begin(), shares_.end(), 0.0) / double(shares_.size()));
    };
  }

 private:
  const RenderProgress& progress_;
  std::vector<double> shares_;
};

/// An array with its share of the paths, and the host's side of it.
class RenderingArray {
 public:
  RenderingArray(const std::string& host, model::Csx600& chip, int number, const Scene& scene,
                 const RenderOptions& share, MonoImage image, RenderProgress progress,
                 const HostPc* uploads_scene)
      : options_(share),
        progress_(std::move(progress)),
        job_(scene, options_, std::move(image), progress_),
        control_unit_(chip.array(number).control_unit),
        host_(host.c_str(), chip, control_unit_, job_.image(), job_.result().film, uploads_scene) {
    host_.report_reads_to(job_.check_hazards(control_unit_, [this] { return control_unit_.now(); }));
    observation_.emplace(observation_of_array(options_.observation, chip, number), chip, number);
    control_unit_.load([this](cn::Machine& machine) { job_.firmware(machine); });
  }

  const HostPc& host() const { return host_; }
  void require_finished() const {
    control_unit_.require_finished();
    if (!host_.finished()) throw RunError("the firmware has ended, but the host has not");
  }
  /// Once all arrays have finished.
  RenderResult finish() {
    RenderResult result = job_.finish();
    result.observation_failures = observation_->finish();
    return result;
  }

 private:
  const RenderOptions options_;
  RenderProgress progress_;
  RenderJob job_;
  model::ControlUnit& control_unit_;
  HostPc host_;
  std::optional<Observation> observation_;
};

/// The chips of a board in a row, the host link at the first.
class Board {
 public:
  Board(const Scene& scene, const RenderOptions& options, const RenderProgress& progress)
      : config_(options.chip), progress_(std::size_t(arrays_of_board(config_)), progress) {
    const std::vector<RenderOptions> shares = shares_of(scene, options);
    const auto image = options.image ? options.image : make_image(scene, options);
    for (int number = 0; number < config_.board.chips; ++number)
      add_chip(number, scene, *image, shares, options.timing);
    if (!options.faults.empty()) chips_.front()->inject(options.faults);
  }

  void require_finished() const {
    for (const auto& array : arrays_) array->require_finished();
    for (const auto& chip : chips_) chip->require_no_detected_fault();
  }
  RenderResult finish() {
    RenderResult result = arrays_.front()->finish();
    for (std::size_t i = 1; i < arrays_.size(); ++i) {
      const RenderResult other = arrays_[i]->finish();
      result.film.merge(other.film);
      result.counts.merge(other.counts);
      result.is_partial = result.is_partial || other.is_partial;
      if (!other.observation_failures.empty())
        result.observation_failures +=
            (result.observation_failures.empty() ? "" : "; ") + other.observation_failures;
    }
    result.chip = statistics();
    result.faults = chips_.front()->fault_counts();
    if (chips_.size() > 1) result.chips = statistics_of_chips();
    return result;
  }

 private:
  void add_chip(int number, const Scene& scene, const MonoImage& image,
                const std::vector<RenderOptions>& shares, model::TimingStyle timing) {
    const std::string name = config_.board.chips == 1 ? "csx600" : "csx600_" + std::to_string(number);
    chips_.push_back(std::make_unique<model::Csx600>(name.c_str(), config_, timing));
    model::Csx600& chip = *chips_.back();
    chip.host_link.share_link_of(chips_.front()->host_link);
    chip.host_link.cross_bridges(number);
    const int first = number * config_.chip.arrays;
    std::vector<MonoImage> images = images_of_arrays(image, shares, first, config_);
    for (int i = 0; i < config_.chip.arrays; ++i) {
      const std::string host = arrays_of_board(config_) == 1 ? "host" : "host_" + std::to_string(first + i);
      const HostPc* const uploads_scene = i == 0 ? nullptr : &arrays_[std::size_t(first)]->host();
      arrays_.push_back(std::make_unique<RenderingArray>(
          host, chip, i, scene, shares[std::size_t(first + i)], std::move(images[std::size_t(i)]),
          progress_.of_array(std::size_t(first + i)), uploads_scene));
    }
  }

  /// When the host had the last result of the chip.
  model::Cycles finished_cycle(std::size_t chip) const {
    model::Cycles last = 0;
    for (int i = 0; i < config_.chip.arrays; ++i)
      last = std::max(
          last, arrays_[chip * std::size_t(config_.chip.arrays) + std::size_t(i)]->host().finished_cycle());
    return last;
  }

  std::vector<ChipStatistics> statistics_of_chips() const {
    std::vector<ChipStatistics> all;
    for (std::size_t i = 0; i < chips_.size(); ++i)
      all.push_back(collect_statistics(*chips_[i], finished_cycle(i)));
    return all;
  }

  /// Of the board: counts are sums, times from the first start to the last end.
  ChipStatistics statistics() const {
    const std::vector<ChipStatistics> all = statistics_of_chips();
    ChipStatistics board = all.front();
    FirmwareSpan span = firmware_span(*chips_.front());
    for (std::size_t i = 1; i < chips_.size(); ++i) {
      board.merge(all[i]);
      board.total_cycles = std::max(board.total_cycles, all[i].total_cycles);
      const FirmwareSpan other = firmware_span(*chips_[i]);
      span = {std::min(span.start, other.start), std::max(span.end, other.end)};
    }
    board.config.board.chips = static_cast<int>(chips_.size());
    board.firmware_cycles = span.cycles();
    return board;
  }

  const model::ChipConfig config_;
  SharedProgress progress_;
  std::vector<std::unique_ptr<model::Csx600>> chips_;
  std::vector<std::unique_ptr<RenderingArray>> arrays_;  ///< chip by chip
};

}  // namespace

RenderResult render_on_chip(const Scene& scene, const RenderOptions& options,
                            const RenderProgress& progress) {
  return with_input_errors([&] {
    Board board(scene, options, progress);
    model::run_until_idle();
    board.require_finished();
    return board.finish();
  });
}

}  // namespace testbench
