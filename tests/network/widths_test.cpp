// The width of the network, that of its port to the DDR, that of the DDR and the size of mono memory are
// parameters of their own: each changes what it should, and nothing else.

#include "model/csx600.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"

namespace widths_test {

using model::Cycles;

struct Outcome {
  Cycles cycles;           ///< of a load of 512 bytes a PE, all PEs' pieces side by side
  Cycles ddr_busy_cycles;  ///< of the data bus
};

class Widths : public test_support::SystemCFixture {
 protected:
  /// A chip whose PIO engine is never what takes longest.
  static model::ChipConfig chip() {
    model::ChipConfig config = test_support::test_chip();
    config.pio.setup_cycles = 0;
    config.pio.per_pe_cycles = 0;
    config.pio.bytes_per_cycle = 4096;
    return config;
  }
  static Outcome run(const model::ChipConfig& config) {
    new_context();
    model::Csx600 chip("chip", config);
    chip.control_unit.load([](cn::Machine& machine) {
      const cn::PolySpan piece = machine.poly_memory().allocate("piece", 512);
      const cn::Semaphore done = machine.allocate_semaphore("done");
      machine.async_copy_m2p(done, piece, cn::MonoPlaces::array(0, 512), cn::LaneMask::first(8));
      machine.sem_wait(done);
    });
    chip.control_unit.start();
    sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
    chip.control_unit.require_finished();
    return {chip.control_unit.statistics().total(), chip.ddr_statistics().busy_cycles};
  }
};

constexpr Cycles kBytes = 8 * 512;

TEST_F(Widths, TheNetworksLinkIsWhatTakesLongestHere) {
  const Outcome base = run(chip());
  EXPECT_EQ(base.ddr_busy_cycles, kBytes / 16);
  EXPECT_GE(base.cycles, kBytes / 8);
  EXPECT_LT(base.cycles, kBytes / 8 + 100);
  model::ChipConfig narrow = chip();
  narrow.clear_connect.bytes_per_cycle = 4;
  EXPECT_EQ(run(narrow).cycles, base.cycles + kBytes / 8);
  EXPECT_EQ(run(narrow).ddr_busy_cycles, base.ddr_busy_cycles) << "the DDR is as wide as before";
}

TEST_F(Widths, TheDdrsWidthIsItsOwn) {
  const Outcome base = run(chip());
  model::ChipConfig narrow = chip();
  narrow.ddr.bytes_per_cycle = 4;
  EXPECT_EQ(run(narrow).ddr_busy_cycles, 4 * base.ddr_busy_cycles);
  EXPECT_GE(run(narrow).cycles, kBytes / 4);
  model::ChipConfig wide = chip();
  wide.ddr.bytes_per_cycle = 32;
  EXPECT_EQ(run(wide).ddr_busy_cycles, base.ddr_busy_cycles / 2);
  EXPECT_GE(run(wide).cycles, kBytes / 8) << "the network is as narrow as before";
}

TEST_F(Widths, ThePortToTheDdrIsAsWideAsTheDdrUnlessItIsSet) {
  const Outcome base = run(chip());
  model::ChipConfig set = chip();
  set.clear_connect.ddr_port_bytes_per_cycle = 16;
  EXPECT_EQ(run(set).cycles, base.cycles);
  set.clear_connect.ddr_port_bytes_per_cycle = 2;
  EXPECT_GE(run(set).cycles, kBytes / 2);
  EXPECT_EQ(run(set).ddr_busy_cycles, base.ddr_busy_cycles) << "the bus transfers as fast as before";
}

TEST_F(Widths, TheSizeOfMonoMemoryChangesNoTime) {
  const Outcome base = run(chip());
  model::ChipConfig large = chip();
  large.ddr.size_bytes = std::uint64_t{8} << 20;
  EXPECT_EQ(run(large).cycles, base.cycles);
  EXPECT_EQ(model::address_map(large)[0].mono.bytes, std::uint64_t{8} << 20);
  EXPECT_EQ(model::address_map(chip())[0].mono.bytes, std::uint64_t{1} << 20);
}

}  // namespace widths_test
