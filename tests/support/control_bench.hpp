#pragma once

#include <functional>
#include <memory>

#include "model/csx600.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"

namespace test_support {

using cn::InstructionClass;
using cn::IssueCounts;

inline constexpr model::Cycles kStart = 1000;

/// A kernel that issues the instructions that the test sets and computes nothing.
struct FakeArguments {
  IssueCounts issued;
};

inline void run_fake(const FakeArguments& arguments, cn::PolyMemory&, const cn::LaneMask& enabled,
                     cn::IssueTree& issued) {
  issued.clear();
  issued.root().counts = arguments.issued;
  issued.root().enabled_lanes = std::uint64_t(enabled.count());
  issued.root().reached = enabled.any();
}

inline constexpr cn::Kernel<FakeArguments> kFake{"fake", &run_fake};

inline FakeArguments issues(InstructionClass instruction, std::uint64_t times) {
  FakeArguments arguments;
  arguments.issued[instruction] = times;
  return arguments;
}

/// A whole small chip with 8 PEs and a cycle of 1 ns, which runs firmware of the test from cycle kStart on.
class ControlBench : public SystemCFixture {
 protected:
  using Firmware = std::function<void(cn::Machine&)>;

  void build(const model::ChipConfig& config, model::TimingStyle timing = model::TimingStyle::loosely_timed) {
    chip = std::make_unique<model::Csx600>("chip", config, timing);
  }

  /// Runs until no events are left. What the firmware threw stays in the control unit.
  void run(Firmware firmware) {
    if (!chip) build(test_chip());
    chip->control_unit.load(std::move(firmware));
    sc_core::sc_start(sc_core::sc_time(double(kStart), sc_core::SC_NS));
    chip->control_unit.start();
    sc_core::sc_start();
  }
  void run_well(Firmware firmware) {
    run(std::move(firmware));
    chip->control_unit.rethrow_failure();
    EXPECT_TRUE(chip->control_unit.finished());
    EXPECT_EQ(chip->control_unit.start_cycle(), kStart);
    EXPECT_EQ(statistics().total(), chip->control_unit.now() - kStart);
  }

  const model::ControlStatistics& statistics() const { return chip->control_unit.statistics(); }
  model::Cycles spent(model::CycleCause cause) const { return statistics()[cause]; }
  std::uint8_t* mono() { return chip->mono_ddr->memory().data(); }

  /// A transfer of 8 x 32 bytes without gaps: 100 setup + 8 x (10 + 4) = 212 cycles in the engine, in both
  /// directions.
  static constexpr model::Cycles kRequestCycles = 212;
  static void load(cn::Machine& machine, cn::Semaphore done,
                   const cn::LaneMask& enabled = cn::LaneMask::first(8)) {
    machine.async_copy_m2p(done, {0, 32}, cn::MonoPlaces::array(0, 32), enabled);
  }
  static void save(cn::Machine& machine, cn::Semaphore done) {
    machine.async_copy_p2m(done, cn::MonoPlaces::array(4096, 32), {0, 32}, cn::LaneMask::first(8));
  }

  std::unique_ptr<model::Csx600> chip;
};

}  // namespace test_support
