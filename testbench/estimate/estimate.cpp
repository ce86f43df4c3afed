#include "testbench/estimate/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using Counts = std::map<std::string, double>;

constexpr const char* kTime = "simulated_seconds";
constexpr int kFirstBatches = 4;
/// Batches of which both halves are run, too.
constexpr int kHalvedBatches = 4;
/// Paths of half a batch for each slot of the bins, so that filling and draining them is a small part of it.
constexpr std::int64_t kPathsOfASlot = 8;

/// 97.5 % of Student's distribution, for the variance of so many values.
double student_t(int values) {
  static const std::map<int, double> table = {{4, 3.182},  {8, 2.365},   {16, 2.131}, {32, 2.040},
                                              {64, 1.998}, {128, 1.979}, {256, 1.969}};
  const auto found = table.lower_bound(values);
  return found == table.end() ? 1.96 : found->second;
}

/// Every counter that grows with the render, and those that stay.
Counts counts_of(const Json& statistics) {
  Counts counts;
  for (const auto& [key, value] : flatten(statistics)) {
    const Counter* const counter = find_counter(key);
    if (counter == nullptr || counter->kind != CounterKind::counted || !value.is_number()) continue;
    if (key.rfind(kSimulatorSection, 0) == 0 || key.find("interval") != std::string::npos) continue;
    counts[key] = value.get<double>();
  }
  return counts;
}

Counts render_part(const Scene& scene, const RenderRequest& request, int first_sample, int samples) {
  RenderRequest part = request;
  part.options.work.first_sample = first_sample;
  part.options.work.samples = samples;
  return counts_of(render_statistics(part, render_on_chip(scene, part.options)));
}

/// Mean and variance of values that come one by one (Welford, Technometrics 4(3), 1962).
class Moments {
 public:
  void add(double value) {
    ++count_;
    const double delta = value - mean_;
    mean_ += delta / count_;
    squares_ += delta * (value - mean_);
  }
  double mean() const { return mean_; }
  double variance() const { return count_ > 1 ? squares_ / (count_ - 1) : 0; }
  int count() const { return count_; }

 private:
  int count_ = 0;
  double mean_ = 0;
  double squares_ = 0;
};

/// The parts of a render that were run so far.
class Parts {
 public:
  Parts(const Scene& scene, const RenderRequest& request, int half, int jobs,
        const std::function<void(int)>& progress)
      : scene_(scene), request_(request), half_(half), jobs_(jobs), progress_(progress) {}

  /// Runs batches until there are so many, with halves of the first ones.
  void run_to(int batches) {
    std::vector<std::function<std::string()>> runs;
    const int before = int(batches_.size());
    const auto add = [&](int first_sample, int samples) {
      runs.emplace_back([=] { return Json(render_part(scene_, request_, first_sample, samples)).dump(); });
      samples_ += samples;
    };
    for (int i = before; i < batches; ++i) add(2 * half_ * i, 2 * half_);
    const int halved = before == 0 ? kHalvedBatches : 0;
    for (int i = 0; i < halved; ++i) {
      add(2 * half_ * i, half_);
      add(2 * half_ * i + half_, half_);
    }
    const std::vector<std::string> results =
        run_in_processes(runs, jobs_, [&](int finished) { progress_(parts_ + finished); });
    parts_ += int(results.size());
    const auto counts = [&](int i) { return Json::parse(results[std::size_t(i)]).get<Counts>(); };
    for (int i = 0; i < batches - before; ++i) batches_.push_back(counts(i));
    for (int i = 0; i < halved; ++i)
      halves_.emplace_back(counts(batches + 2 * i), counts(batches + 2 * i + 1));
  }

  int samples() const { return samples_; }
  int batches() const { return int(batches_.size()); }

  std::vector<EstimatedCounter> whole(int samples) const {
    std::vector<EstimatedCounter> all;
    for (const auto& [key, value] : batches_.front())
      if (is_everywhere(key)) all.push_back(whole(key, samples));
    return all;
  }

 private:
  bool is_everywhere(const std::string& key) const {
    return std::all_of(batches_.begin(), batches_.end(),
                       [&](const Counts& of) { return of.count(key) > 0; }) &&
           std::all_of(halves_.begin(), halves_.end(),
                       [&](const auto& of) { return of.first.count(key) > 0 && of.second.count(key) > 0; });
  }

  EstimatedCounter whole(const std::string& key, int samples) const {
    Moments batch;
    Moments overhead;
    for (const Counts& counts : batches_) batch.add(counts.at(key));
    for (std::size_t i = 0; i < halves_.size(); ++i)
      overhead.add(halves_[i].first.at(key) + halves_[i].second.at(key) - batches_[i].at(key));
    const double times = double(samples) / (2 * half_);
    const double variance = times * times * batch.variance() / batch.count() +
                            (times - 1) * (times - 1) * overhead.variance() / overhead.count() +
                            times * batch.variance();
    return {key, times * batch.mean() - (times - 1) * overhead.mean(),
            student_t(batch.count()) * std::sqrt(variance)};
  }

  const Scene& scene_;
  const RenderRequest& request_;
  int half_;
  int jobs_;
  const std::function<void(int)>& progress_;
  std::vector<Counts> batches_;
  std::vector<std::pair<Counts, Counts>> halves_;  ///< of the first batches
  int parts_ = 0;
  int samples_ = 0;
};

/// Samples of half a batch.
int half_batch(const Scene& scene, const RenderOptions& options) {
  const std::int64_t arrays = std::int64_t{options.chip.board.chips} * options.chip.chip.arrays;
  const std::int64_t slots = arrays * options.chip.chip.pes * options.program.bin_blocks;
  const std::int64_t pixels = std::int64_t{scene.film.width} * scene.film.height;
  const std::int64_t samples = (kPathsOfASlot * slots + pixels - 1) / pixels;
  return int(std::max(arrays, samples));  // each array renders a sample at least
}

}  // namespace

const EstimatedCounter& Estimate::counter(const std::string& key) const {
  return *std::find_if(counters.begin(), counters.end(),
                       [&](const EstimatedCounter& counter) { return counter.key == key; });
}

double Estimate::relative_half_width() const {
  const EstimatedCounter& time = counter(kTime);
  return time.value > 0 ? time.half_width / time.value : 0;
}

Estimate render_in_full(const Scene& scene, const RenderRequest& request) {
  const int samples = request.options.work.samples;
  Estimate estimate{samples, samples, 0, 0, {}};
  for (const auto& [key, value] : render_part(scene, request, 0, samples))
    estimate.counters.push_back({key, value, 0});
  return estimate;
}

Estimate estimate_render(const Scene& scene, const RenderRequest& request, const EstimateOptions& options,
                         const std::function<void(int parts)>& progress) {
  const int samples = request.options.work.samples;
  const int half = half_batch(scene, request.options);
  Parts parts(scene, request, half, options.jobs, progress);
  for (int batches = kFirstBatches;; batches *= 2) {
    const std::int64_t rendered = std::int64_t{2} * half * (batches + kHalvedBatches);
    if (2 * rendered > samples) return render_in_full(scene, request);
    parts.run_to(batches);
    Estimate estimate{samples, parts.samples(), batches, 2 * half, parts.whole(samples)};
    if (estimate.relative_half_width() <= options.within) return estimate;
  }
}

}  // namespace testbench
