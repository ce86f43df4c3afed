// The on-chip SRAM on the address map of the network: exact delays, loosely and approximately timed.
#include "model/memory/on_chip_sram.hpp"

#include <numeric>

#include "model/csx600.hpp"
#include "tests/support/pio_bench.hpp"

namespace on_chip_sram_test {

using model::Initiator;
using sc_core::SC_NS;
using sc_core::sc_time;
using test_support::kAll;
using test_support::kPes;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;

constexpr std::uint64_t kSram = std::uint64_t{1} << 40;

/// The test chip with an SRAM of 8 bytes a cycle and 5 cycles of latency, one hop (2 cycles) away.
model::ChipConfig chip_with_sram() {
  auto config = test_support::test_chip();
  config.on_chip_sram = {4096, kSram, 8, 5, 1};
  return config;
}

TEST(OnChipSramTiming, LatencyIsPipelinedAndThePortIsNot) {
  model::OnChipSramTiming sram({4096, 0, 16, 4, 2});
  EXPECT_EQ(sram.access(64, false, 100).start, 104u);
  EXPECT_EQ(sram.access(64, true, 100).finish, 112u);   // right behind: no turn-round
  EXPECT_EQ(sram.access(8, false, 108).finish, 113u);   // its latency passed behind the port
  EXPECT_EQ(sram.access(24, false, 200).finish, 206u);  // two cycles for a word and a half
  EXPECT_EQ(sram.statistics().accesses, 4u);
  EXPECT_EQ(sram.statistics().bytes_read, 96u);
  EXPECT_EQ(sram.statistics().bytes_written, 64u);
  EXPECT_EQ(sram.statistics().busy_cycles, 4u + 4 + 1 + 2);
}

class OnChipSram : public test_support::PioBench {
 protected:
  void build_with_sram(model::TimingStyle style = model::TimingStyle::loosely_timed) {
    build(chip, style);
    on_chip_sram = std::make_unique<model::OnChipSram>("on_chip_sram", chip, clock, event_queue.get());
    network->bind(on_chip_sram->socket, "on_chip_sram", {kSram, 4096},
                  {chip.on_chip_sram.bytes_per_cycle, chip.on_chip_sram.hops});
    engine->follow(network->map());
    std::iota(buffer.begin(), buffer.end(), static_cast<unsigned char>(0));
  }
  void build_and_elaborate() {
    build_with_sram();
    elaborate();
  }
  sc_time send(test_support::TestInitiator& from, tlm::tlm_command command, std::uint64_t address,
               std::size_t bytes, double at) {
    return from.send(command, address, buffer.data(), bytes, sc_time(at, SC_NS));
  }
  std::uint64_t& sram_word(std::uint64_t address) {
    return *reinterpret_cast<std::uint64_t*>(on_chip_sram->memory().data() + address);
  }
  /// The cycle at which a gather of 8 x 32 bytes is over whose PEs' places are `first` + PE x `stride`.
  model::Cycles cycles_of_read(std::uint64_t first, std::uint64_t stride) {
    run([&] { engine->enqueue(read(cn::MonoPlaces::array(first, stride), 32, kAll), 0); });
    return signal();
  }

  model::ChipConfig chip = chip_with_sram();
  std::unique_ptr<model::OnChipSram> on_chip_sram;
  std::array<unsigned char, 512> buffer{};
};

TEST_F(OnChipSram, ReadPaysBothWays) {
  build_and_elaborate();
  // Request 100 -> 102; port of the SRAM 107..115; link back 107..115; 2 cycles: 117.
  EXPECT_EQ(send(control, TLM_READ_COMMAND, kSram, 64, 100), sc_time(117, SC_NS));
  EXPECT_EQ(control.transaction.get_address(), kSram) << "the initiator's own address comes back";
}

TEST_F(OnChipSram, WriteIsPosted) {
  build_and_elaborate();
  // First bytes there at 102, at the port 107..115; the link ends before.
  EXPECT_EQ(send(control, TLM_WRITE_COMMAND, kSram + 4096 - 64, 64, 100), sc_time(115, SC_NS));
  EXPECT_EQ(on_chip_sram->memory()[4096 - 64 + 9], 9);
}

TEST_F(OnChipSram, IsReadableWhileTheDdrIsBusy) {
  build_and_elaborate();
  // 512 bytes keep the DDR and its port busy until 1036 + 32 and the host's link until 1106.
  EXPECT_EQ(send(host, TLM_READ_COMMAND, 0, 512, 1000), sc_time(1106, SC_NS));
  EXPECT_EQ(send(control, TLM_READ_COMMAND, kSram, 64, 1000), sc_time(1017, SC_NS));
  EXPECT_EQ(network->statistics(Initiator::control).waiting_cycles, 0u);
  EXPECT_EQ(send(control, TLM_READ_COMMAND, 0, 64, 1020), sc_time(1020 + 6 + 20 + 22 + 8 + 6, SC_NS))
      << "from 1046 the DDR still sends to the host, until 1068";
}

TEST_F(OnChipSram, TransfersOutsideEveryRangeAreErrorsAndTakeNoTime) {
  build_and_elaborate();
  for (const std::uint64_t address : {std::uint64_t{1} << 20, kSram - 8, kSram + 4096 - 8, kSram + 4096})
    for (const tlm::tlm_command command : {TLM_READ_COMMAND, TLM_WRITE_COMMAND}) {
      EXPECT_EQ(send(control, command, address, 16, 100), sc_time(100, SC_NS)) << address;
      EXPECT_EQ(control.transaction.get_response_status(), tlm::TLM_ADDRESS_ERROR_RESPONSE) << address;
    }
  EXPECT_EQ(control.debug(TLM_READ_COMMAND, kSram - 1, buffer.data(), 1), 0u);
  EXPECT_FALSE(control.ask_for_pointer(kSram + 4096));
  EXPECT_EQ(network->statistics(Initiator::control).packets, 0u);
}

TEST_F(OnChipSram, PointersAndDebugAccessesReachItUnderItsAddresses) {
  build_and_elaborate();
  ASSERT_TRUE(control.ask_for_pointer(kSram + 100));
  EXPECT_EQ(control.dmi.get_dmi_ptr(), on_chip_sram->memory().data());
  EXPECT_EQ(control.dmi.get_start_address(), kSram);
  EXPECT_EQ(control.dmi.get_end_address(), kSram + 4095);
  EXPECT_EQ(host.debug(TLM_WRITE_COMMAND, kSram + 4094, buffer.data(), 4), 2u) << "only up to its end";
  on_chip_sram->socket->invalidate_direct_mem_ptr(0, 4095);
  EXPECT_EQ(control.invalidations, 1);
}

TEST_F(OnChipSram, ArrayCostsOneAccess) {
  build_with_sram();
  // Engine 100 setup, request -> 102; 256 bytes at 8 a cycle from 107 to 139; 2 back: 141. The PE side needs
  // longer: 100 + 8 x (10 + 4) = 212.
  EXPECT_EQ(cycles_of_read(kSram, 32), 212u);
  EXPECT_EQ(on_chip_sram->statistics().accesses, 1u);
  EXPECT_EQ(on_chip_sram->statistics().busy_cycles, 32u);
  EXPECT_EQ(ddr->statistics().bytes_read, 0u);
}

TEST_F(OnChipSram, GatherMovesItsData) {
  build_with_sram();
  for (int word = 0; word < 512; ++word) sram_word(std::uint64_t(word) * 8) = 0x500 + std::uint64_t(word);
  cycles_of_read(kSram + 8, 256);
  for (int pe = 0; pe < kPes; ++pe)
    EXPECT_EQ(poly_word(pe, 24), 0x500u + 1 + 32 * unsigned(pe) + 3) << "PE " << pe;
  EXPECT_EQ(on_chip_sram->statistics().accesses, 8u);
}

/// Even PEs read the SRAM, odd ones the DDR.
class OneRequestForBoth : public OnChipSram, public ::testing::WithParamInterface<model::TimingStyle> {};

TEST_P(OneRequestForBoth, GetsBothMemoriesData) {
  build_with_sram(GetParam());
  std::array<cn::MonoAddress, kPes> places{};
  for (int pe = 0; pe < kPes; ++pe) {
    const auto offset = std::uint64_t(pe) * 128;
    places[std::size_t(pe)] = offset + (pe % 2 == 0 ? kSram : 0);
    sram_word(offset) = 0xa0 + std::uint64_t(pe);
    mono_word(offset) = 0xb0 + std::uint64_t(pe);
  }
  run([&] { engine->enqueue(read(cn::MonoPlaces::each(places.data()), 32, kAll), 0); });
  signal();
  for (int pe = 0; pe < kPes; ++pe)
    EXPECT_EQ(poly_word(pe, 0), (pe % 2 == 0 ? 0xa0u : 0xb0u) + unsigned(pe)) << "PE " << pe;
  EXPECT_EQ(on_chip_sram->statistics().bytes_read, 128u);
  EXPECT_EQ(ddr->statistics().bytes_read, 128u);
}

INSTANTIATE_TEST_SUITE_P(Styles, OneRequestForBoth,
                         ::testing::Values(model::TimingStyle::loosely_timed,
                                           model::TimingStyle::approximately_timed),
                         [](const auto& style) {
                           return style.param == model::TimingStyle::loosely_timed ? "LooselyTimed"
                                                                                   : "ApproximatelyTimed";
                         });

TEST_F(OnChipSram, AFourthInitiatorHasALinkOfItsOwn) {
  test_support::TestInitiator other("other");
  build_with_sram();
  const Initiator number = network->bind_initiator(other.socket);
  elaborate();
  EXPECT_EQ(int(number), 3);
  EXPECT_EQ(send(control, TLM_READ_COMMAND, kSram, 64, 100), sc_time(117, SC_NS));
  // Its request passes at 103; the port of the SRAM is free at 115: 115..123; 2 cycles: 125.
  EXPECT_EQ(send(other, TLM_READ_COMMAND, kSram + 64, 64, 100), sc_time(125, SC_NS));
  EXPECT_EQ(network->statistics(number).packets, 2u);
  EXPECT_EQ(network->statistics(number).waiting_cycles, 1u) << "behind the request of the control unit";
  EXPECT_EQ(network->statistics(Initiator::control).packets, 2u);
  on_chip_sram->socket->invalidate_direct_mem_ptr(0, 7);
  EXPECT_EQ(other.invalidations, 1);
}

TEST_F(OnChipSram, AnotherMemoryJoinsTheMapAndAnOverlappingOneDoesNot) {
  test_support::MinimalMemory joined("joined", 256, sc_time(3, SC_NS));
  build_with_sram();
  try {
    network->bind(joined.socket, "refused", {kSram + 4088, 256}, {8, 1});
    FAIL() << "accepted";
  } catch (const model::AddressMapError& error) {
    EXPECT_STREQ(error.what(),
                 "address map: refused: found 256 bytes at 0x10000000ff8; allowed: addresses outside "
                 "on_chip_sram (0x10000000000 to 0x10000000fff)");
  }
  network->bind(joined.socket, "joined", {kSram + 8192, 256}, {16, 4});
  elaborate();
  // Request there at 108, the answer at 111; port 108..112, link 108..116, 8 cycles back.
  EXPECT_EQ(send(control, TLM_READ_COMMAND, kSram + 8192 + 192, 64, 100), sc_time(124, SC_NS));
  EXPECT_EQ(joined.reads, 1);
  engine->enqueue(write(cn::MonoPlaces::array(kSram + 8192, 32), 32, kAll), 1000);
  signal();
  EXPECT_EQ(joined.writes, 1) << "the engine follows the map";
}

TEST_F(OnChipSram, ApproximatelyTimedOnePeTakesExactly) {
  build_with_sram(model::TimingStyle::approximately_timed);
  sram_word(64) = 77;
  // Setup 100, address 110; request there at 112; port of the SRAM 117..121; link back 117..121, there at
  // 123; data into the PE until 127.
  run([&] { engine->enqueue(read(cn::MonoPlaces::array(kSram + 64, 0), 32, cn::LaneMask::first(1)), 0); });
  EXPECT_EQ(signal(), 127u);
  EXPECT_EQ(poly_word(0, 0), 77u);
}

TEST_F(OnChipSram, ApproximatelyTimedPacketsFollowEachOther) {
  chip.pio.setup_cycles = 0;
  chip.pio.per_pe_cycles = 0;
  build_with_sram(model::TimingStyle::approximately_timed);
  // Four packets of two PEs each leave at 0, 1, 2, 3 and are at the port from 7 on, without a gap: 32 cycles
  // of 8 bytes. The last packet is at the engine at 7 + 32 + 2 = 41, and its two PEs take 4 cycles each.
  EXPECT_EQ(cycles_of_read(kSram, 32), 49u);
  EXPECT_EQ(on_chip_sram->statistics().accesses, 4u);
}

TEST_F(OnChipSram, PiecesOutsideMemoryAreNamed) {
  build_and_elaborate();
  try {
    engine->enqueue(read(cn::MonoPlaces::array(kSram + 4096 - 7 * 32, 32), 32, kAll, 3), 0);
    FAIL() << "accepted";
  } catch (const cn::MachineFault& fault) {
    EXPECT_STREQ(fault.what(),
                 "PIO request 0 (mono to poly, semaphore 3): PE 7 addresses 32 bytes at 0x10000001000, mono "
                 "memory is 0x0 to 0xfffff and 0x10000000000 to 0x10000000fff");
  }
}

TEST_F(OnChipSram, ARunThatCrossesIntoTheNextMemoryIsNamed) {
  chip.on_chip_sram.first_address = chip.ddr.size_bytes;
  build(chip);
  try {
    engine->enqueue(read(cn::MonoPlaces::array(chip.ddr.size_bytes - 64, 32), 32, kAll), 0);
    FAIL() << "accepted";
  } catch (const cn::MachineFault& fault) {
    EXPECT_STREQ(fault.what(),
                 "PIO request 0 (mono to poly, semaphore 0): 256 bytes without a gap at 0xfffc0 lie in two "
                 "memories, allowed is one of 0x0 to 0xfffff and 0x100000 to 0x100fff");
  }
}

}  // namespace on_chip_sram_test
