#include "model/memory/mono_ddr.hpp"

#include <numeric>

#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"
#include "tests/support/tlm_testers.hpp"

namespace mono_ddr_test {

using sc_core::SC_NS;
using sc_core::sc_time;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;

constexpr std::uint64_t kSize = 1 << 20;

class MonoDdr : public test_support::SystemCFixture {
 protected:
  MonoDdr() {
    initiator.socket.bind(ddr.socket);
    elaborate();
    std::iota(pattern.begin(), pattern.end(), static_cast<unsigned char>(1));
  }

  void expect_response(tlm::tlm_response_status expected) {
    EXPECT_EQ(initiator.transaction.get_response_status(), expected)
        << initiator.transaction.get_response_string();
  }

  sc_time send_addresses(model::PeAddresses& addresses, const cn::Transfer& transfer, int pes,
                         sc_time delay) {
    addresses.pieces.describe(transfer, pes, {model::Divisor(64), false});
    initiator.transaction.set_extension(&addresses);
    const sc_time end = initiator.send(tlm::TLM_IGNORE_COMMAND, 0, pattern.data(), 8, delay);
    initiator.transaction.clear_extension(&addresses);
    return end;
  }

  model::ChipConfig config = test_support::test_chip();
  model::ClockDomain clock{config.chip.clock_hz};
  model::MonoDdr ddr{"ddr", config, clock};
  test_support::TestInitiator initiator{"initiator"};
  std::array<unsigned char, 256> pattern{};
  std::array<unsigned char, 256> buffer{};
};

TEST_F(MonoDdr, WriteThenReadWithTheirDelays) {
  EXPECT_EQ(initiator.send(TLM_WRITE_COMMAND, 4096, pattern.data(), 64, sc_time(100, SC_NS)),
            sc_time(134, SC_NS));
  expect_response(tlm::TLM_OK_RESPONSE);
  // Hit: 1000 + 20 + 4; the turn-round is long over.
  EXPECT_EQ(initiator.send(TLM_READ_COMMAND, 4096, buffer.data(), 64, sc_time(1000, SC_NS)),
            sc_time(1024, SC_NS));
  expect_response(tlm::TLM_OK_RESPONSE);
  EXPECT_TRUE(std::equal(buffer.begin(), buffer.begin() + 64, pattern.begin()));
  EXPECT_EQ(ddr.statistics().bytes_written, 64u);
  EXPECT_EQ(ddr.statistics().bytes_read, 64u);
}

TEST_F(MonoDdr, DelayCountsFromSimulationTime) {
  sc_core::sc_start(sc_time(500, SC_NS));
  EXPECT_EQ(initiator.send(TLM_READ_COMMAND, 0, buffer.data(), 16, sc_time(7, SC_NS)), sc_time(38, SC_NS));
  EXPECT_EQ(initiator.send(TLM_READ_COMMAND, 0, buffer.data(), 16, sc_time(100, SC_NS)), sc_time(121, SC_NS));
}

TEST_F(MonoDdr, AccessMayCrossPages) {
  initiator.send(TLM_WRITE_COMMAND, 448, pattern.data(), 128, sc_core::SC_ZERO_TIME);
  initiator.send(TLM_READ_COMMAND, 508, buffer.data(), 8, sc_core::SC_ZERO_TIME);
  EXPECT_TRUE(std::equal(buffer.begin(), buffer.begin() + 8, pattern.begin() + 60));
  EXPECT_EQ(ddr.statistics().page_misses, 2u);
}

TEST_F(MonoDdr, LastBytesAreWithinAndNothingBehindThem) {
  initiator.send(TLM_WRITE_COMMAND, kSize - 8, pattern.data(), 8, sc_core::SC_ZERO_TIME);
  expect_response(tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(initiator.send(TLM_WRITE_COMMAND, kSize - 7, pattern.data(), 8, sc_time(5, SC_NS)),
            sc_time(5, SC_NS));
  expect_response(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  initiator.send(TLM_READ_COMMAND, kSize, buffer.data(), 1, sc_core::SC_ZERO_TIME);
  expect_response(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  initiator.send(TLM_READ_COMMAND, ~std::uint64_t{0} - 3, buffer.data(), 8, sc_core::SC_ZERO_TIME);
  expect_response(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(ddr.statistics().bytes_written, 8u);
  EXPECT_EQ(ddr.statistics().bytes_read, 0u);
  EXPECT_EQ(ddr.memory().data()[kSize - 8], 1);
}

TEST_F(MonoDdr, ByteEnablesAreRefused) {
  std::array<unsigned char, 8> enables;
  enables.fill(0xff);
  tlm::tlm_generic_payload transaction;
  transaction.set_write();
  transaction.set_address(0);
  transaction.set_data_ptr(pattern.data());
  transaction.set_data_length(8);
  transaction.set_streaming_width(8);
  transaction.set_byte_enable_ptr(enables.data());
  transaction.set_byte_enable_length(8);
  sc_time delay = sc_core::SC_ZERO_TIME;
  initiator.socket->b_transport(transaction, delay);
  EXPECT_EQ(transaction.get_response_status(), tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  EXPECT_EQ(delay, sc_core::SC_ZERO_TIME);
  EXPECT_EQ(ddr.memory().data()[0], 0);
}

TEST_F(MonoDdr, StreamingIsRefused) {
  tlm::tlm_generic_payload transaction;
  transaction.set_write();
  transaction.set_address(0);
  transaction.set_data_ptr(pattern.data());
  transaction.set_data_length(16);
  transaction.set_streaming_width(8);
  sc_time delay = sc_core::SC_ZERO_TIME;
  initiator.socket->b_transport(transaction, delay);
  EXPECT_EQ(transaction.get_response_status(), tlm::TLM_BURST_ERROR_RESPONSE);
  EXPECT_EQ(ddr.memory().data()[0], 0);
}

TEST_F(MonoDdr, DebugTransportTakesNoTimeAndStopsAtTheEnd) {
  EXPECT_EQ(initiator.debug(TLM_WRITE_COMMAND, 100, pattern.data(), 256), 256u);
  EXPECT_EQ(initiator.debug(TLM_READ_COMMAND, 110, buffer.data(), 20), 20u);
  EXPECT_TRUE(std::equal(buffer.begin(), buffer.begin() + 20, pattern.begin() + 10));
  EXPECT_EQ(initiator.debug(TLM_READ_COMMAND, kSize - 5, buffer.data(), 20), 5u);
  EXPECT_EQ(initiator.debug(TLM_READ_COMMAND, kSize, buffer.data(), 20), 0u);
  EXPECT_EQ(initiator.debug(tlm::TLM_IGNORE_COMMAND, 0, buffer.data(), 20), 0u);
  EXPECT_EQ(ddr.statistics().page_misses, 0u);
}

TEST_F(MonoDdr, DirectPointerCoversTheWholeMemory) {
  ASSERT_TRUE(initiator.ask_for_pointer(4096));
  EXPECT_EQ(initiator.dmi.get_start_address(), 0u);
  EXPECT_EQ(initiator.dmi.get_end_address(), kSize - 1);
  EXPECT_TRUE(initiator.dmi.is_read_write_allowed());
  initiator.dmi.get_dmi_ptr()[123] = 77;
  EXPECT_EQ(initiator.debug(TLM_READ_COMMAND, 123, buffer.data(), 1), 1u);
  EXPECT_EQ(buffer[0], 77);
  EXPECT_FALSE(initiator.ask_for_pointer(kSize));
}

TEST_F(MonoDdr, TransactionsSayThatDmiIsAllowed) {
  initiator.transaction.set_dmi_allowed(false);
  initiator.send(TLM_READ_COMMAND, 0, buffer.data(), 8, sc_core::SC_ZERO_TIME);
  EXPECT_TRUE(initiator.transaction.is_dmi_allowed());
}

TEST_F(MonoDdr, ServesAnArrayOfPesAsOneAccess) {
  model::PeAddresses addresses;
  const cn::Transfer transfer{
      cn::Direction::mono_to_poly, {0, 32}, cn::MonoPlaces::array(0, 32), cn::LaneMask::first(8), {0}};
  // 256 bytes of one page: miss 30, transfer 16.
  EXPECT_EQ(send_addresses(addresses, transfer, 8, sc_time(100, SC_NS)), sc_time(146, SC_NS));
  expect_response(tlm::TLM_OK_RESPONSE);
  EXPECT_TRUE(addresses.served);
  EXPECT_EQ(addresses.first_data, sc_time(130, SC_NS));
  EXPECT_EQ(ddr.statistics().bytes_read, 256u);
}

TEST_F(MonoDdr, GatherCostsWhatOneTransactionARunDoes) {
  const cn::MonoAddress by_pe[8] = {0, 32, 8192, 2048, 4096, 512, 544, 64};
  const cn::Transfer transfer{
      cn::Direction::mono_to_poly, {0, 32}, cn::MonoPlaces::each(by_pe), cn::LaneMask::first(8), {0}};
  model::PeAddresses addresses;
  // Runs: 0+64 (bank 0 row 0, 30..34), 8192 (row 4: may change at 14, 44..46), 2048 (at 26, 56..58),
  // 4096 (at 38, 68..70), 512+64 (bank 1, ready 30, bus 70..74), 64 (bank 0 at 50, 80..82).
  EXPECT_EQ(send_addresses(addresses, transfer, 8, sc_core::SC_ZERO_TIME), sc_time(82, SC_NS));
  EXPECT_EQ(addresses.first_data, sc_time(30, SC_NS));

  // Far later, so that the state of the banks is all that could differ: put it back by another row of each
  // bank.
  const auto close_rows = [&](double at) {
    initiator.send(TLM_READ_COMMAND, 65536, buffer.data(), 8, sc_time(at, SC_NS));
    initiator.send(TLM_READ_COMMAND, 65536 + 512, buffer.data(), 8, sc_time(at, SC_NS));
  };
  close_rows(1000);
  sc_time by_runs = sc_core::SC_ZERO_TIME;
  for (const auto& run : addresses.pieces.runs())
    by_runs = std::max(by_runs, initiator.send(TLM_READ_COMMAND, run.address, buffer.data(), run.bytes,
                                               sc_time(2000, SC_NS)));
  close_rows(3000);
  EXPECT_EQ(by_runs, sc_time(2082, SC_NS));
  EXPECT_EQ(send_addresses(addresses, transfer, 8, sc_time(4000, SC_NS)), sc_time(4082, SC_NS));
}

TEST_F(MonoDdr, PeOutsideMemoryIsAnAddressError) {
  model::PeAddresses addresses;
  const cn::Transfer transfer{cn::Direction::poly_to_mono,
                              {0, 32},
                              cn::MonoPlaces::array(kSize - 64, 32),
                              cn::LaneMask::first(3),
                              {0}};
  EXPECT_EQ(send_addresses(addresses, transfer, 8, sc_time(9, SC_NS)), sc_time(9, SC_NS));
  expect_response(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(ddr.statistics().bytes_written, 0u);
}

TEST_F(MonoDdr, IgnoreCommandWithoutExtensionDoesNothing) {
  buffer.fill(9);
  EXPECT_EQ(initiator.send(tlm::TLM_IGNORE_COMMAND, 0, buffer.data(), 8, sc_time(3, SC_NS)),
            sc_time(3, SC_NS));
  expect_response(tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(buffer[0], 9);
}

TEST_F(MonoDdr, ExtensionIsClonedWithItsAddresses) {
  cn::MonoAddress by_pe[8] = {256};
  model::PeAddresses addresses;
  addresses.pieces.describe(
      {cn::Direction::mono_to_poly, {0, 8}, cn::MonoPlaces::each(by_pe), cn::LaneMask::first(1), {0}}, 8,
      {model::Divisor(64), false});
  auto* const copy = static_cast<model::PeAddresses*>(addresses.clone());
  by_pe[0] = 0;
  addresses.pieces.describe(
      {cn::Direction::mono_to_poly, {0, 8}, cn::MonoPlaces::each(by_pe), cn::LaneMask::first(1), {0}}, 8,
      {model::Divisor(64), false});
  EXPECT_EQ(copy->pieces.places()[0], 256u);
  addresses.copy_from(*copy);
  EXPECT_EQ(addresses.pieces.places()[0], 256u);
  copy->free();
}

}  // namespace mono_ddr_test
