#include "testbench/passes/pass_render.hpp"

#include <algorithm>
#include <cmath>

#include "testbench/passes/pass_message.hpp"
#include "testbench/sampling/time_budget.hpp"
#include "testbench/statistics/rank_render.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/simulator_time.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// Whether every pixel has the same whole number of samples.
bool is_uniform(const MeanSamples& samples) {
  return std::floor(samples.front()) == samples.front() &&
         std::all_of(samples.begin(), samples.end(), [&](double of) { return of == samples.front(); });
}

/// The paths of a pass, as a run of the firmware takes them.
PassWork work_between(const MeanSamples& done, const MeanSamples& until,
                      const path_tracer::ProgramConfig& program) {
  PassWork work;
  if (is_uniform(done) && is_uniform(until)) {
    work.work.first_sample = static_cast<int>(done.front());
    work.work.samples = static_cast<int>(until.front()) - work.work.first_sample;
  } else {
    work.list =
        list_samples(counts_of(done, program.seed), counts_of(until, program.seed), program.pixel_stride);
  }
  return work;
}

/// How much of what is planned a pass may do.
class PassLimit {
 public:
  PassLimit(const RenderOptions& options, const std::optional<TimeBudget>& budget)
      : budget_(budget),
        first_paths_(kFirstFills * double(options.chip.chip.pes) * options.program.bin_blocks),
        most_listed_(double(options.chip.ddr.size_bytes) / kListShare /
                     double(sizeof(path_tracer::CameraSampleRecord))) {}

  /// The share of a pass of so many paths; 0 when it would be late.
  double share(double paths) const {
    double most = most_listed_;
    if (budget_ && !times_.any()) most = std::min(most, first_paths_);
    if (budget_ && times_.any()) most = std::min(most, paths_in_time());
    return std::min(1.0, most / paths);
  }
  void add(double paths, double simulated_seconds, double pass_seconds) {
    if (!budget_) return;
    const bool on_chip = budget_->clock == BudgetClock::chip;
    times_.add(paths, on_chip ? simulated_seconds : pass_seconds);
    spent_ = on_chip ? spent_ + simulated_seconds : timer_.wall_seconds();
  }
  double wall_seconds() const { return timer_.wall_seconds(); }
  /// Share of the time that is over; 1 without a budget.
  double spent_share() const { return budget_ ? spent_ / budget_->seconds : 1; }

 private:
  /// The first pass fills the bins so many times: fewer paths would not show how long more take.
  static constexpr double kFirstFills = 2;
  /// A list takes at most one part in so many of mono memory.
  static constexpr double kListShare = 4;

  double paths_in_time() const {
    const double paths = times_.most_paths(budget_->seconds - spent_);
    return paths < first_paths_ / 2 ? 0 : paths;
  }

  std::optional<TimeBudget> budget_;
  double first_paths_;
  double most_listed_;
  PassTimes times_;
  double spent_ = 0;
  SimulatorTimer timer_;
};

/// Keeps the sums in a file from time to time.
class Checkpoints {
 public:
  /// @param digest of the render; "" without a file
  Checkpoints(const CheckpointOptions& options, std::string digest)
      : options_(options), digest_(std::move(digest)) {}

  bool any() const { return !digest_.empty(); }
  bool resumes() const { return any() && options_.resumes; }
  PassSums read(const Scene& scene, FilmSums sums) const {
    return read_checkpoint(options_.file, scene, sums, digest_);
  }
  void after_pass(const PassSums& sums) {
    if (any() && timer_.wall_seconds() >= options_.every_seconds) write(sums);
  }
  /// Writes what the file does not have yet.
  void finish(const PassSums& sums) {
    if (any() && sums.passes > written_passes_) write(sums);
  }
  void are_written(int passes) { written_passes_ = passes; }

 private:
  void write(const PassSums& sums) {
    write_checkpoint(options_.file, sums, digest_);
    written_passes_ = sums.passes;
    timer_ = {};
  }

  CheckpointOptions options_;
  std::string digest_;
  int written_passes_ = 0;
  SimulatorTimer timer_;
};

Checkpoints checkpoints_of(const std::optional<CheckpointOptions>& options, const Scene& scene,
                           const RenderRequest& request, int ranks) {
  if (!options) return {{}, ""};
  return {*options, checkpoint_digest(scene, request, options->identity, ranks)};
}

/// Tells the other ranks what to do; nothing ends them.
void send(Ranks& ranks, const PassWork& work) {
  for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, to_message(work));
}

/// The first rank's side: decides the passes and collects what they make.
class PassLeader {
 public:
  PassLeader(Ranks& ranks, const Scene& scene, const RenderRequest& request,
             const std::optional<TimeBudget>& budget, const PassActions& actions)
      : ranks_(ranks),
        scene_(scene),
        request_(request),
        limit_(request.options, budget),
        actions_(actions),
        checkpoints_(checkpoints_of(actions.checkpoint, scene, request, ranks.size())),
        render_(Film(scene.film, film_scale(scene), request.options.film_sums)),
        done_(std::size_t(render_.film.pixel_count()), 0.0) {
    if (!checkpoints_.resumes()) return;
    static_cast<PassSums&>(render_) = checkpoints_.read(scene, request.options.film_sums);
    checkpoints_.are_written(render_.passes);
    passes_left_out_ = render_.passes;
  }

  PassRender run(SamplePlan& plan) {
    while (const std::optional<MeanSamples> wanted = plan.next(done_, render_.film)) {
      const double paths = total(*wanted) - total(done_);
      const double share = limit_.share(paths);
      if (share == 0) {
        render_.end = PassEnd::time_over;
        break;
      }
      MeanSamples until = done_;
      for (std::size_t pixel = 0; pixel < until.size(); ++pixel)
        until[pixel] =
            share == 1 ? (*wanted)[pixel] : until[pixel] + share * ((*wanted)[pixel] - until[pixel]);
      const PassWork work = work_between(done_, until, request_.options.program);
      done_ = until;
      if (work.empty()) continue;
      if (passes_left_out_ > 0) {
        --passes_left_out_;
      } else if (!run_pass(work)) {
        render_.end = PassEnd::interrupted;
        break;
      }
    }
    checkpoints_.finish(render_);
    render_.wall_seconds = limit_.wall_seconds();
    write_sums(plan.error());
    return std::move(render_);
  }

 private:
  /// Returns false when the render is to stop. A pass that was interrupted counts for nothing.
  bool run_pass(const PassWork& work) {
    send(ranks_, work);
    take_work(work, request_.options);
    const SimulatorTimer timer;
    std::optional<RankRender> pass = render_on_ranks(ranks_, scene_, request_, actions_.progress);
    if (pass->is_partial) return false;
    render_.film.merge(pass->film);
    ++render_.passes;
    render_.segments += pass->segments;
    render_.cpu_seconds += pass->cpu_seconds;
    if (pass->simulated_seconds)
      render_.simulated_seconds = render_.simulated_seconds.value_or(0) + *pass->simulated_seconds;
    render_.parts.push_back(ranks_.alone() ? pass->statistics["parts"][0] : std::move(pass->statistics));
    actions_.after_pass(render_.film, render_.passes);
    checkpoints_.after_pass(render_);
    limit_.add(double(work.paths(render_.film.pixel_count())), pass->simulated_seconds.value_or(0),
               timer.wall_seconds());
    return !actions_.progress || actions_.progress(limit_.spent_share());
  }

  void write_sums(const std::optional<double>& error) {
    const PixelSamples samples = render_.film.samples();
    render_.statistics = {
        {"format", "csx600-pass-statistics-1"},
        {"scene", request_.scene},
        {"passes", render_.passes},
        {"out_of_time", render_.end == PassEnd::time_over},
        {"relative_rmse", error ? Json(*error) : Json()},
        {"simulated_seconds", render_.simulated_seconds ? Json(*render_.simulated_seconds) : Json()},
        {"segments", render_.segments},
        {"samples_a_pixel", {{"fewest", samples.fewest}, {"mean", samples.mean}, {"most", samples.most}}},
        {"image_sha256", render_.film.sha256()},
        {"parts", std::move(render_.parts)}};
    if (render_.end == PassEnd::interrupted) render_.statistics["partial"] = true;
  }

  Ranks& ranks_;
  const Scene& scene_;
  RenderRequest request_;
  PassLimit limit_;
  const PassActions& actions_;
  Checkpoints checkpoints_;
  PassRender render_;
  MeanSamples done_;
  int passes_left_out_ = 0;  ///< of those that the checkpoint has
};

/// SystemC elaborates once a process, so a chip lives in a process of its own.
void prepare(const Scene& scene, RenderRequest& request) {
  request.in_own_process = !request.native;
  request.options.image = make_image(scene, request.options);
}

/// The other ranks' side.
void follow(Ranks& ranks, const Scene& scene, RenderRequest request, const RenderProgress& progress) {
  try {
    prepare(scene, request);
  } catch (const InputError&) {
    return;  // the first rank says it
  }
  while (true) {
    const PassWork work = work_of(ranks.receive().bytes);
    if (work.empty()) return;
    take_work(work, request.options);
    render_on_ranks(ranks, scene, request, progress);
  }
}

}  // namespace

std::optional<PassRender> render_in_passes(Ranks& ranks, const Scene& scene, RenderRequest request,
                                           SamplePlan& plan, const std::optional<TimeBudget>& budget,
                                           const PassActions& actions) {
  if (!ranks.is_first()) {
    follow(ranks, scene, std::move(request), actions.progress);
    return std::nullopt;
  }
  prepare(scene, request);
  try {
    PassRender render = PassLeader(ranks, scene, request, budget, actions).run(plan);
    send(ranks, {});
    return render;
  } catch (...) {
    send(ranks, {});
    throw;
  }
}

}  // namespace testbench
