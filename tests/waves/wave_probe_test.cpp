#include "model/waves/wave_probe.hpp"

#include <array>

#include "model/network/clear_connect_timing.hpp"
#include "tests/support/wave_probe_fixture.hpp"

namespace wave_probe_test {

using model::CycleCause;
using model::Cycles;
using test_support::changes;
using test_support::Reporter;
using test_support::state;
using test_support::VcdReader;
using List = test_support::ChangeList;

class WaveProbe : public test_support::WaveProbeFixture {};

constexpr Cycles kEndOfRun = std::numeric_limits<Cycles>::max();

TEST_F(WaveProbe, FileHoldsTheSignalsOfTheTableAndNothingElse) {
  make_probe();
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 10, -1);
    reporter.wait_until(10);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(vcd.timescale(), "1 ps");
  const std::vector<model::WaveInstance> signals = model::wave_instances(chip);
  EXPECT_EQ(vcd.signals().size(), signals.size());
  for (const model::WaveInstance& signal : signals)
    EXPECT_EQ(vcd.signal(signal.path).width, signal.info->width) << signal.path;
}

TEST_F(WaveProbe, SpansChangeAtTheirTimes) {
  make_probe();
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 10, -1);
    probe->spent(CycleCause::mono, 10, 15, -1);  // same cause: no change
    probe->spent(CycleCause::wait_load, 15, 40, 3);
    probe->spent(CycleCause::poly, 40, 90, -1);
    probe->ran_kernel("intersect", 40, 90, 96);
    reporter.wait_until(90);
    probe->spent(CycleCause::poly, 90, 100, -1);
    probe->ran_kernel("shade", 90, 100, 7);
    probe->spent(CycleCause::poly, 100, 130, -1);
    probe->ran_kernel("intersect", 100, 130, 0);
    reporter.wait_until(130);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(changes(vcd, "control.state"), (List{{0, state(CycleCause::mono)},
                                                 {15'000, state(CycleCause::wait_load)},
                                                 {40'000, state(CycleCause::poly)},
                                                 {130'000, 0}}));
  EXPECT_EQ(changes(vcd, "control.semaphore"), (List{{0, 255}, {15'000, 3}, {40'000, 255}}));
  EXPECT_EQ(changes(vcd, "control.kernel"),
            (List{{0, 0}, {40'000, 1}, {90'000, 2}, {100'000, 1}, {130'000, 0}}));
  EXPECT_EQ(changes(vcd, "pe_array.busy"), (List{{0, 0}, {40'000, 1}, {130'000, 0}}));
  EXPECT_EQ(changes(vcd, "pe_array.enabled_pes"), (List{{0, 0}, {40'000, 96}, {90'000, 7}, {100'000, 0}}));
  EXPECT_EQ(probe->kernel_names(), (std::vector<std::string>{"intersect", "shade"}));
  EXPECT_EQ(vcd.last_time(), 130'000u);
  EXPECT_EQ(probe->late_changes(), 0u);
}

TEST_F(WaveProbe, UnitsThatReportInAnyOrderAreSortedByTime) {
  make_probe();
  simulate([&](Reporter& reporter) {
    transfer(0, cn::Direction::mono_to_poly, 50, 80, 6144, 2);
    transfer(1, cn::Direction::poly_to_mono, 80, 95, 768, 1);
    probe->spent(CycleCause::mono, 0, 20, -1);
    reporter.wait_until(20);
    load(2, 95, 100);
    load(3, 100, 104);  // follows without a gap
    probe->spent(CycleCause::wait_load, 20, 104, 0);
    reporter.wait_until(104);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(changes(vcd, "pio.loading"), (List{{0, 0}, {50'000, 1}, {80'000, 0}, {95'000, 1}, {104'000, 0}}));
  EXPECT_EQ(changes(vcd, "pio.saving"), (List{{0, 0}, {80'000, 1}, {95'000, 0}}));
  EXPECT_EQ(changes(vcd, "pio.queue_depth"), (List{{0, 0}, {50'000, 2}, {80'000, 1}, {95'000, 0}}));
  EXPECT_EQ(changes(vcd, "pio.load_request"),
            (List{{0, model::kNoRequest}, {50'000, 0}, {95'000, 2}, {100'000, 3}}));
  EXPECT_EQ(changes(vcd, "pio.load_bytes"), (List{{0, 0}, {50'000, 6144}, {95'000, 64}}));
  EXPECT_EQ(changes(vcd, "pio.save_bytes"), (List{{0, 0}, {80'000, 768}}));
}

TEST_F(WaveProbe, TwoEnginesShowSideBySide) {
  make_probe();
  simulate([&](Reporter& reporter) {
    load(0, 10, 60);
    save(1, 30, 80);
    reporter.wait_until(100);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(changes(vcd, "pio.loading"), (List{{0, 0}, {10'000, 1}, {60'000, 0}}));
  EXPECT_EQ(changes(vcd, "pio.saving"), (List{{0, 0}, {30'000, 1}, {80'000, 0}}));
  EXPECT_EQ(vcd.value_at("pio.load_request", 50'000), 0u);
  EXPECT_EQ(vcd.value_at("pio.save_request", 50'000), 1u);
  EXPECT_EQ(vcd.value_at("pio.save_bytes", 70'000), 64u);
}

TEST_F(WaveProbe, EmptySpansLeaveNoTrace) {
  make_probe();
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::poly, 0, 20, -1);
    load(0, 20, 20);
    probe->ran_kernel("nothing", 20, 20, 96);
    probe->spent(CycleCause::mono, 20, 21, -1);
    reporter.wait_until(30);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(changes(vcd, "pio.loading"), (List{{0, 0}}));
  EXPECT_EQ(changes(vcd, "control.kernel"), (List{{0, 0}}));
  EXPECT_EQ(vcd.time_at_value("control.state", state(CycleCause::mono)), 1'000u);
}

TEST_F(WaveProbe, MemoryCountsAppearWhenTheirRequestIsOverAndNeverFall) {
  make_probe();
  simulate([&](Reporter& reporter) {
    memory = {3, 1, 6144, 0, 6144};
    load(0, 10, 60);
    memory = {4, 1, 6144, 768, 6912};
    save(1, 20, 40);  // by another engine, over before the load
    reporter.wait_until(70);
    memory.bytes_read += 32;
    probe->spent(CycleCause::data_cache, 70, 95, -1);
    reporter.wait_until(95);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(changes(vcd, "ddr.page_hits"), (List{{0, 0}, {40'000, 4}}));
  EXPECT_EQ(changes(vcd, "ddr.page_misses"), (List{{0, 0}, {40'000, 1}}));
  EXPECT_EQ(changes(vcd, "ddr.bytes_read"), (List{{0, 0}, {40'000, 6144}, {95'000, 6176}}));
  EXPECT_EQ(changes(vcd, "ddr.bytes_written"), (List{{0, 0}, {40'000, 768}}));
  EXPECT_EQ(changes(vcd, "clear_connect.pio_bytes"), (List{{0, 0}, {40'000, 6912}}));
}

TEST_F(WaveProbe, PulsesOfOneCycleSurviveLateInALongRun) {
  make_probe(1'000'000'000'000, kEndOfRun, 210e6);  // 79 minutes at 210 MHz, 4761.9 ps a cycle
  const Cycles begin = 1'000'000'000'010;
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, begin, -1);
    for (Cycles cycle = begin; cycle < begin + 100; cycle += 2) {
      probe->spent(CycleCause::semaphore, cycle, cycle + 1, 5);
      probe->spent(CycleCause::poly, cycle + 1, cycle + 2, -1);
    }
    reporter.wait_until(begin + 100);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(vcd.signal("control.semaphore").changes.size(), 101u);
  const double cycle = 1e12 / 210e6;
  EXPECT_NEAR(double(vcd.time_at_value("control.semaphore", 5)) / cycle, 50, 0.05);
}

TEST_F(WaveProbe, TotalsOfTheFileEqualTheReportersCounters) {
  make_probe();
  std::array<Cycles, model::kCycleCauses> by_cause{};
  Cycles pio_busy = 0;
  Cycles kernel_cycles = 0;
  simulate([&](Reporter& reporter) {
    std::uint64_t random = 12345;
    const auto below = [&](std::uint64_t limit) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      return (random >> 33) % limit;
    };
    Cycles now = 0;
    Cycles pio_free = 0;
    for (std::uint64_t id = 0; id < 500; ++id) {
      const auto cause = static_cast<CycleCause>(below(model::kCycleCauses));
      const Cycles cycles = 1 + below(100);
      probe->spent(cause, now, now + cycles, -1);
      if (cause == CycleCause::poly) {
        probe->ran_kernel("kernel", now, now + cycles, 96);
        kernel_cycles += cycles;
      }
      by_cause[std::size_t(cause)] += cycles;
      const Cycles start = std::max(pio_free, now + below(50));
      pio_free = start + below(120);
      transfer(id, below(2) == 0 ? cn::Direction::mono_to_poly : cn::Direction::poly_to_mono, start,
               pio_free);
      pio_busy += pio_free - start;
      now += cycles;
      if (below(3) == 0) reporter.wait_until(now);
    }
    reporter.wait_until(std::max(now, pio_free));
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  for (int cause = 0; cause < model::kCycleCauses; ++cause)
    EXPECT_EQ(vcd.time_at_value("control.state", std::uint64_t(cause) + 1),
              1000 * by_cause[std::size_t(cause)])
        << model::cycle_cause_name(static_cast<CycleCause>(cause));
  EXPECT_EQ(vcd.time_at_value("pio.loading", 1) + vcd.time_at_value("pio.saving", 1), 1000 * pio_busy);
  EXPECT_EQ(vcd.time_at_value("pe_array.busy", 1), 1000 * kernel_cycles);
  EXPECT_EQ(probe->late_changes(), 0u);
}

TEST_F(WaveProbe, ChangesAtTheStopAreDumped) {
  make_probe();
  simulate([&](Reporter& reporter) {
    probe->spent(CycleCause::mono, 0, 80, -1);
    save(0, 60, 80);
    reporter.wait_until(80);
    sc_core::sc_stop();
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(vcd.value_at("control.state", 80'000), 0u);
  EXPECT_EQ(vcd.value_at("pio.saving", 80'000), 0u);
  EXPECT_EQ(vcd.value_at("pio.saving", 79'999), 1u);
}

TEST_F(WaveProbe, LateReportsAreCountedAndShownLate) {
  make_probe();
  simulate([&](Reporter& reporter) {
    for (Cycles cycle = 0; cycle < 9000; cycle += 3000) {  // time passes at what is reported
      probe->spent(CycleCause::mono, cycle, cycle + 3000, -1);
      reporter.wait_until(cycle + 3001);
    }
    load(0, 90, 9100);
    reporter.wait_until(9100);
  });
  probe->finish();
  EXPECT_GT(probe->late_changes(), 0u);
  const List loading = changes(vcd(), "pio.loading");
  ASSERT_EQ(loading.size(), 3u);
  EXPECT_GT(loading[1].first, 90'000u);
  EXPECT_EQ(loading[2], (List::value_type{9'100'000, 0}));
}

TEST_F(WaveProbe, BlocksAreNamedByWhatTheFirmwareSays) {
  make_probe();
  const char* const rays = "ray stage";
  const char* const paths = "path stage";
  simulate([&](Reporter& reporter) {
    const auto compute = [&](const cn::Label& label, Cycles start, Cycles finish) {
      probe->kernel_details({nullptr, nullptr, label});
      probe->ran_kernel("kernel", start, finish, 8);
    };
    compute({rays, 3}, 10, 20);
    compute({rays, 3}, 25, 30);
    compute({rays, 4}, 30, 40);
    compute({paths, 4}, 40, 50);
    compute({}, 50, 60);
    model::PioEvent event;
    event.label = {rays, 5};
    event.started = 12;
    probe->started(event);
    event.finished = 38;
    probe->finished(event);
    probe->filled(3, 96, 20);
    probe->filled(4, 50, 30);
    probe->filled(3, 90, 50);
    reporter.wait_until(60);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(probe->bin_names(), (std::vector<std::string>{rays, paths}));
  EXPECT_EQ(changes(vcd, "bins.compute_stage"), (List{{0, 0}, {10'000, 1}, {40'000, 2}, {50'000, 0}}));
  EXPECT_EQ(changes(vcd, "bins.compute_block"),
            (List{{0, model::kNoBlock}, {10'000, 3}, {30'000, 4}, {50'000, model::kNoBlock}}));
  EXPECT_EQ(changes(vcd, "bins.load_block"), (List{{0, model::kNoBlock}, {12'000, 5}}));
  EXPECT_EQ(changes(vcd, "bins.fill"), (List{{0, 0}, {20'000, 96}, {30'000, 146}, {50'000, 140}}));
}

TEST_F(WaveProbe, MemoryPortsAndBanksShowWhoUsesThem) {
  make_probe();
  simulate([&](Reporter& reporter) {
    probe->passed(model::Initiator::pio, true, 10, 14);
    probe->passed(model::Initiator::host, true, 14, 15);
    probe->passed(model::Initiator::control, false, 12, 20);
    probe->accessed(true, 20, 30);
    probe->moved_data(true, 20, 22);
    probe->moved_data(true, 25, 30);
    probe->commanded(1, model::DdrCommand::activate, 77, 5);
    probe->commanded(1, model::DdrCommand::write, 77, 15);
    probe->commanded(0, model::DdrCommand::write, 3, 8);
    probe->commanded(-1, model::DdrCommand::refresh, 0, 40);
    probe->began_transfer(true, 64, 2);
    probe->ended_transfer(true, 64, 2, 9);
    reporter.wait_until(60);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(changes(vcd, "clear_connect.to_ddr"), (List{{0, 0}, {10'000, 1}, {14'000, 3}, {15'000, 0}}));
  EXPECT_EQ(changes(vcd, "clear_connect.from_ddr"), (List{{0, 0}, {12'000, 2}, {20'000, 0}}));
  EXPECT_EQ(changes(vcd, "ddr.bus"), (List{{0, 0}, {20'000, 2}, {30'000, 0}}));
  EXPECT_EQ(changes(vcd, "ddr.data"), (List{{0, 0}, {20'000, 2}, {22'000, 0}, {25'000, 2}, {30'000, 0}}));
  EXPECT_EQ(changes(vcd, "ddr.bank_1.command"), (List{{0, 0}, {5'000, 1}, {15'000, 3}, {40'000, 4}}));
  EXPECT_EQ(changes(vcd, "ddr.bank_1.row"), (List{{0, 0}, {5'000, 77}}));
  EXPECT_EQ(changes(vcd, "ddr.bank_0.command"), (List{{0, 0}, {8'000, 3}, {40'000, 4}}));
  EXPECT_EQ(changes(vcd, "host_link.state"), (List{{0, 0}, {2'000, 1}, {9'000, 0}}));
}

TEST_F(WaveProbe, SinglePesShowTheirPart) {
  make_probe();
  cn::LaneMask some;
  some.set(2, true);
  some.set(5, true);
  simulate([&](Reporter& reporter) {
    probe->kernel_details({&some, nullptr, {}});
    probe->ran_kernel("kernel", 10, 20, 2);
    model::PioEvent load;
    load.enabled = &some;
    load.started = 12;
    probe->started(load);
    load.finished = 30;
    probe->finished(load);
    model::PioEvent save;
    save.direction = cn::Direction::poly_to_mono;
    save.started = 15;
    probe->started(save);
    save.finished = 25;
    probe->finished(save);
    reporter.wait_until(40);
  });
  probe->finish();
  const VcdReader vcd = this->vcd();
  EXPECT_EQ(changes(vcd, "pe_array.pe_5.enabled"), (List{{0, 0}, {10'000, 1}, {20'000, 0}}));
  EXPECT_EQ(changes(vcd, "pe_array.pe_4.enabled"), (List{{0, 0}}));
  EXPECT_EQ(changes(vcd, "pe_array.pe_2.transfer"),
            (List{{0, 0}, {12'000, 1}, {15'000, 3}, {25'000, 1}, {30'000, 0}}));
  EXPECT_EQ(changes(vcd, "pe_array.pe_4.transfer"), (List{{0, 0}, {15'000, 2}, {25'000, 0}}));
}

}  // namespace wave_probe_test
