// What a host transfer does to programmed I/O on the network and in the memory, alone and in both styles of
// timing.

#include <vector>

#include "tests/support/control_bench.hpp"

namespace host_contention_test {

using cn::Machine;
using cn::Semaphore;
using model::Cycles;
using model::Initiator;
using model::TimingStyle;
using test_support::kStart;
using test_support::test_chip;

constexpr Cycles kDownload = kStart - 100;

/// Downloads from shortly before the firmware starts, in a process of its own as a host would.
class Downloader : public sc_core::sc_module {
 public:
  Downloader(const sc_core::sc_module_name& name, model::Csx600& chip, std::uint64_t bytes)
      : sc_module(name), chip_(chip), data_(bytes) {
    SC_HAS_PROCESS(Downloader);
    SC_THREAD(run);
  }
  Cycles end = 0;

 private:
  void run() {
    if (data_.empty()) return;
    wait(sc_core::sc_time(double(kDownload), sc_core::SC_NS));
    end = chip_.host_link.download(1 << 16, data_.data(), data_.size(), kDownload);
  }
  model::Csx600& chip_;
  std::vector<std::uint8_t> data_;
};

struct Measured {
  Cycles loads = 0;  ///< the firmware's time
  model::ClearConnectStatistics pio;
  model::ClearConnectStatistics host;
  Cycles download_end = 0;
};

class HostContention : public test_support::SystemCFixture, public testing::WithParamInterface<TimingStyle> {
 protected:
  /// Ten loads in a row, each waited for, beside a download of so many bytes.
  static Measured measure(model::ChipConfig config, std::uint64_t download_bytes, TimingStyle timing,
                          Cycles compute_before = 10) {
    sc_core::sc_curr_simcontext = new sc_core::sc_simcontext();
    sc_core::sc_default_global_context = sc_core::sc_curr_simcontext;
    model::Csx600 chip("chip", config, timing);
    Downloader downloader("downloader", chip, download_bytes);
    chip.control_unit.load([&](Machine& machine) {
      const Semaphore done = machine.allocate_semaphore("done");
      machine.issue_mono(compute_before);
      for (int i = 0; i < 10; ++i) {
        machine.async_copy_m2p(done, {0, 128}, cn::MonoPlaces::array(0, 128), cn::LaneMask::first(8));
        machine.sem_wait(done);
      }
    });
    sc_core::sc_start(sc_core::sc_time(double(kStart), sc_core::SC_NS));
    chip.control_unit.start();
    sc_core::sc_start();
    chip.control_unit.rethrow_failure();
    return {chip.control_unit.now() - kStart, chip.clear_connect.statistics(Initiator::pio),
            chip.clear_connect.statistics(Initiator::host), downloader.end};
  }
  /// Loads wait for the memory, and the host link is half as fast as it.
  static model::ChipConfig memory_bound_chip() {
    model::ChipConfig config = test_chip();
    config.pio.setup_cycles = 0;
    config.pio.per_pe_cycles = 0;
    config.ddr.bytes_per_cycle = 2;
    config.host.latency_cycles = 0;
    return config;
  }
};

TEST_P(HostContention, DownloadHoldsUpLoads) {
  const model::ChipConfig config = memory_bound_chip();
  const Measured alone = measure(config, 0, GetParam());
  const Measured beside = measure(config, 100000, GetParam());
  EXPECT_EQ(alone.host.packets, 0u);
  EXPECT_GT(beside.host.packets, 50u);
  // The host takes half of the memory's width: loads of 1024 bytes, 512 cycles alone, need up to twice as
  // long.
  EXPECT_GT(double(beside.loads), 1.2 * double(alone.loads));
  EXPECT_LT(double(beside.loads), 2.3 * double(alone.loads));
}

TEST_P(HostContention, SlowLinkHardlyMatters) {
  model::ChipConfig config = memory_bound_chip();
  config.host.bytes_per_second = 0.02e9;  // a hundredth of the memory
  const Measured alone = measure(config, 0, GetParam());
  const Measured beside = measure(config, 100000, GetParam());
  EXPECT_GT(beside.loads, alone.loads);
  EXPECT_LT(double(beside.loads), 1.1 * double(alone.loads));
}

TEST_P(HostContention, LongTransferDoesNotPushAsideWhatComesBeforeItsEnd) {
  const model::ChipConfig config = memory_bound_chip();
  const Measured shorter = measure(config, 100000, GetParam());
  const Measured longer = measure(config, 600000, GetParam());
  EXPECT_EQ(shorter.loads, longer.loads);  // over long before either transfer ends
}

TEST_P(HostContention, TransferThatIsOverHoldsUpNobody) {
  const model::ChipConfig config = memory_bound_chip();
  constexpr Cycles kLate = 100000;
  const Measured alone = measure(config, 0, GetParam(), kLate);
  const Measured after = measure(config, 5000, GetParam(), kLate);
  EXPECT_NEAR(double(after.loads), double(alone.loads), 60.0);  // another row is open, a refresh more
}

TEST_P(HostContention, DownloadEndsWithTheLinkWhereTheMemoryKeepsUp) {
  const Measured beside = measure(test_chip(), 100000, GetParam());
  // 1000 cycles and a byte a cycle.
  EXPECT_NEAR(double(beside.download_end), double(kDownload + 1000 + 100000), 1.0);
}

TEST(HostContentionStyles, Agree) {
  struct Open : HostContention {
    using HostContention::measure;
    using HostContention::memory_bound_chip;
  };
  for (const std::uint64_t bytes : {std::uint64_t{0}, std::uint64_t{100000}}) {
    const Measured loose = Open::measure(Open::memory_bound_chip(), bytes, TimingStyle::loosely_timed);
    const Measured approximate =
        Open::measure(Open::memory_bound_chip(), bytes, TimingStyle::approximately_timed);
    testing::Test::RecordProperty("loose_" + std::to_string(bytes), std::to_string(loose.loads));
    testing::Test::RecordProperty("approximate_" + std::to_string(bytes), std::to_string(approximate.loads));
    EXPECT_NEAR(double(loose.loads), double(approximate.loads), 0.1 * double(approximate.loads)) << bytes;
  }
}

INSTANTIATE_TEST_SUITE_P(Styles, HostContention,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed),
                         [](const testing::TestParamInfo<TimingStyle>& style) {
                           return style.param == TimingStyle::loosely_timed ? "Lt" : "At";
                         });

}  // namespace host_contention_test
