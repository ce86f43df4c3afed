// Built with CN_OBSERVED_SRAM, so that the kernels here report what they touch.
#include "model/hazards/hazard_checker.hpp"

#include <vector>

#include "firmware/cn/language/kernel.hpp"
#include "firmware/cn/language/poly4.hpp"
#include "testbench/machine/native_machine.hpp"
#include "tests/support/hazards.hpp"

namespace hazard_checker_test {

using cn::Access;
using cn::LaneMask;
using cn::MonoPlaces;
using cn::PolyField;
using cn::PolySpan;
using test_support::expect_one_line;
using test_support::expect_parts;
using test_support::fault_of;

struct FieldArguments {
  PolyField<std::int32_t> field;
  int first_pe = 0;  ///< those before it are disabled within the kernel
};

void read_field(const FieldArguments& arguments) {
  cn::poly_if(cn::pe_num() >= arguments.first_pe, [&] { arguments.field.read(); });
}
void write_field(const FieldArguments& arguments) {
  cn::poly_if(cn::pe_num() >= arguments.first_pe, [&] { arguments.field.write(cn::poly<std::int32_t>(1)); });
}

constexpr cn::Kernel<FieldArguments> kReads{"reader", &cn::run_strips<FieldArguments, read_field>};
constexpr cn::Kernel<FieldArguments> kWrites{"writer", &cn::run_strips<FieldArguments, write_field>};

struct ArrayArguments {
  cn::PolyArray<double> array;
};

void load_array(const ArrayArguments& arguments) {
  arguments.array.load(cn::four_from(0));
}
void swazzle_array(const ArrayArguments& arguments) {
  arguments.array.swazzle(cn::four_from(0), 1);
}
void store_array(const ArrayArguments& arguments) {
  arguments.array.store(cn::four_from(0), {1.0, 1.0, 1.0, 1.0});
}

constexpr cn::Kernel<ArrayArguments> kLoadsArray{"loader", &cn::run_strips<ArrayArguments, load_array>};
constexpr cn::Kernel<ArrayArguments> kSwazzlesArray{"swazzler",
                                                    &cn::run_strips<ArrayArguments, swazzle_array>};
constexpr cn::Kernel<ArrayArguments> kStoresArray{"storer", &cn::run_strips<ArrayArguments, store_array>};

struct StreamArguments {
  cn::PolyArray<double> own;
  cn::PolyArray<double> fed;
};

/// The last eight PEs feed the others.
void take_one_step(const StreamArguments& arguments) {
  const cn::VectorStream<double> stream(arguments.own, 0, arguments.fed, 0, 8);
  stream.after(0);
  stream.after(1);
}

constexpr cn::Kernel<StreamArguments> kTakesOneStep{"stream",
                                                    &cn::run_strips<StreamArguments, take_one_step>};

LaneMask only(int pe) {
  LaneMask pes;
  pes.set(pe, true);
  return pes;
}

class HazardChecker : public testing::Test {
 protected:
  static constexpr int kPes = 16;
  static constexpr std::uint64_t kFar = 8192;  ///< mono memory that no other transfer of a test uses

  HazardChecker() { machine.set_access_observer(&checker); }

  void load(PolySpan to, std::uint64_t from, cn::Semaphore done,
            const LaneMask& pes = LaneMask::first(kPes)) {
    machine.async_copy_m2p(done, to, MonoPlaces::array(from, 64), pes);
  }
  void save(PolySpan from, std::uint64_t to, cn::Semaphore done,
            const LaneMask& pes = LaneMask::first(kPes)) {
    machine.async_copy_p2m(done, MonoPlaces::array(to, 64), from, pes);
  }
  void run(const cn::Kernel<FieldArguments>& kernel, int offset_bytes, int first_pe = 0) {
    machine.run(kernel, FieldArguments{{offset_bytes}, first_pe}, LaneMask::first(kPes));
  }
  void read(int offset_bytes) { run(kReads, offset_bytes); }
  void write(int offset_bytes) { run(kWrites, offset_bytes); }
  /// The hazard's message; empty when `touch` is allowed.
  template <class Touch>
  std::string hazard(Touch&& touch) {
    return fault_of(touch);
  }

  testbench::NativeMachine machine{kPes, 1024, 65536};
  PolySpan a = machine.poly_memory().allocate("buffer a", 32);
  PolySpan b = machine.poly_memory().allocate("buffer b", 32);
  PolyField<cn::MonoAddress> places{machine.poly_memory().allocate("places", 8).offset_bytes};
  cn::Semaphore s = machine.allocate_semaphore("s");
  cn::Semaphore t = machine.allocate_semaphore("t");
  model::Cycles cycle = 1000;
  model::HazardChecker checker{machine, [this] { return cycle; }};
};

TEST_F(HazardChecker, KernelsThatLeaveTheSramAreNamed) {
  const auto read = [&](int at) { machine.run(kReads, FieldArguments{{at}, 0}, only(0)); };
  EXPECT_EQ(hazard([&] { read(1020); }), "");
  EXPECT_EQ(hazard([&] { read(1024); }),  // another PE's
            "hazard at cycle 1000: kernel 'reader' reads poly bytes 1024..1027 of PE 0, whose SRAM has 1024");
}

TEST_F(HazardChecker, NamesKernelBufferRequestAndCycle) {
  load(b, kFar, t);
  cycle = 1234;
  load(a, 0, s, LaneMask::first(10));
  cycle = 1500;
  const std::string message = hazard([&] { read(a.offset_bytes + 12); });
  EXPECT_EQ(
      message,
      "hazard at cycle 1500: kernel 'reader' reads 'buffer a' (poly bytes 12..15) of PE 0, which request 1 "
      "(load, 320 bytes, started at cycle 1234, semaphore 's') still writes");
}

TEST_F(HazardChecker, ALoadsBufferIsItsOwnUntilTheWait) {
  load(a, 0, s);
  read(b.offset_bytes), write(b.offset_bytes);  // not concerned
  EXPECT_EQ(checker.outstanding(), 1u);
  machine.sem_wait(s);
  EXPECT_EQ(checker.outstanding(), 0u);
  for (int offset = 0; offset < a.size_bytes; offset += 4) read(offset), write(offset);
  load(a, 0, s);
  expect_parts(hazard([&] { write(a.offset_bytes + 28); }), {"'writer' writes 'buffer a'", "still writes"});
}

TEST_F(HazardChecker, ASavesBufferMayBeReadButNotWritten) {
  save(a, 0, s);
  read(a.offset_bytes);
  const std::string message = hazard([&] { write(a.offset_bytes); });
  expect_parts(message, {"'writer' writes 'buffer a'", "request 0 (save, 512 bytes", "still reads"});
  expect_one_line(message);
}

TEST_F(HazardChecker, TheBufferEndsWhereTheTransferEnds) {
  const int offset = b.offset_bytes;
  load({offset, 16}, 0, s);
  read(offset - 4), read(offset + 16);
  for (int byte = 0; byte < 16; byte += 4) {
    model::HazardChecker fresh(machine);
    machine.set_access_observer(&fresh);
    load({offset, 16}, 0, s);
    EXPECT_NE(hazard([&] { read(offset + byte); }), "") << byte;
  }
}

TEST_F(HazardChecker, DisabledPesTouchNothing) {
  load(a, 0, s, LaneMask::first(5));
  machine.run(kReads, FieldArguments{{a.offset_bytes}, 0}, [] {
    LaneMask others = LaneMask::first(kPes);
    for (int pe = 0; pe < 5; ++pe) others.set(pe, false);
    return others;
  }());
  run(kReads, a.offset_bytes, 5);  // disabled within the kernel
  run(kWrites, a.offset_bytes, 5);
  expect_parts(hazard([&] { run(kReads, a.offset_bytes, 4); }), {"of PE 4"});
}

TEST_F(HazardChecker, VectorAccessesAreSeen) {
  const ArrayArguments array{cn::PolyArray<double>(a)};
  save({a.offset_bytes + 24, 8}, 0, s, only(9));
  machine.run(kLoadsArray, array, LaneMask::first(kPes));
  machine.run(kStoresArray, array, only(8));
  expect_parts(hazard([&] { machine.run(kStoresArray, array, only(9)); }),
               {"'storer' writes 'buffer a'", "of PE 9", "still reads"});
}

TEST_F(HazardChecker, WhatTravelsIsReadWhereItComesFrom) {
  const ArrayArguments array{cn::PolyArray<double>(a)};
  load({a.offset_bytes + 24, 8}, 0, s, only(7));
  machine.run(kLoadsArray, array, only(8));
  machine.run(kSwazzlesArray, array, only(7));  // gets PE 6's
  expect_parts(hazard([&] { machine.run(kSwazzlesArray, array, only(8)); }),
               {"'swazzler' reads 'buffer a'", "of PE 7", "still writes"});
}

TEST_F(HazardChecker, AStreamIsReadFromNeighboursAndFeeders) {
  const StreamArguments stream{cn::PolyArray<double>(a), cn::PolyArray<double>(b)};
  load(b, 0, s, only(8));
  machine.run(kTakesOneStep, stream, only(6));
  expect_parts(hazard([&] { machine.run(kTakesOneStep, stream, only(7)); }),
               {"'stream' reads 'buffer b'", "of PE 8"});
  machine.sem_wait(s);
  model::HazardChecker fresh(machine);
  machine.set_access_observer(&fresh);
  load(a, 0, s, only(6));
  machine.run(kTakesOneStep, stream, only(7));
  expect_parts(hazard([&] { machine.run(kTakesOneStep, stream, only(5)); }),
               {"'stream' reads 'buffer a'", "of PE 6"});
}

TEST_F(HazardChecker, WaitsTellInTheOrderOfOneDirection) {
  load(a, 0, s);
  load(b, kFar, s);
  machine.sem_wait(s);
  read(a.offset_bytes);
  expect_parts(hazard([&] { read(b.offset_bytes); }), {"'buffer b'", "request 1"});
}

TEST_F(HazardChecker, OneWaitTellsNothingOfTwoDirections) {
  load(a, 0, s);
  save(b, kFar, s);
  machine.sem_wait(s);
  EXPECT_EQ(checker.outstanding(), 2u);
  machine.sem_wait(s);
  EXPECT_EQ(checker.outstanding(), 0u);
}

TEST_F(HazardChecker, ATransferWithoutDataSignalsAtOnceAndTellsNothing) {
  load(a, 0, s);
  load(b, kFar, s, LaneMask{});
  machine.sem_wait(s);
  EXPECT_EQ(checker.outstanding(), 1u) << "this signal may have been the empty one's";
  read(b.offset_bytes);
  machine.sem_wait(s);
  EXPECT_EQ(checker.outstanding(), 0u);
}

TEST_F(HazardChecker, NorDoesASignalOfTheFirmware) {
  load(a, 0, s);
  machine.sem_signal(s);
  machine.sem_wait(s);
  expect_parts(hazard([&] { read(a.offset_bytes); }), {"'buffer a'"});
}

TEST_F(HazardChecker, AWaitForAnotherSemaphoreTellsNothing) {
  load(a, 0, s);
  load(b, kFar, t);
  machine.sem_wait(t);
  read(b.offset_bytes);
  expect_parts(hazard([&] { read(a.offset_bytes); }), {"semaphore 's'"});
}

TEST_F(HazardChecker, TransfersMustNotOverlapInPolyMemory) {
  load(a, 0, s);
  const std::string message = hazard([&] { save({a.offset_bytes + 24, 16}, kFar, t); });
  expect_parts(message, {"request 1 (save, 256 bytes, semaphore 't') reads 'buffer a' (poly bytes 24..39)",
                         "which request 0 (load", "still writes"});
  expect_one_line(message);
}

TEST_F(HazardChecker, TwoSavesMayReadTheSameBuffer) {
  save(a, 0, s);
  save(a, kFar, t);
  machine.sem_wait(s);
  expect_parts(hazard([&] { write(a.offset_bytes); }), {"which request 1"});
}

TEST_F(HazardChecker, LoadsOfDifferentPesShareABuffer) {
  LaneMask odd;
  LaneMask even;
  for (int pe = 0; pe < kPes; ++pe) (pe % 2 ? odd : even).set(pe, true);
  load(a, 0, s, odd);
  load(a, 0, t, even);
  machine.sem_wait(s);
  expect_parts(hazard([&] { read(a.offset_bytes); }), {"of PE 0"});
}

TEST_F(HazardChecker, SavesMustNotOverlapInMonoMemory) {
  checker.name_mono("ray bin", {512, 4096});
  save(a, 0, s);
  save(b, 32, t);  // between the other's pieces
  machine.sem_wait(t);
  const std::string message = hazard([&] { save(b, 536, t); });
  expect_parts(message, {"request 2 (save, 512 bytes, semaphore 't') writes 'ray bin' (mono bytes 536..543)",
                         "which request 0", "still writes"});
}

TEST_F(HazardChecker, LoadsMustNotReadWhatIsBeingSaved) {
  save(a, 0, s);
  expect_parts(hazard([&] { load(b, 960, t); }),
               {"request 1 (load", "reads mono bytes 960..991", "which request 0 (save", "still writes"});
}

TEST_F(HazardChecker, SavesMustNotWriteWhatIsBeingLoaded) {
  load(a, 0, s);
  load(b, 0, t);  // two loads may
  expect_parts(hazard([&] {
                 save({places.offset_bytes, 8}, 24, t);
               }),
               {"writes mono bytes 24..31", "which request 0 (load", "still reads"});
}

TEST_F(HazardChecker, ScattersAreComparedPieceByPiece) {
  std::vector<std::uint64_t> scattered;
  for (int pe = 0; pe < kPes; ++pe) scattered.push_back(std::uint64_t(64 * ((pe * 7) % kPes)));
  machine.async_copy_p2m(s, MonoPlaces::each(scattered.data()), a, LaneMask::first(kPes));
  save(b, 32, t);
  machine.sem_wait(t);
  const auto scatter_to = [&](std::uint64_t place, int pe) {
    std::vector<std::uint64_t> to(kPes, kFar);
    to[std::size_t(pe)] = place;
    LaneMask one;
    one.set(pe, true);
    machine.async_copy_p2m(t, MonoPlaces::each(to.data()), b, one);
    machine.sem_wait(t);
  };
  scatter_to(32, 3);
  scatter_to(1024, 3);
  expect_parts(hazard([&] { scatter_to(24, 3); }), {"mono bytes 24..31"});
}

TEST_F(HazardChecker, AddressesInPolyMemoryBelongToTheTransfer) {
  machine.async_copy_m2p(s, a, machine.places_in(places), LaneMask::first(kPes));
  read(places.offset_bytes);
  expect_parts(hazard([&] { write(places.offset_bytes + 4); }),
               {"writes 'places'", "which request 0 (load", "still takes addresses from"});
}

TEST_F(HazardChecker, AddressesThatAreStillBeingLoadedAreNoAddresses) {
  load({places.offset_bytes, 8}, 0, s, LaneMask::first(3));
  LaneMask others;
  others.set(5, true);
  machine.async_copy_m2p(t, a, machine.places_in(places), others);
  others.set(2, true);
  expect_parts(hazard([&] { machine.async_copy_p2m(t, machine.places_in(places, kFar), b, others); }),
               {"request 2 (save", "takes addresses from 'places'", "of PE 2", "which request 0"});
}

TEST_F(HazardChecker, SwazzlesAndNumbersTouchPolyMemoryToo) {
  save({places.offset_bytes, 8}, 0, s, [] {
    LaneMask last;
    last.set(kPes - 1, true);
    return last;
  }());
  machine.swazzle_down({places.offset_bytes});  // the last PE keeps what it has
  LaneMask chosen = LaneMask::first(kPes - 1);
  machine.number_ascending(chosen, {places.offset_bytes});
  chosen.set(kPes - 1, true);
  expect_parts(hazard([&] { machine.number_ascending(chosen, {places.offset_bytes + 4}); }),
               {"kernel 'number_ascending' writes 'places'", "of PE 15"});
}

TEST_F(HazardChecker, ASwazzleWritesWhatASaveReads) {
  save({places.offset_bytes, 8}, 0, s);
  expect_parts(hazard([&] { machine.swazzle_up({places.offset_bytes}); }),
               {"kernel 'swazzle_up' writes 'places'", "of PE 1,"});
}

TEST_F(HazardChecker, TheControlUnitMustWaitToo) {
  load(a, 0, s);
  machine.read_mono(cn::MonoPointer<double>{0}, 4);
  expect_parts(hazard([&] { machine.write_mono(cn::MonoPointer<double>{64}, 1.0); }),
               {"the control unit writes mono bytes 64..71", "which request 0", "still reads"});
}

TEST_F(HazardChecker, TheControlUnitReadsNothingThatIsBeingSaved) {
  save(a, 0, s);
  machine.read_mono(cn::MonoPointer<double>{32}, 4);  // between two PEs' pieces
  expect_parts(hazard([&] { machine.read_mono(cn::MonoPointer<double>{32}, 5); }),
               {"the control unit reads mono bytes 64..71", "still writes"});
}

TEST_F(HazardChecker, TheHostsReadStopsTheFirmwareAtItsNextStep) {
  save(a, 0, s);
  checker.host_touches_mono(Access::read, {kFar, 64});
  machine.sem_wait(s);
  checker.host_touches_mono(Access::read, {0, 64});
  read(b.offset_bytes);
  save(a, 0, s);
  checker.host_touches_mono(Access::read, {0, 64});
  expect_parts(hazard([&] { read(b.offset_bytes); }), {"the host reads mono bytes 0..31", "which request 1"});
}

TEST_F(HazardChecker, UntimedWorkSeesAllAndUsesUpNothing) {
  load(a, 0, s);
  {
    const cn::Untimed untimed(machine);
    read(a.offset_bytes), write(a.offset_bytes);
    load(b, 0, t), save(b, 0, t);
    machine.sem_wait(t), machine.sem_wait(t);
    read(b.offset_bytes);
  }
  EXPECT_EQ(checker.outstanding(), 1u);
  expect_parts(hazard([&] { read(a.offset_bytes); }), {"request 0"});
}

TEST_F(HazardChecker, ASaveMayOverwriteWhatUntimedWorkHasSeen) {
  save(a, 0, s);
  { const cn::Untimed untimed(machine); }
  save(b, 0, t);
  expect_parts(hazard([&] { save(b, 8, t); }), {"which request 1", "still writes"});
}

TEST_F(HazardChecker, UntimedWorkIsNoWait) {
  save(a, 0, s);
  { const cn::Untimed untimed(machine); }
  expect_parts(hazard([&] { write(a.offset_bytes); }), {"which request 0", "still reads"});
}

TEST_F(HazardChecker, WhatUntimedWorkHasSeenIsNotThereForALoad) {
  save(a, 0, s);
  { const cn::Untimed untimed(machine); }
  expect_parts(hazard([&] { load(b, 0, t); }), {"which request 0", "still writes"});
}

TEST_F(HazardChecker, TheFirmwareMustNotEndBeforeItsTransfers) {
  save(a, 0, s);
  save(b, kFar, s);
  machine.sem_wait(s);
  expect_parts(hazard([&] { checker.firmware_ends(); }), {"the firmware ended", "request 1 (save", "'s'"});
}

TEST_F(HazardChecker, NoHazardAtTheEndOfSoundFirmware) {
  save(a, 0, s);
  machine.sem_wait(s);
  checker.firmware_ends();
}

TEST_F(HazardChecker, AKernelThatReportsNothingIsRefused) {
  constexpr cn::Kernel<FieldArguments> kSilent{
      "silent", [](const FieldArguments&, cn::PolyMemory& memory, const LaneMask&, cn::IssueTree&) {
        memory.observer()->kernel_is_silent();  // as run_strips does where it is not built to report
      }};
  expect_parts(hazard([&] { run(kSilent, 0); }), {"'silent'", "not built to report"});
}

TEST_F(HazardChecker, WithoutAClockThereIsNoCycle) {
  model::HazardChecker timeless(machine);
  machine.set_access_observer(&timeless);
  load(a, 0, s);
  EXPECT_EQ(
      hazard([&] { read(a.offset_bytes); }),
      "hazard: kernel 'reader' reads 'buffer a' (poly bytes 0..3) of PE 0, which request 0 (load, 512 bytes, "
      "semaphore 's') still writes");
}

TEST_F(HazardChecker, TheKernelBeforeIsNamedWhenATransferIsToBlame) {
  load(a, 0, s);
  read(b.offset_bytes);
  expect_parts(hazard([&] { load(a, 0, t); }), {"hazard at cycle 1000, after kernel 'reader': request 1"});
}

}  // namespace hazard_checker_test
