#include "model/host_link/host_link.hpp"

#include <memory>
#include <numeric>
#include <stdexcept>

#include "model/memory/mono_ddr.hpp"
#include "model/network/clear_connect.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"
#include "tests/support/tlm_testers.hpp"

namespace host_link_test {

/// 1 byte a cycle and 1000 cycles a host DMA.
class HostLink : public test_support::SystemCFixture {
 protected:
  void build(const model::ChipConfig& config) {
    network = std::make_unique<model::ClearConnect>("network", config, clock);
    ddr = std::make_unique<model::MonoDdr>("ddr", config, clock);
    host = std::make_unique<model::HostLink>("host", config);
    pio.socket.bind(network->pio_socket);
    control.socket.bind(network->control_socket);
    host->socket.bind(network->host_socket);
    network->ddr_socket.bind(ddr->socket);
    elaborate();
  }
  static model::ChipConfig two_mebibytes() {
    auto config = test_support::test_chip();
    config.ddr.size_bytes = 2 << 20;
    return config;
  }

  model::ClockDomain clock{1e9};
  std::unique_ptr<model::ClearConnect> network;
  std::unique_ptr<model::MonoDdr> ddr;
  std::unique_ptr<model::HostLink> host;
  test_support::TestInitiator pio{"pio"};
  test_support::TestInitiator control{"control"};
};

TEST_F(HostLink, OneDmaTakesLatencyAndBytes) {
  build(two_mebibytes());
  std::vector<std::uint8_t> data(5000);
  std::iota(data.begin(), data.end(), std::uint8_t{3});
  EXPECT_EQ(host->upload(64, data.data(), data.size(), 100), 6100u);
  EXPECT_EQ(std::memcmp(ddr->memory().data() + 64, data.data(), data.size()), 0);
  std::vector<std::uint8_t> back(5000);
  EXPECT_EQ(host->download(64, back.data(), back.size(), 7000), 13000u);
  EXPECT_EQ(back, data);
  EXPECT_EQ(host->statistics().bytes_uploaded, 5000u);
  EXPECT_EQ(host->statistics().bytes_downloaded, 5000u);
  EXPECT_EQ(host->statistics().busy_cycles, 12000u);
  EXPECT_EQ(host->statistics().transfers, 2u);
}

TEST_F(HostLink, LongTransferIsSeveralDmas) {
  build(two_mebibytes());
  std::vector<std::uint8_t> data(2 * 524288 + 1);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = std::uint8_t(i * 7 + i / 251);
  EXPECT_EQ(host->upload(0, data.data(), data.size(), 0), 3u * 1000 + 2 * 524288 + 1);
  EXPECT_EQ(host->statistics().transfers, 3u);
  EXPECT_EQ(std::memcmp(ddr->memory().data(), data.data(), data.size()), 0);
}

TEST_F(HostLink, ExactlyOneDmaAtTheLimit) {
  build(two_mebibytes());
  std::vector<std::uint8_t> data(524288);
  EXPECT_EQ(host->upload(0, data.data(), data.size(), 0), 525288u);
  EXPECT_EQ(host->statistics().transfers, 1u);
}

TEST_F(HostLink, TransfersQueueUp) {
  build(two_mebibytes());
  std::vector<std::uint8_t> data(100);
  EXPECT_EQ(host->upload(0, data.data(), 100, 0), 1100u);
  EXPECT_EQ(host->upload(0, data.data(), 100, 500), 2200u);
  EXPECT_EQ(host->download(0, data.data(), 100, 9000), 10100u);
}

TEST_F(HostLink, NothingToDoIsDoneAtOnce) {
  build(two_mebibytes());
  EXPECT_EQ(host->upload(0, nullptr, 0, 42), 42u);
  EXPECT_EQ(host->statistics().transfers, 0u);
}

TEST_F(HostLink, BandwidthIsOfTheChipClock) {
  auto config = two_mebibytes();
  config.chip.clock_hz = 210e6;
  config.host.bytes_per_second = 800e6;
  config.host.latency_cycles = 0;
  build(config);
  std::vector<std::uint8_t> data(8001);
  EXPECT_EQ(host->upload(0, data.data(), 8000, 0), 2100u);
  EXPECT_EQ(host->upload(0, data.data(), 8001, 10000), 12101u);  // a part of a cycle counts as one
}

TEST_F(HostLink, MoreThanMonoMemoryTakesIsAnError) {
  build(test_support::test_chip());
  std::vector<std::uint8_t> data(16);
  try {
    host->upload((1 << 20) - 8, data.data(), 16, 0);
    FAIL() << "accepted";
  } catch (const std::out_of_range& error) {
    EXPECT_STREQ(error.what(), "host link: 16 bytes at mono address 1048568 do not fit mono memory");
  }
}

}  // namespace host_link_test
