// The hazard checker on the chip: what it says agrees with the engine, and it changes nothing.

#include "model/hazards/hazard_checker.hpp"

#include <nlohmann/json.hpp>

#include "testbench/run/render.hpp"
#include "testbench/statistics/render_report.hpp"
#include "tests/support/control_bench.hpp"
#include "tests/support/hazards.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"

namespace hazard_chip_test {

using cn::LaneMask;
using cn::Machine;
using model::PioArbitration;
using model::TimingStyle;
using path_tracer::Program;
using test_support::expect_parts;
using test_support::fault_of;
using test_support::kStart;
using test_support::test_chip;
using testbench::RenderOptions;
using testbench::RenderResult;

constexpr PioArbitration kArbitrations[] = {
    PioArbitration::strict_fifo, PioArbitration::reads_overtake_writes, PioArbitration::queue_per_direction};

class HazardOnChip : public test_support::ControlBench, public testing::WithParamInterface<TimingStyle> {
 protected:
  void check(const model::ChipConfig& config = test_chip()) {
    build(config, GetParam());
    checker = std::make_unique<model::HazardChecker>(chip->control_unit,
                                                     [this] { return chip->control_unit.now(); });
    chip->control_unit.set_access_observer(checker.get());
  }
  std::string fault() {
    return fault_of([this] { chip->control_unit.require_finished(); });
  }

  std::unique_ptr<model::HazardChecker> checker;
};

TEST_P(HazardOnChip, IsFoundHoweverLongTheTransferHasBeenOver) {
  check();
  run([](Machine& machine) {
    machine.poly_memory().allocate("loaded", 32);
    const cn::Semaphore done = machine.allocate_semaphore("done");
    machine.issue_mono(30);
    load(machine, done);
    machine.issue_mono(1000000);
    machine.number_ascending(LaneMask::first(8), {8});
  });
  EXPECT_EQ(fault(),
            "hazard at cycle 1001030: kernel 'number_ascending' writes 'loaded' (poly bytes 8..11) of PE 0, "
            "which request 0 (load, 256 bytes, started at cycle 1030, semaphore 'done') still writes");
}

TEST_P(HazardOnChip, AWaitMakesItSound) {
  check();
  run_well([](Machine& machine) {
    const cn::Semaphore done = machine.allocate_semaphore("done");
    load(machine, done);
    machine.sem_wait(done);
    machine.number_ascending(LaneMask::first(8), {8});
    save(machine, done);
    machine.sem_wait(done);
  });
  EXPECT_EQ(checker->outstanding(), 0u);
}

/// The order in which a wait tells is the engine's, whatever the arbitration: the first of two loads is over
/// when the first wait returns, though a save of the same semaphore may be earlier or later.
TEST_P(HazardOnChip, OneDirectionFinishesInTheOrderOfItsStarts) {
  struct Order : model::PioObserver {
    void started(const model::PioEvent&) override {}
    void finished(const model::PioEvent& event) override {
      model::Cycles& last = finish[std::size_t(event.direction)];
      EXPECT_LT(last, event.finished);
      EXPECT_LT(id[std::size_t(event.direction)], int(event.id));
      last = event.finished;
      id[std::size_t(event.direction)] = int(event.id);
      ++requests;
    }
    std::array<model::Cycles, 2> finish{};
    std::array<int, 2> id{-1, -1};
    int requests = 0;
  } order;
  for (const PioArbitration arbitration : kArbitrations) {
    sc_core::sc_curr_simcontext = new sc_core::sc_simcontext();
    sc_core::sc_default_global_context = sc_core::sc_curr_simcontext;
    order = Order{};
    model::ChipConfig config = test_chip();
    config.pio.arbitration = arbitration;
    config.pio.queue_depth = 8;
    build(config, GetParam());
    chip->pio_engine.set_observer(&order);
    run_well([](Machine& machine) {
      const cn::Semaphore done = machine.allocate_semaphore("done");
      for (int i = 0; i < 4; ++i) {
        save(machine, done);
        load(machine, done);
        machine.async_copy_p2m(done, cn::MonoPlaces::array(4096, 8), {0, 8}, LaneMask::first(1));
        machine.async_copy_m2p(done, {0, 8}, cn::MonoPlaces::array(0, 8), LaneMask::first(1));
      }
      for (int i = 0; i < 16; ++i) machine.sem_wait(done);
    });
    EXPECT_EQ(order.requests, 16);
  }
}

TEST_P(HazardOnChip, RequestsHaveTheEnginesNumbers) {
  struct Ids : model::PioObserver {
    void started(const model::PioEvent& event) override { enqueued[event.id] = event.enqueued; }
    void finished(const model::PioEvent&) override {}
    std::map<std::uint64_t, model::Cycles> enqueued;
  } ids;
  check();
  chip->pio_engine.set_observer(&ids);
  run([](Machine& machine) {
    const cn::Semaphore done = machine.allocate_semaphore("done");
    for (int i = 0; i < 3; ++i) {
      load(machine, done, LaneMask{});  // without a PE, so it has no number
      load(machine, done);
      machine.sem_wait(done), machine.sem_wait(done);
      const cn::Untimed untimed(machine);
      load(machine, done);  // neither has this one
    }
    load(machine, done);
    machine.issue_mono(7);
    machine.number_ascending(LaneMask::first(8), {8});
  });
  if (GetParam() == TimingStyle::loosely_timed) chip->pio_engine.serve_next();
  ASSERT_EQ(ids.enqueued.size(), 4u);
  expect_parts(fault(), {"request 3 (load", "started at cycle " + std::to_string(ids.enqueued.at(3)) + ","});
}

/// It makes no difference how the control unit came to this cycle and who carries the data.
INSTANTIATE_TEST_SUITE_P(Timing, HazardOnChip,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const auto& style) {
                           return style.param == TimingStyle::loosely_timed ? "Loose" : "Approximate";
                         });

RenderResult render(const testbench::Scene& scene, const RenderOptions& options) {
  sc_core::sc_curr_simcontext = new sc_core::sc_simcontext();
  sc_core::sc_default_global_context = sc_core::sc_curr_simcontext;
  return testbench::render_on_chip(scene, options);
}

std::string statistics(const RenderOptions& options, const RenderResult& result) {
  nlohmann::ordered_json json = testbench::render_statistics({"scene", options, false}, result);
  json.erase("simulator");
  return json.dump(1);
}

void expect_no_change(const testbench::Scene& scene, RenderOptions options) {
  options.check_hazards = false;
  const RenderResult plain = render(scene, options);
  options.check_hazards = true;
  const RenderResult checked = render(scene, options);
  EXPECT_EQ(statistics(options, checked), statistics(options, plain));
  EXPECT_EQ(checked.film.sha256(), plain.film.sha256());
  EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), plain.film.sha256());
}

TEST(CheckedRender, HasTheSameBitsCyclesAndStatistics) {
  const testbench::Scene scene = test_support::small_cornell_box({17, 5});
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    for (const int n : {0, 1, 2, 3, 8}) {
      for (const bool loads : {false, true}) {
        for (const bool saves : {false, true}) {
          SCOPED_TRACE(testing::Message() << "n " << n << " loads " << loads << " saves " << saves);
          RenderOptions options = test_support::render_options(program, 24);
          options.program.n = n;
          options.program.buffer_loads = loads;
          options.program.buffer_saves = saves;
          expect_no_change(scene, options);
        }
      }
    }
  }
}

TEST(CheckedRender, HasTheSameBitsAndCyclesApproximatelyTimed) {
  const testbench::Scene scene = test_support::small_cornell_box({6, 4});
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    for (const int n : {0, 1, 3}) {
      SCOPED_TRACE(testing::Message() << "n " << n);
      RenderOptions options = test_support::render_options(program, 8);
      options.timing = TimingStyle::approximately_timed;
      options.chip.chip.pes = 16;
      options.program.n = n;
      expect_no_change(scene, options);
    }
  }
}

TEST(CheckedRender, RunsCleanOnEveryChip) {
  const testbench::Scene scene = test_support::small_cornell_box({17, 5});
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    for (const PioArbitration arbitration : kArbitrations) {
      for (const int pes : {16, 96, 256}) {
        for (const int blocks : {1, 2, 16}) {
          SCOPED_TRACE(testing::Message()
                       << int(arbitration) << ", " << pes << " PEs, " << blocks << " blocks");
          RenderOptions options = test_support::render_options(program, 24);
          options.chip.pio.arbitration = arbitration;
          options.chip.chip.pes = pes;
          options.chip.host.latency_cycles = blocks == 2 ? 1000000 : 2100;
          options.program.bin_blocks = blocks;
          options.program.n = std::min(3, blocks);
          options.program.slot_vertices = 4;
          expect_no_change(scene, options);
        }
      }
    }
  }
}

}  // namespace hazard_chip_test
