// The example programs under the hazard checker: sound, and stopped whichever wait is left out.

#include <functional>

#include "firmware/examples/dgemm.hpp"
#include "firmware/examples/fft.hpp"
#include "firmware/examples/monte_carlo.hpp"
#include "firmware/examples/pio_sweep.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "tests/support/broken_machine.hpp"
#include "tests/support/hazards.hpp"

namespace hazard_examples_test {

using test_support::BrokenMachine;
using test_support::expect_one_line;
using test_support::expect_parts;

using Firmware = std::function<void(cn::Machine&)>;

struct Run {
  std::string fault;
  std::vector<int> waits;
};

/// All of mono memory is zero: accesses do not depend on the numbers.
Run run_checked(const Firmware& firmware, int num_pes, int dropped_wait = -1) {
  BrokenMachine machine(num_pes, 6144, 16u << 20, dropped_wait);
  model::HazardChecker checker(machine);
  machine.set_access_observer(&checker);
  const std::string fault = test_support::fault_of([&] {
    firmware(machine);
    checker.firmware_ends();
  });
  return {fault, machine.needed_waits()};
}

void expect_sound_and_every_wait_needed(const Firmware& firmware, int num_pes) {
  const Run sound = run_checked(firmware, num_pes);
  EXPECT_EQ(sound.fault, "");
  EXPECT_FALSE(sound.waits.empty());
  for (const int wait : sound.waits) {
    const Run broken = run_checked(firmware, num_pes, wait);
    expect_one_line(broken.fault);
    expect_parts(broken.fault, {"hazard", "request ", " bytes, ", "semaphore '"});
  }
}

TEST(HazardsOfExamples, Dgemm) {
  examples::Dgemm::Problem problem;
  problem.row_blocks = 2;
  problem.column_blocks = 2;
  problem.c = {8u << 20};
  const Firmware dgemm = [&](cn::Machine& machine) {
    examples::Dgemm(machine, examples::observed_kernels(), problem).run();
  };
  expect_sound_and_every_wait_needed(dgemm, 24);
  EXPECT_EQ(run_checked(dgemm, 96).fault, "");
}

TEST(HazardsOfExamples, Fft) {
  constexpr std::uint64_t kPixels = 2 * examples::kFftSize * examples::kFftSize;
  examples::Fft::Layout layout;
  layout.count = 2;
  layout.tiles = layout.images + kPixels;
  layout.results = layout.tiles + kPixels;
  layout.twiddles = layout.results + kPixels;
  const Firmware fft = [&](cn::Machine& machine) {
    examples::Fft(machine, examples::observed_kernels(), layout).run();
  };
  expect_sound_and_every_wait_needed(fft, 1024);
  EXPECT_EQ(run_checked(fft, 96).fault, "");
}

TEST(HazardsOfExamples, MonteCarlo) {
  expect_sound_and_every_wait_needed(
      [](cn::Machine& machine) {
        examples::MonteCarlo(machine, examples::observed_kernels(), examples::MonteCarlo::Problem{}).run();
      },
      96);
}

TEST(HazardsOfExamples, PioSweep) {
  expect_sound_and_every_wait_needed(
      [](cn::Machine& machine) {
        examples::PioSweep sweep(machine, 64);
        const examples::PioSweep::Pattern pattern{96, 64, 0, 64};
        sweep.load(pattern, 3);
        sweep.save(pattern, 3);
      },
      96);
}

}  // namespace hazard_examples_test
