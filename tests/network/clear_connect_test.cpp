#include "model/network/clear_connect.hpp"

#include <numeric>

#include "model/memory/mono_ddr.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"
#include "tests/support/tlm_testers.hpp"

namespace clear_connect_test {

using model::Initiator;
using sc_core::SC_NS;
using sc_core::sc_time;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;

class ClearConnect : public test_support::SystemCFixture {
 protected:
  ClearConnect() {
    pio.socket.bind(network.pio_socket);
    control.socket.bind(network.control_socket);
    host.socket.bind(network.host_socket);
    network.ddr_socket.bind(ddr.socket);
    elaborate();
    std::iota(buffer.begin(), buffer.end(), static_cast<unsigned char>(0));
  }

  sc_time write(test_support::TestInitiator& initiator, std::uint64_t address, std::size_t bytes, double at) {
    return initiator.send(TLM_WRITE_COMMAND, address, buffer.data(), bytes, sc_time(at, SC_NS));
  }
  sc_time read(test_support::TestInitiator& initiator, std::uint64_t address, std::size_t bytes, double at) {
    return initiator.send(TLM_READ_COMMAND, address, buffer.data(), bytes, sc_time(at, SC_NS));
  }

  model::ChipConfig config = test_support::test_chip();
  model::ClockDomain clock{config.chip.clock_hz};
  model::ClearConnect network{"network", config, clock};
  model::MonoDdr ddr{"ddr", config, clock};
  test_support::TestInitiator pio{"pio"};
  test_support::TestInitiator control{"control"};
  test_support::TestInitiator host{"host"};
  std::array<unsigned char, 512> buffer{};
};

TEST_F(ClearConnect, ReadPaysBothWays) {
  // Request 100 -> 106; miss, data 136..140; link 136..144; 6 cycles back.
  EXPECT_EQ(read(pio, 0, 64, 100), sc_time(150, SC_NS));
  // Hit: 206, data 226..230; link 226..234; 240.
  EXPECT_EQ(read(pio, 0, 64, 200), sc_time(240, SC_NS));
  EXPECT_EQ(network.statistics(Initiator::pio).packets, 4u);
  EXPECT_EQ(network.statistics(Initiator::pio).bytes, 128u);
}

TEST_F(ClearConnect, WriteIsPosted) {
  // First packet at 106; miss, data 136..140: the memory has them, no acknowledgement.
  EXPECT_EQ(write(pio, 0, 64, 100), sc_time(140, SC_NS));
  // Hit: 206, data 226..242, though the link is faster: last byte there at 200 + 32 + 6.
  EXPECT_EQ(write(pio, 0, 256, 200), sc_time(242, SC_NS));
}

TEST_F(ClearConnect, NarrowLinkHoldsUpAFastMemory) {
  read(pio, 0, 8, 0);
  // Hit: 206, data 226..242; link 226..258; 264.
  EXPECT_EQ(read(pio, 0, 256, 200), sc_time(264, SC_NS));
  // Hit: 1006, data would be taken in 1026..1058, but the last byte is there at 1000 + 64 + 6.
  EXPECT_EQ(write(pio, 0, 512, 1000), sc_time(1070, SC_NS));
}

TEST_F(ClearConnect, InitiatorsWaitForEachOther) {
  write(pio, 0, 8, 0);
  EXPECT_EQ(write(pio, 0, 256, 1000), sc_time(1042, SC_NS));  // port 1006..1022, data 1026..1042
  EXPECT_EQ(network.statistics(Initiator::control).waiting_cycles, 0u);
  write(control, 0, 64, 1002);  // ready 1008, port free at 1022
  EXPECT_EQ(network.statistics(Initiator::control).waiting_cycles, 14u);
  EXPECT_EQ(network.statistics(Initiator::control).bytes, 64u);
  EXPECT_EQ(network.statistics(Initiator::host).bytes, 0u);
}

TEST_F(ClearConnect, EachSocketIsAnInitiatorOfItsOwn) {
  write(pio, 0, 64, 0);
  write(control, 0, 128, 0);
  write(host, 0, 192, 0);
  EXPECT_EQ(network.statistics(Initiator::pio).packets, 1u);
  EXPECT_EQ(network.statistics(Initiator::control).packets, 2u);
  EXPECT_EQ(network.statistics(Initiator::host).packets, 3u);
}

TEST_F(ClearConnect, ErrorsComeBack) {
  read(control, 1 << 20, 8, 0);
  EXPECT_EQ(control.transaction.get_response_status(), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  write(control, (1 << 20) - 4, 8, 0);
  EXPECT_EQ(control.transaction.get_response_status(), tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST_F(ClearConnect, DebugAndPointersPassThrough) {
  EXPECT_EQ(host.debug(TLM_WRITE_COMMAND, 1000, buffer.data(), 256), 256u);
  EXPECT_EQ(ddr.memory().data()[1010], 10);
  ASSERT_TRUE(control.ask_for_pointer(0));
  EXPECT_EQ(control.dmi.get_dmi_ptr(), ddr.memory().data());
  ddr.socket->invalidate_direct_mem_ptr(0, 100);
  EXPECT_EQ(pio.invalidations, 1);
  EXPECT_EQ(control.invalidations, 1);
  EXPECT_EQ(host.invalidations, 1);
  EXPECT_EQ(network.statistics(Initiator::host).bytes, 0u);
}

TEST_F(ClearConnect, PeAddressesAreBookedWithTheirPacketsAndBytes) {
  const cn::MonoAddress by_pe[8] = {0, 2048, 4096};
  model::PeAddresses addresses;
  addresses.pieces.describe(
      {cn::Direction::mono_to_poly, {0, 80}, cn::MonoPlaces::each(by_pe), cn::LaneMask::first(3), {0}}, 8,
      {model::Divisor(64), false});
  pio.transaction.set_extension(&addresses);
  const sc_time end = pio.send(tlm::TLM_IGNORE_COMMAND, 0, buffer.data(), 8, sc_time(100, SC_NS));
  pio.transaction.clear_extension(&addresses);
  // At 106; bank 0: 136..141, may change at 121, 151..156, 166..171; link 136..166, last byte 171; 6 cycles
  // back.
  EXPECT_EQ(end, sc_time(177, SC_NS));
  EXPECT_EQ(network.statistics(Initiator::pio).packets, 12u);
  EXPECT_EQ(network.statistics(Initiator::pio).bytes, 240u);
}

}  // namespace clear_connect_test
