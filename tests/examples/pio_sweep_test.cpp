#include "firmware/examples/pio_sweep.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "testbench/machine/native_machine.hpp"

namespace pio_sweep_test {

using examples::PioSweep;

constexpr std::uint64_t kMonoBytes = 1 << 16;
constexpr std::uint64_t kCopy = kMonoBytes / 2;

/// Loads a pattern and saves it elsewhere.
std::vector<std::uint8_t> copied(PioSweep::Pattern pattern) {
  testbench::NativeMachine machine(24, 6144, kMonoBytes);
  for (std::uint64_t i = 0; i < kCopy; ++i) machine.mono()[i] = std::uint8_t(1 + i % 251);
  PioSweep sweep(machine, 512);
  sweep.load(pattern, 3);
  pattern.address += kCopy;
  sweep.save(pattern, 2);
  return {machine.mono(), machine.mono() + kMonoBytes};
}

TEST(PioSweepExample, CopiesThePiecesOfThePesThatTakePartAndNothingElse) {
  for (const PioSweep::Pattern& pattern :
       {PioSweep::Pattern{24, 512, 0, 512}, PioSweep::Pattern{1, 8, 56, 64},
        PioSweep::Pattern{13, 80, 56, 192}}) {
    const std::vector<std::uint8_t> mono = copied(pattern);
    std::vector<std::uint8_t> expected(kCopy, 0);
    for (int pe = 0; pe < pattern.pes; ++pe)
      for (int byte = 0; byte < pattern.bytes; ++byte) {
        const std::uint64_t at =
            pattern.address + std::uint64_t(pe) * pattern.stride_bytes + std::uint64_t(byte);
        expected[at] = std::uint8_t(1 + at % 251);
      }
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), mono.begin() + kCopy)) << pattern.bytes;
  }
}

TEST(PioSweepExample, PieceMustFitItsBuffer) {
  testbench::NativeMachine machine(8, 6144, kMonoBytes);
  EXPECT_THROW(PioSweep(machine, 6144), cn::PolyMemoryOverflow);
  PioSweep sweep(machine, 6128);
  EXPECT_THROW(sweep.load({8, 6136, 0, 6144}, 1), cn::MachineFault);
}

}  // namespace pio_sweep_test
