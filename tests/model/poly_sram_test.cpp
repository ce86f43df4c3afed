#include "model/pe_array/poly_sram.hpp"

#include "model/transaction/pe_addresses.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"
#include "tests/support/tlm_testers.hpp"

namespace poly_sram_test {

using cn::Direction;
using sc_core::SC_NS;
using sc_core::sc_time;

class PolySram : public test_support::SystemCFixture {
 protected:
  PolySram() {
    pio.socket.bind(sram.pio_socket);
    elaborate();
  }

  sc_time book(Direction direction, int offset, int bytes, const cn::MonoPlaces& places, int pes,
               bool consolidate = false) {
    model::PeAddresses addresses;
    addresses.pieces.describe({direction, {offset, bytes}, places, cn::LaneMask::first(pes), {0}}, 8,
                              {model::Divisor(64), consolidate});
    pio.transaction.set_extension(&addresses);
    const sc_time end = pio.send(tlm::TLM_IGNORE_COMMAND, std::uint64_t(offset), word, 8, sc_time(50, SC_NS));
    pio.transaction.clear_extension(&addresses);
    return end;
  }

  model::ChipConfig config = [] {
    auto chip = test_support::test_chip();
    chip.pio.stolen_sram_cycles = 2;
    return chip;
  }();
  cn::PolyMemory memory{8, 1024};
  model::PolySram sram{"sram", config, memory};
  test_support::TestInitiator pio{"pio"};
  unsigned char word[8] = {};
};

TEST_F(PolySram, BooksWordsOfAllPesWithoutDelay) {
  EXPECT_EQ(book(Direction::mono_to_poly, 0, 80, cn::MonoPlaces::array(0, 80), 8), sc_time(50, SC_NS));
  EXPECT_EQ(pio.transaction.get_response_status(), tlm::TLM_OK_RESPONSE);
  book(Direction::poly_to_mono, 80, 24, cn::MonoPlaces::array(0, 80), 3);
  EXPECT_EQ(sram.statistics().words_in, 80u);
  EXPECT_EQ(sram.statistics().words_out, 9u);
  EXPECT_EQ(sram.statistics().port_cycles, 178u);
}

TEST_F(PolySram, BroadcastTakesThePortsOnce) {
  book(Direction::mono_to_poly, 0, 80, cn::MonoPlaces::array(0, 0), 8, true);
  EXPECT_EQ(sram.statistics().words_in, 80u);
  EXPECT_EQ(sram.statistics().port_cycles, 20u);
}

TEST_F(PolySram, PeakOutlivesTheBuffers) {
  memory.allocate("a", 200);
  memory.allocate("b", 100);
  EXPECT_EQ(sram.bytes_in_use(), 304);  // in 8-byte words
  book(Direction::mono_to_poly, 0, 8, cn::MonoPlaces::array(0, 8), 1);
  memory.free_all();
  memory.allocate("c", 64);
  EXPECT_EQ(sram.bytes_in_use(), 64);
  EXPECT_EQ(sram.statistics().peak_bytes, 304);
}

TEST_F(PolySram, OffsetsOutsideTheSramAreAddressErrors) {
  book(Direction::mono_to_poly, 1016, 8, cn::MonoPlaces::array(0, 8), 1);
  EXPECT_EQ(pio.transaction.get_response_status(), tlm::TLM_OK_RESPONSE);
  book(Direction::mono_to_poly, 1016, 16, cn::MonoPlaces::array(0, 16), 1);
  EXPECT_EQ(pio.transaction.get_response_status(), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(sram.statistics().words_in, 1u);
}

TEST_F(PolySram, PlainReadsAndWritesAreCommandErrors) {
  pio.send(tlm::TLM_READ_COMMAND, 0, word, 8, sc_core::SC_ZERO_TIME);
  EXPECT_EQ(pio.transaction.get_response_status(), tlm::TLM_COMMAND_ERROR_RESPONSE);
  pio.send(tlm::TLM_IGNORE_COMMAND, 0, word, 8, sc_core::SC_ZERO_TIME);
  EXPECT_EQ(pio.transaction.get_response_status(), tlm::TLM_COMMAND_ERROR_RESPONSE);
}

}  // namespace poly_sram_test
