// Several chips in one simulation, each with a memory, a host and work of its own: each run is what it is
// alone.

#include <memory>

#include "firmware/path_tracer/path_tracer.hpp"
#include "testbench/observe/observation.hpp"
#include "testbench/run/host_pc.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/vcd_reader.hpp"

namespace several_chips_test {

using model::Cycles;
using model::TimingStyle;
using path_tracer::Program;

struct Job {
  Program program;
  testbench::FilmSize film;
  double clock_hz;
};

/// What must not depend on other chips.
struct Outcome {
  std::string image;
  Cycles cycles;
  Cycles host_cycles;
  std::uint64_t pio_requests;
  std::uint64_t page_misses;
  bool operator==(const Outcome& other) const {
    return image == other.image && cycles == other.cycles && host_cycles == other.host_cycles &&
           pio_requests == other.pio_requests && page_misses == other.page_misses;
  }
};

std::ostream& operator<<(std::ostream& out, const Outcome& outcome) {
  return out << outcome.image << ", cycles " << outcome.cycles << ", host " << outcome.host_cycles
             << ", requests " << outcome.pio_requests << ", misses " << outcome.page_misses;
}

/// A chip with its host, which renders.
class Board {
 public:
  Board(const std::string& name, const Job& job, TimingStyle timing)
      : options_(test_support::render_options(job.program, 3)),
        scene_(test_support::small_cornell_box(job.film)),
        image_(testbench::make_mono_image(scene_, options_.chip.chip.pes, options_.program)),
        film_(scene_.film, testbench::film_scale(scene_)) {
    options_.chip.chip.clock_hz = job.clock_hz;
    chip_ = std::make_unique<model::Csx600>((name + "_chip").c_str(), options_.chip, timing);
    host_ = std::make_unique<testbench::HostPc>((name + "_host").c_str(), *chip_, image_, film_);
    chip_->control_unit.load([this](cn::Machine& machine) {
      path_tracer::PathTracer(machine, path_tracer::kernels(options_.level), options_.program, image_.layout,
                              options_.work)
          .run({});
    });
  }

  void write_waves(const std::filesystem::path& file) {
    testbench::ObservationOptions options;
    options.waves.emplace(testbench::WaveOptions{file, {}});
    observation_.emplace(options, *chip_);
  }

  Outcome outcome() {
    if (observation_) {
      EXPECT_EQ(observation_->finish(), "");
    }
    chip_->control_unit.require_finished();
    EXPECT_TRUE(host_->finished());
    const model::PioStatistics& pio = chip_->pio_engine.statistics();
    return {film_.sha256(), chip_->control_unit.statistics().total(), host_->finished_cycle(),
            pio.requests_to_poly + pio.requests_to_mono, chip_->ddr_statistics().page_misses};
  }

 private:
  testbench::RenderOptions options_;
  testbench::Scene scene_;
  testbench::MonoImage image_;
  testbench::Film film_;
  std::unique_ptr<model::Csx600> chip_;
  std::unique_ptr<testbench::HostPc> host_;
  std::optional<testbench::Observation> observation_;
};

class SeveralChips : public test_support::SystemCFixture, public testing::WithParamInterface<TimingStyle> {
 protected:
  /// @param waves a directory for a file of each chip; empty: none
  static std::vector<Outcome> run(const std::vector<Job>& jobs, const std::filesystem::path& waves = {}) {
    new_context();
    std::vector<std::unique_ptr<Board>> boards;
    for (const Job& job : jobs)
      boards.push_back(std::make_unique<Board>("board" + std::to_string(boards.size()), job, GetParam()));
    for (std::size_t i = 0; !waves.empty() && i < boards.size(); ++i)
      boards[i]->write_waves(waves / ("chip" + std::to_string(i) + ".vcd"));
    // A day of simulated time: without a bound, chips that wait for each other would never return.
    sc_core::sc_start(sc_core::sc_time(86400, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
    std::vector<Outcome> outcomes;
    for (const auto& board : boards) outcomes.push_back(board->outcome());
    return outcomes;
  }

  static void expect_each_as_alone(const std::vector<Job>& jobs) {
    const std::vector<Outcome> together = run(jobs);
    for (std::size_t i = 0; i < jobs.size(); ++i) EXPECT_EQ(together[i], run({jobs[i]}).front()) << i;
  }
};

TEST_P(SeveralChips, TwoEqualOnes) {
  const Job job{Program::segments, {11, 5}, 210e6};
  expect_each_as_alone({job, job});
}

TEST_P(SeveralChips, ThreeWithWorkAndClocksOfTheirOwn) {
  expect_each_as_alone({{Program::full, {7, 5}, 210e6},
                        {Program::segments, {11, 5}, 250e6},
                        {Program::direct, {9, 4}, 210e6}});
}

TEST_P(SeveralChips, TheWavesOfEachHaveItsScope) {
  const test_support::TemporaryDirectory directory;
  const std::vector<Job> jobs = {{Program::full, {7, 5}, 210e6}, {Program::segments, {11, 5}, 250e6}};
  const std::vector<Outcome> observed = run(jobs, directory.path());
  EXPECT_EQ(observed, run(jobs));
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const std::string chip = "board" + std::to_string(i) + "_chip.";
    const auto waves =
        test_support::VcdReader::of_file(directory.path() / ("chip" + std::to_string(i) + ".vcd"));
    for (const auto& signal : waves.signals()) EXPECT_EQ(signal.first.substr(0, chip.size()), chip);
    EXPECT_GT(waves.signal(chip + "control.state").changes.size(), 100u);
    EXPECT_GE(double(waves.last_time()) * jobs[i].clock_hz / 1e12 + 1, double(observed[i].host_cycles));
  }
}

INSTANTIATE_TEST_SUITE_P(Styles, SeveralChips,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const testing::TestParamInfo<TimingStyle>& style) {
                           return style.param == TimingStyle::loosely_timed ? "Lt" : "At";
                         });

}  // namespace several_chips_test
