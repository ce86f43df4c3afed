#include "model/network/clear_connect_timing.hpp"

#include <gtest/gtest.h>

#include "tests/support/test_chip.hpp"

namespace clear_connect_timing_test {

using model::ClearConnectTiming;
using model::Initiator;

/// Links of 8 bytes a cycle, 6 cycles of hops, a DDR port of 16 bytes a cycle.
ClearConnectTiming test_network() {
  return ClearConnectTiming(test_support::test_chip().clear_connect, 16);
}

void expect_passage(const ClearConnectTiming::Passage& passage, model::Cycles first, model::Cycles last) {
  EXPECT_EQ(passage.first, first);
  EXPECT_EQ(passage.last, last);
}

TEST(ClearConnectTiming, PacketsAreRoundedUp) {
  const auto network = test_network();
  EXPECT_EQ(network.packets_for(1), 1u);
  EXPECT_EQ(network.packets_for(64), 1u);
  EXPECT_EQ(network.packets_for(65), 2u);
}

TEST(ClearConnectTiming, WriteDataTakeTheLinkThenThePort) {
  auto network = test_network();
  // Link 100..116, first packet 6 cycles later, last byte when the link's last has crossed.
  expect_passage(network.forward(Initiator::pio, 128, 2, 100), 106, 122);
  // The link is taken until 116.
  expect_passage(network.forward(Initiator::pio, 64, 1, 104), 122, 130);
  EXPECT_EQ(network.statistics(Initiator::pio).bytes, 192u);
  EXPECT_EQ(network.statistics(Initiator::pio).packets, 3u);
  EXPECT_EQ(network.statistics(Initiator::pio).waiting_cycles, 0u);
}

TEST(ClearConnectTiming, InitiatorsContendForThePortOnly) {
  auto network = test_network();
  network.forward(Initiator::pio, 128, 2, 100);  // port 106..114
  expect_passage(network.forward(Initiator::control, 64, 1, 101), 114, 118);
  expect_passage(network.request(Initiator::host, 1, 104), 118, 119);
  EXPECT_EQ(network.statistics(Initiator::control).waiting_cycles, 7u);
  EXPECT_EQ(network.statistics(Initiator::host).waiting_cycles, 8u);
  EXPECT_EQ(network.statistics(Initiator::host).bytes, 0u);
  EXPECT_EQ(network.statistics(Initiator::host).packets, 1u);
}

TEST(ClearConnectTiming, RequestsTakeACycleEach) {
  auto network = test_network();
  expect_passage(network.request(Initiator::pio, 4, 100), 106, 110);
  expect_passage(network.request(Initiator::pio, 1, 100), 110, 111);
}

TEST(ClearConnectTiming, ReadDataComeBackAtTheWidthOfTheLink) {
  auto network = test_network();
  // The memory sends 64 bytes in 200..204; the link needs 8 cycles.
  EXPECT_EQ(network.backward(Initiator::pio, 64, 1, 200, 204), 214u);
  // Port taken until 204, so link 204..212.
  EXPECT_EQ(network.backward(Initiator::control, 64, 1, 201, 205), 218u);
  EXPECT_EQ(network.statistics(Initiator::control).waiting_cycles, 3u);
  // Port 208..212, link free since 208.
  EXPECT_EQ(network.backward(Initiator::pio, 64, 1, 204, 208), 222u);
}

TEST(ClearConnectTiming, SlowMemoryDelaysTheEnd) {
  auto network = test_network();
  EXPECT_EQ(network.backward(Initiator::pio, 64, 4, 200, 500), 506u);
}

TEST(ClearConnectTiming, DirectionsDoNotDisturbEachOther) {
  auto network = test_network();
  network.forward(Initiator::pio, 6400, 100, 100);
  EXPECT_EQ(network.backward(Initiator::pio, 64, 1, 200, 204), 214u);
}

TEST(ClearConnectTiming, NarrowPortIsTheBottleneck) {
  ClearConnectTiming network(test_support::test_chip().clear_connect, 1);
  expect_passage(network.forward(Initiator::pio, 256, 4, 1114), 1120, 1376);
  EXPECT_EQ(network.backward(Initiator::pio, 256, 4, 1146, 1402), 1408u);
  EXPECT_EQ(network.backward(Initiator::control, 16, 1, 1150, 1166), 1424u);  // port 1402..1418
}

TEST(ClearConnectTiming, ThePortToTheDdrMayBeNarrowerThanTheDdr) {
  auto config = test_support::test_chip().clear_connect;
  config.ddr_port_bytes_per_cycle = 4;
  ClearConnectTiming network(config, 16);
  expect_passage(network.forward(Initiator::pio, 64, 1, 100), 106, 122);  // port 106..122
}

TEST(ClearConnectTiming, PortsDoNotWaitForEachOther) {
  auto network = test_network();
  const model::Port other = network.add_port({32, 1});
  network.forward(Initiator::pio, 6400, 100, 100);  // the DDR's port is taken until 906 at least
  expect_passage(network.forward(Initiator::control, 64, 1, 100, other), 102, 110);
  // The same initiator's link is taken until 900.
  expect_passage(network.forward(Initiator::pio, 64, 1, 100, other), 902, 910);
  EXPECT_EQ(network.backward(Initiator::control, 64, 1, 200, 204, other), 210u);  // link 200..208, 2 cycles
  EXPECT_EQ(network.statistics(Initiator::control).waiting_cycles, 0u);
}

}  // namespace clear_connect_timing_test
