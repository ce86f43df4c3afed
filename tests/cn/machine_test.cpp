#include "firmware/cn/machine.hpp"

#include <cstring>
#include <functional>
#include <random>

#include "testbench/machine/native_machine.hpp"
#include "tests/support/poly_words.hpp"
#include "tests/support/strip_fixture.hpp"

namespace machine_test {

using cn::Direction;
using cn::InstructionClass;
using cn::LaneMask;
using cn::MachineFault;
using cn::MonoAddress;
using cn::MonoPlaces;
using cn::PolyField;
using cn::PolySpan;
using test_support::counts;

constexpr int kPolyBytes = 256;
constexpr std::uint64_t kMonoBytes = 1 << 16;

/// Keeps what every kernel issued.
class CountingMachine : public testbench::NativeMachine {
 public:
  explicit CountingMachine(int num_pes) : NativeMachine(num_pes, kPolyBytes, kMonoBytes) {}

  cn::IssueCounts issued;
  std::string last_kernel;

 protected:
  void retire(const char* kernel, const cn::IssueTree& tree) override {
    issued += tree.total();
    last_kernel = kernel;
  }
};

class CnMachine : public testing::Test {
 protected:
  CnMachine() {
    std::mt19937_64 bits(6);
    for (std::uint64_t i = 0; i < kMonoBytes; ++i) machine.mono()[i] = static_cast<std::uint8_t>(bits());
    for (int w = 0; w < kPolyBytes / 8 * kPes; ++w) machine.poly_memory().words()[w] = bits();
  }

  std::vector<std::uint64_t> poly_words() {
    return test_support::poly_words(machine.poly_memory(), kPolyBytes);
  }
  std::vector<std::uint8_t> mono_bytes() { return {machine.mono(), machine.mono() + kMonoBytes}; }

  /// Moves the data as the definition of a transfer says, one word of one PE after the other.
  template <class AddressOf>
  void expect_moves(Direction direction, PolySpan span, const MonoPlaces& places, const LaneMask& enabled,
                    AddressOf address_of) {
    std::vector<std::uint64_t> poly = poly_words();
    std::vector<std::uint8_t> mono = mono_bytes();
    for (int pe = 0; pe < kPes; ++pe) {
      if (!enabled[pe]) continue;
      for (int byte = 0; byte < span.size_bytes; byte += 8) {
        std::uint64_t* const word = &poly[std::size_t((span.offset_bytes + byte) / 8 * kPes + pe)];
        std::uint8_t* const place = &mono[address_of(pe) + std::uint64_t(byte)];
        if (direction == Direction::mono_to_poly) {
          std::memcpy(word, place, 8);
        } else {
          std::memcpy(place, word, 8);
        }
      }
    }
    if (direction == Direction::mono_to_poly) {
      machine.async_copy_m2p(done, span, places, enabled);
    } else {
      machine.async_copy_p2m(done, places, span, enabled);
    }
    machine.sem_wait(done);
    EXPECT_EQ(poly_words(), poly);
    EXPECT_EQ(mono_bytes(), mono);
  }

  LaneMask random_pes() {
    LaneMask pes;
    for (int pe = 0; pe < kPes; ++pe) pes.set(pe, random() % 3 != 0);
    if (random() % 2) pes.set_strip_bits(1, 0xff);
    if (random() % 2) pes.set_strip_bits(2, 0);
    return pes;
  }

  void expect_fault(const std::function<void()>& act, const std::string& message) {
    const std::vector<std::uint64_t> poly = poly_words();
    const std::vector<std::uint8_t> mono = mono_bytes();
    try {
      act();
      ADD_FAILURE() << "no fault";
    } catch (const MachineFault& fault) {
      EXPECT_EQ(fault.what(), message);
    }
    EXPECT_EQ(poly_words(), poly);
    EXPECT_EQ(mono_bytes(), mono);
  }

  static constexpr int kPes = 24;
  CountingMachine machine{kPes};
  cn::Semaphore done = machine.allocate_semaphore("done");
  const LaneMask all = LaneMask::first(kPes);
  std::mt19937 random{1};
};

TEST_F(CnMachine, ArraysMoveBothWaysForEnabledPesOnly) {
  for (int round = 0; round < 40; ++round) {
    const Direction direction = round % 2 ? Direction::mono_to_poly : Direction::poly_to_mono;
    const int words = 1 + static_cast<int>(random() % 5);
    const PolySpan span{static_cast<int>(random() % 20) * 8, words * 8};
    const MonoAddress first = 8 * (random() % 100);
    const std::uint64_t stride = std::uint64_t(words + static_cast<int>(random() % 2)) * 8;
    expect_moves(direction, span, MonoPlaces::array(first, stride), round < 4 ? all : random_pes(),
                 [&](int pe) { return first + std::uint64_t(pe) * stride; });
  }
}

TEST_F(CnMachine, EachPeSuppliesItsOwnAddress) {
  const PolyField<MonoAddress> addresses{240 - 8};
  for (int round = 0; round < 40; ++round) {
    const Direction direction = round % 2 ? Direction::mono_to_poly : Direction::poly_to_mono;
    std::vector<MonoAddress> table;
    for (int pe = 0; pe < kPes; ++pe)  // no two PEs write to one place
      table.push_back(machine.poly_memory().word(pe, addresses.offset_bytes) =
                          (std::uint64_t((pe * 7 + round) % kPes) * 64 + random() % 3 * 8));
    const std::uint64_t offset = random() % 2 * 2048;
    expect_moves(direction, {8 * static_cast<int>(random() % 20), 40}, machine.places_in(addresses, offset),
                 random_pes(), [&](int pe) { return table[std::size_t(pe)] + offset; });
  }
}

TEST_F(CnMachine, AGatherMayReplaceItsOwnAddresses) {
  const PolyField<MonoAddress> addresses{64};
  std::vector<MonoAddress> table;
  for (int pe = 0; pe < kPes; ++pe)
    table.push_back(machine.poly_memory().word(pe, 64) = std::uint64_t(kPes - pe) * 8);
  expect_moves(Direction::mono_to_poly, {64, 8}, machine.places_in(addresses), all,
               [&](int pe) { return table[std::size_t(pe)]; });
}

TEST_F(CnMachine, ATransferWithoutPesSignalsAllTheSame) {
  expect_moves(Direction::mono_to_poly, {0, 16}, MonoPlaces::array(kMonoBytes, 8), LaneMask{},
               [](int) { return 0u; });
  expect_moves(Direction::poly_to_mono, {0, 0}, MonoPlaces::array(0, 8), all, [](int) { return 0u; });
}

TEST_F(CnMachine, EveryAddressAndSizeIsInWholeWords) {
  const MonoPlaces array = MonoPlaces::array(0, 8);
  expect_fault(
      [&] {
        machine.async_copy_m2p(done, {16, 12}, array, all);
      },
      "transfer of poly offset 16: size is 12, must be a multiple of 8");
  expect_fault(
      [&] {
        machine.async_copy_p2m(done, array, {20, 16}, all);
      },
      "transfer of poly offset 20: poly offset is 20, must be a multiple of 8");
  expect_fault(
      [&] {
        machine.async_copy_m2p(done, {16, 16}, MonoPlaces::array(4, 8), all);
      },
      "transfer of poly offset 16: mono address is 4, must be a multiple of 8");
  expect_fault(
      [&] {
        machine.async_copy_p2m(done, MonoPlaces::array(8, 12), {16, 16}, all);
      },
      "transfer of poly offset 16: stride is 12, must be a multiple of 8");
  for (int pe = 0; pe < kPes; ++pe) machine.poly_memory().word(pe, 0) = std::uint64_t(8 * pe);
  machine.poly_memory().word(17, 0) = 33;
  expect_fault(
      [&] {
        machine.async_copy_m2p(done, {16, 16}, machine.places_in({0}, 8), all);
      },
      "transfer of poly offset 16: mono address of PE 17 is 41, must be a multiple of 8");
  LaneMask others = all;
  others.set(17, false);
  machine.async_copy_m2p(done, {16, 16}, machine.places_in({0}, 8), others);
  machine.sem_wait(done);
}

TEST_F(CnMachine, TransfersStayInBothMemories) {
  const MonoPlaces array = MonoPlaces::array(0, 8);
  expect_fault(
      [&] {
        machine.async_copy_m2p(done, {232, 16}, array, all);
      },
      "transfer of 16 bytes at poly offset 232 leaves the 240 bytes of poly SRAM");
  expect_fault(
      [&] {
        machine.async_copy_p2m(done, array, {-8, 16}, all);
      },
      "transfer of 16 bytes at poly offset -8 leaves the 240 bytes of poly SRAM");
  expect_fault(
      [&] {
        machine.async_copy_m2p(done, {0, 16}, MonoPlaces::array(kMonoBytes - 23 * 8 - 8, 8), all);
      },
      "transfer of 16 bytes at 65528 leaves mono memory of 65536 bytes");
  machine.async_copy_m2p(done, {0, 8}, MonoPlaces::array(kMonoBytes - 23 * 8 - 8, 8), all);
  LaneMask last;
  last.set(23, true);
  expect_fault(
      [&] {
        machine.async_copy_p2m(done, MonoPlaces::array(0, ~std::uint64_t{7}), {0, 8}, last);
      },
      "transfer of 8 bytes at 18446744073709551432 leaves mono memory of 65536 bytes");
}

TEST_F(CnMachine, MonoMemoryReadsAndWrites) {
  const cn::MonoPointer<double> pointer{64};
  machine.write_mono(pointer + 2, 1.25);
  EXPECT_EQ(machine.read_mono(pointer, 3)[2], 1.25);
  EXPECT_EQ(*machine.read_mono(cn::MonoPointer<double>{80}), 1.25);
  const cn::MonoPointer<double> last{kMonoBytes - 8};
  machine.write_mono(last, 2.5);
  EXPECT_EQ(*machine.read_mono(last), 2.5);
  expect_fault([&] { machine.read_mono(last, 2); },
               "mono read of 16 bytes at 65528 leaves mono memory of 65536 bytes");
  expect_fault([&] { machine.write_mono(last + 1, 2.5); },
               "mono write of 8 bytes at 65536 leaves mono memory of 65536 bytes");
}

TEST_F(CnMachine, SemaphoresCount) {
  const cn::Semaphore semaphore = machine.allocate_semaphore("steps");
  EXPECT_EQ(machine.semaphore_name(semaphore), "steps");
  machine.sem_signal(semaphore);
  machine.sem_signal(semaphore);
  machine.sem_wait(semaphore);
  machine.sem_wait(semaphore);
  expect_fault([&] { machine.sem_wait(semaphore); }, "wait on semaphore 'steps' that nothing will signal");
  machine.async_copy_m2p(done, {0, 8}, MonoPlaces::array(0, 8), all);
  expect_fault([&] { machine.sem_wait(semaphore); }, "wait on semaphore 'steps' that nothing will signal");
  machine.sem_wait(done);
}

TEST_F(CnMachine, SixtyFourSemaphores) {
  for (int i = 1; i < cn::Machine::kSemaphores; ++i) EXPECT_EQ(machine.allocate_semaphore("more").index, i);
  expect_fault([&] { machine.allocate_semaphore("one too many"); },
               "no semaphore left for 'one too many': the chip has 64");
}

TEST_F(CnMachine, TheHostAnswersASignalAtOnce) {
  int served = 0;
  machine.on_signal(done, [&] { ++served; });
  machine.sem_signal(done);
  EXPECT_EQ(served, 1);
  expect_fault([&] { machine.sem_wait(done); }, "wait on semaphore 'done' that nothing will signal");
}

TEST_F(CnMachine, KernelsRunOnEnabledPesAndAreRetired) {
  const PolyField<std::int32_t> field{12};
  const auto program = [&] { field.write(cn::pe_num() + 100); };
  using Program = std::decay_t<decltype(program)>;
  const cn::Kernel<Program> kernel{"number", &cn::run_strips<Program, &test_support::call<Program>>};
  const std::vector<std::uint64_t> before = poly_words();
  machine.run(kernel, program, LaneMask::first(11));
  EXPECT_EQ(machine.last_kernel, "number");
  EXPECT_EQ(machine.issued, counts({{InstructionClass::sram, 2}, {InstructionClass::int32_alu, 1}}));
  const std::vector<std::uint64_t> after = poly_words();
  for (int pe = 0; pe < kPes; ++pe)
    EXPECT_EQ(after[std::size_t(kPes + pe)] >> 32,
              pe < 11 ? std::uint64_t(100 + pe) : before[std::size_t(kPes + pe)] >> 32);
}

TEST_F(CnMachine, CountsAreReductions) {
  LaneMask some;
  for (const int pe : {0, 5, 23}) some.set(pe, true);
  EXPECT_EQ(machine.count(some), 3);
  EXPECT_EQ(machine.count(LaneMask{}), 0);
  EXPECT_EQ(machine.issued, counts({{InstructionClass::reduce, 2}}));
}

TEST_F(CnMachine, SwazzleMovesToTheNeighbourAndEndsKeepTheirs) {
  const std::vector<std::uint64_t> before = poly_words();
  machine.swazzle_up({16});
  machine.swazzle_down({32});
  std::vector<std::uint64_t> expected = before;
  for (int pe = 1; pe < kPes; ++pe)
    expected[std::size_t(2 * kPes + pe)] = before[std::size_t(2 * kPes + pe - 1)];
  for (int pe = 0; pe < kPes - 1; ++pe)
    expected[std::size_t(4 * kPes + pe)] = before[std::size_t(4 * kPes + pe + 1)];
  EXPECT_EQ(poly_words(), expected);
  EXPECT_EQ(machine.issued, counts({{InstructionClass::swazzle, 2}, {InstructionClass::sram, 8}}));
}

/// The paper's numbering, step by step: a running count of the chosen PEs by doubling distance along the
/// path. Returns each PE's number and leaves what it issued.
std::vector<std::int32_t> walk_numbers(CountingMachine& machine, const LaneMask& chosen) {
  const PolyField<std::int64_t> sum{0};
  const PolyField<std::int64_t> moving{8};
  const LaneMask all = LaneMask::first(machine.num_pes());
  const auto run = [&](const auto& program) {
    using Program = std::decay_t<decltype(program)>;
    const cn::Kernel<Program> kernel{"walk", &cn::run_strips<Program, &test_support::call<Program>>};
    machine.run(kernel, program, all);
  };
  run([&] {
    sum.write(cn::select(cn::recall(chosen), cn::poly<std::int64_t>(1), cn::poly<std::int64_t>(0)));
  });
  for (int distance = 1; distance < machine.num_pes(); distance *= 2) {
    run([&] { moving.write(sum.read()); });
    for (int step = 0; step < distance; ++step) machine.swazzle_up({moving.offset_bytes});
    run([&] { cn::poly_if(cn::pe_num() >= distance, [&] { sum.write(sum.read() + moving.read()); }); });
  }
  std::vector<std::int32_t> numbers;
  for (int pe = 0; pe < machine.num_pes(); ++pe)
    numbers.push_back(static_cast<std::int32_t>(machine.poly_memory().word(pe, 0)) - 1);
  return numbers;
}

TEST(NumberAscending, EqualsAWalkAlongThePath) {
  std::mt19937 random(12);
  for (const int width : {16, 24, 96, 128, 192, 512, 1024}) {
    for (const unsigned density : {0u, 1u, 50u, 99u, 100u}) {
      SCOPED_TRACE(std::to_string(width) + " PEs, " + std::to_string(density) + " percent");
      LaneMask chosen;
      for (int pe = 0; pe < width; ++pe) chosen.set(pe, random() % 100 < density);
      CountingMachine walked(width);
      const std::vector<std::int32_t> expected = walk_numbers(walked, chosen);

      for (const int offset : {16, 20}) {
        CountingMachine machine(width);
        for (int pe = 0; pe < width; ++pe) machine.poly_memory().word(pe, 16) = 0x5555555544444444u;
        EXPECT_EQ(machine.number_ascending(chosen, {offset}), chosen.count());
        EXPECT_EQ(machine.last_kernel, "number_ascending");
        for (int pe = 0; pe < width; ++pe) {
          const auto number = std::uint64_t(std::uint32_t(expected[std::size_t(pe)]));
          const std::uint64_t low = offset == 16 && chosen[pe] ? number : 0x44444444u;
          const std::uint64_t high = offset == 20 && chosen[pe] ? number : 0x55555555u;
          ASSERT_EQ(machine.poly_memory().word(pe, 16), high << 32 | low) << "PE " << pe;
        }
        EXPECT_EQ(machine.issued[InstructionClass::swazzle], walked.issued[InstructionClass::swazzle]);
        EXPECT_EQ(machine.issued[InstructionClass::enable], walked.issued[InstructionClass::enable]);
        EXPECT_EQ(machine.issued[InstructionClass::reduce], 1u);
      }
    }
  }
}

/// Each PE's number is the count of what the PEs to its left have, and the work is that of one thing a PE
/// and a sum of its own.
TEST(NumberAscending, OfSeveralThingsInAPeIsARunningSum) {
  std::mt19937 random(5);
  for (const int width : {16, 96, 1024}) {
    LaneMask chosen[3];
    for (LaneMask& mask : chosen)
      for (int pe = 0; pe < width; ++pe) mask.set(pe, random() % 2 == 0);
    CountingMachine of_one(width);
    of_one.number_ascending(chosen[0], {16});
    CountingMachine machine(width);
    for (int pe = 0; pe < width; ++pe) machine.poly_memory().word(pe, 16) = 0x5555555544444444u;
    int sum = 0;
    const int count = machine.number_ascending(chosen, 3, {20});
    for (int pe = 0; pe < width; ++pe) {
      ASSERT_EQ(machine.poly_memory().word(pe, 16), std::uint64_t(sum) << 32 | 0x44444444u) << "PE " << pe;
      for (const LaneMask& mask : chosen) sum += int{mask[pe]};
    }
    EXPECT_EQ(count, sum);
    EXPECT_EQ(machine.last_kernel, "number_ascending");
    cn::IssueCounts expected = of_one.issued;
    expected[InstructionClass::int16_alu] += 2;
    EXPECT_TRUE(machine.issued == expected);
  }
}

}  // namespace machine_test
