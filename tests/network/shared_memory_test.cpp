// Several chips on one memory: they contend for it in the order of time, loosely as approximately timed.

#include "examples/platforms/shared_memory.hpp"

#include <cmath>
#include <memory>

#include "model/csx600.hpp"
#include "tests/support/protocol_checker.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"

namespace shared_memory_test {

using model::Cycles;
using model::TimingStyle;
using sc_core::sc_time;

constexpr int kRounds = 400;
constexpr int kBytesPerPe = 128;
constexpr int kPes = 8;

/// Loads and saves in turns with two buffers, and reads and writes mono memory itself now and then.
void stream(cn::Machine& machine, cn::MonoAddress first) {
  const cn::Semaphore loaded = machine.allocate_semaphore("loaded");
  const cn::Semaphore saved = machine.allocate_semaphore("saved");
  const cn::LaneMask all = cn::LaneMask::first(kPes);
  for (int round = 0; round < kRounds; ++round) {
    const cn::PolySpan buffer{round % 2 * kBytesPerPe, kBytesPerPe};
    const cn::MonoAddress place = first + std::uint64_t(round % 32) * kPes * kBytesPerPe;
    if (round >= 2) machine.sem_wait(saved);
    machine.async_copy_m2p(loaded, buffer, cn::MonoPlaces::array(place, kBytesPerPe), all);
    machine.issue_mono(50);
    machine.sem_wait(loaded);
    machine.async_copy_p2m(saved, cn::MonoPlaces::array(place, kBytesPerPe), buffer, all);
    if (round % 16 == 0) machine.write_mono(cn::MonoPointer<std::uint64_t>{place}, std::uint64_t(round));
  }
  for (int i = 0; i < 2; ++i) machine.sem_wait(saved);
}

struct Outcome {
  std::vector<Cycles> cycles;  ///< by chip
  double memory_busy;          ///< share of the time
};

class SharedMemory : public test_support::SystemCFixture {
 protected:
  ~SharedMemory() override { tlm::tlm_global_quantum::instance().set(sc_core::SC_ZERO_TIME); }

  void expect_fair_sharing(double bytes_per_second, double bound);
  /// @param starts when each chip's firmware starts, in ns
  static Outcome run(TimingStyle timing, double bytes_per_second, const std::vector<double>& starts) {
    new_context();
    model::ChipConfig config = test_support::test_chip(kPes);
    examples::SharedMemory memory("memory", int(starts.size()), config.ddr.size_bytes, bytes_per_second,
                                  sc_time(20, sc_core::SC_NS));
    std::vector<std::unique_ptr<model::Csx600>> chips;
    std::vector<std::unique_ptr<test_support::ProtocolChecker>> checkers;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      chips.push_back(std::make_unique<model::Csx600>(("chip" + std::to_string(i)).c_str(), config, timing,
                                                      model::MonoMemory::bound_outside));
      model::Csx600& chip = *chips.back();
      checkers.push_back(
          std::make_unique<test_support::ProtocolChecker>(("checker" + std::to_string(i)).c_str()));
      chip.clear_connect.ddr_socket.bind(checkers.back()->in);
      checkers.back()->out.bind(memory.sockets[i]);
      chip.control_unit.load([i](cn::Machine& machine) { stream(machine, i * 256 * 1024); });
      sc_core::sc_spawn([&chip, start = starts[i]] {
        sc_core::wait(sc_time(start, sc_core::SC_NS));
        chip.control_unit.start();
      });
    }
    sc_core::sc_start(sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
    for (const auto& checker : checkers) {
      EXPECT_EQ(checker->violations(), std::vector<std::string>{});
      EXPECT_EQ(checker->active(), 0u);
    }
    Outcome outcome{{}, memory.busy() / sc_core::sc_time_stamp()};
    for (const auto& chip : chips) {
      chip->control_unit.require_finished();
      EXPECT_EQ(chip->pio_engine.statistics().late_starts, 0u);
      outcome.cycles.push_back(chip->control_unit.statistics().total());
    }
    return outcome;
  }
};

constexpr double kSlow = 1e9;    ///< bytes a second: one chip nearly fills it
constexpr double kMedium = 2e9;  ///< one chip uses three quarters of it
constexpr double kFast = 64e9;   ///< two chips hardly notice each other

double difference(Cycles a, Cycles b) {
  return std::abs(double(a) / double(b) - 1);
}

/// @param bound of the difference between loosely and approximately timed
void SharedMemory::expect_fair_sharing(double bytes_per_second, double bound) {
  const Outcome alone = run(TimingStyle::loosely_timed, bytes_per_second, {0});
  const Outcome loose = run(TimingStyle::loosely_timed, bytes_per_second, {0, 0});
  const Outcome approximate = run(TimingStyle::approximately_timed, bytes_per_second, {0, 0});
  EXPECT_GT(loose.memory_busy, 0.9);
  EXPECT_GT(approximate.memory_busy, 0.9);
  EXPECT_LT(difference(loose.cycles[0], loose.cycles[1]), 0.01);
  EXPECT_LT(difference(approximate.cycles[0], approximate.cycles[1]), 0.01);
  for (std::size_t chip = 0; chip < 2; ++chip) {
    EXPECT_GT(double(loose.cycles[chip]), 1.4 * double(alone.cycles[0]));
    EXPECT_LT(difference(loose.cycles[chip], approximate.cycles[chip]), bound);
  }
}

TEST_F(SharedMemory, EqualChipsShareItEqually) {
  expect_fair_sharing(kSlow, 0.02);
  expect_fair_sharing(kMedium, 0.02);
}

/// Each of three, and of four, takes what the memory takes for all of them.
TEST_F(SharedMemory, ThreeAndFourShareItEqually) {
  for (const std::size_t chips : {std::size_t(3), std::size_t(4)}) {
    const std::vector<double> starts(chips, 0);
    const Outcome loose = run(TimingStyle::loosely_timed, kSlow, starts);
    const Outcome approximate = run(TimingStyle::approximately_timed, kSlow, starts);
    EXPECT_GT(loose.memory_busy, 0.97);
    EXPECT_GT(approximate.memory_busy, 0.97);
    for (std::size_t chip = 0; chip < chips; ++chip) {
      EXPECT_LT(difference(loose.cycles[chip], loose.cycles[0]), 0.01) << chips;
      EXPECT_LT(difference(approximate.cycles[chip], approximate.cycles[0]), 0.01) << chips;
      EXPECT_LT(difference(loose.cycles[chip], approximate.cycles[chip]), 0.02) << chips;
    }
  }
}

TEST_F(SharedMemory, AFastOneHoldsUpNobody) {
  for (const TimingStyle timing : {TimingStyle::loosely_timed, TimingStyle::approximately_timed}) {
    const Cycles alone = run(timing, kFast, {0}).cycles[0];
    for (const Cycles cycles : run(timing, kFast, {0, 0}).cycles) EXPECT_LT(difference(cycles, alone), 0.02);
  }
}

TEST_F(SharedMemory, OneAfterTheOtherIsAsAlone) {
  for (const TimingStyle timing : {TimingStyle::loosely_timed, TimingStyle::approximately_timed}) {
    const Cycles alone = run(timing, kSlow, {0}).cycles[0];
    const Outcome both = run(timing, kSlow, {double(2 * alone), 0});
    EXPECT_EQ(both.cycles, (std::vector<Cycles>{alone, alone}));
  }
}

/// A quantum shorter than a request changes hardly anything.
TEST_F(SharedMemory, ChipsThatRunAheadByAQuantumStillShareIt) {
  const Outcome exact = run(TimingStyle::loosely_timed, kSlow, {0, 0});
  tlm::tlm_global_quantum::instance().set(sc_time(500, sc_core::SC_NS));
  for (const Cycles cycles : run(TimingStyle::loosely_timed, kSlow, {0, 0}).cycles)
    EXPECT_LT(difference(cycles, exact.cycles[0]), 0.01);
}

/// Alone on its own memory, a chip gives the same cycles with every quantum.
TEST_F(SharedMemory, AQuantumChangesNoCycleOfAChipAlone) {
  std::vector<Cycles> cycles;
  for (const double quantum_nanoseconds : {0.0, 1.0, 333.3, 1e6}) {
    tlm::tlm_global_quantum::instance().set(sc_time(quantum_nanoseconds, sc_core::SC_NS));
    new_context();
    model::Csx600 chip("chip", test_support::test_chip(kPes));
    Cycles furthest_ahead = 0;
    chip.control_unit.load([&](cn::Machine& machine) {
      stream(machine, 0);
      furthest_ahead = chip.control_unit.now() - chip.clock.cycle_at(sc_core::sc_time_stamp());
    });
    elaborate();
    chip.control_unit.start();
    sc_core::sc_start(sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
    chip.control_unit.require_finished();
    cycles.push_back(chip.control_unit.statistics().total());
    if (quantum_nanoseconds > 0) {
      EXPECT_LE(double(furthest_ahead), quantum_nanoseconds + 400);  // and the last request
    } else {
      EXPECT_EQ(furthest_ahead, cycles[0]);
    }
  }
  EXPECT_EQ(cycles, std::vector<Cycles>(4, cycles[0]));
}

}  // namespace shared_memory_test
