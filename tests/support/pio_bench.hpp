#pragma once

#include <memory>
#include <string>

#include "model/clear_connect.hpp"
#include "model/dma_engine.hpp"
#include "model/mono_ddr.hpp"
#include "model/poly_sram.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"
#include "tests/support/tlm_testers.hpp"

namespace test_support {

inline constexpr int kPes = 8;
inline const cn::LaneMask kAll = cn::LaneMask::first(kPes);

inline model::ChipConfig chip_with(model::PioArbitration arbitration) {
  auto config = test_chip(kPes);
  config.pio.arbitration = arbitration;
  return config;
}

/// PIO engine, network, SRAM and a memory, driven by the test in the place of the control unit.
class PioBench : public SystemCFixture {
 protected:
  void build(const model::ChipConfig& chip) {
    prepare(chip);
    ddr = std::make_unique<model::MonoDdr>("ddr", chip, clock);
    network->ddr_socket.bind(ddr->socket);
    elaborate();
  }
  /// With a memory of another make in the place of MonoDdr.
  void build_with_minimal_memory(const model::ChipConfig& chip, double latency_nanoseconds) {
    prepare(chip);
    minimal = std::make_unique<MinimalMemory>("minimal", chip.ddr.size_bytes,
                                              sc_core::sc_time(latency_nanoseconds, sc_core::SC_NS));
    network->ddr_socket.bind(minimal->socket);
    elaborate();
  }

  std::uint8_t* mono() { return minimal ? minimal->bytes.data() : ddr->memory().data(); }
  std::uint64_t& mono_word(std::uint64_t address) {
    return *reinterpret_cast<std::uint64_t*>(mono() + address);
  }

  /// Every word of mono memory and of the SRAMs holds something of its own.
  void fill_memories(std::uint64_t mono_bytes) {
    for (std::uint64_t address = 0; address < mono_bytes; address += 8)
      mono_word(address) = 0xd000000 + address;
    const auto words = std::size_t(poly->num_pes()) * 128;
    for (std::size_t i = 0; i < words; ++i) poly->words()[i] = 0x5000000 + i;
  }
  std::uint64_t poly_word(int pe, int offset) const { return poly->row(offset)[pe]; }

  static cn::Transfer read(const cn::MonoPlaces& from, int bytes, const cn::LaneMask& enabled,
                           int semaphore = 0) {
    return {cn::Direction::mono_to_poly, {0, bytes}, from, enabled, {semaphore}};
  }
  static cn::Transfer write(const cn::MonoPlaces& to, int bytes, const cn::LaneMask& enabled,
                            int semaphore = 0) {
    return {cn::Direction::poly_to_mono, {0, bytes}, to, enabled, {semaphore}};
  }
  /// Contiguous, 8 x 32 bytes: 100 setup + 8 x (10 + 4) = 212 cycles in the engine.
  model::Cycles enqueue_read(model::Cycles now, int semaphore) {
    return engine->enqueue(read(cn::MonoPlaces::array(0, 32), 32, kAll, semaphore), now);
  }
  model::Cycles enqueue_write(model::Cycles now, int semaphore) {
    return engine->enqueue(write(cn::MonoPlaces::array(0, 32), 32, kAll, semaphore), now);
  }
  void serve_all() {
    while (engine->serve_next()) {
    }
  }
  /// The only signal of a semaphore so far; serves what waits.
  model::Cycles signal(int semaphore = 0) {
    serve_all();
    EXPECT_EQ(semaphores.signals[semaphore].size(), 1u) << "semaphore " << semaphore;
    return semaphores.signals[semaphore].empty() ? 0 : semaphores.signals[semaphore].back();
  }

  model::ClockDomain clock{1e9};
  std::unique_ptr<cn::PolyMemory> poly;
  std::unique_ptr<model::DmaEngine> engine;
  std::unique_ptr<model::PolySram> sram;
  std::unique_ptr<model::ClearConnect> network;
  std::unique_ptr<model::MonoDdr> ddr;
  std::unique_ptr<MinimalMemory> minimal;
  SignalRecorder semaphores{"semaphores"};
  TestInitiator control{"control"};
  TestInitiator host{"host"};

 private:
  void prepare(const model::ChipConfig& chip) {
    poly = std::make_unique<cn::PolyMemory>(chip.chip.pes, chip.poly.sram_bytes);
    engine = std::make_unique<model::DmaEngine>("engine", chip, clock, *poly);
    sram = std::make_unique<model::PolySram>("sram", chip, *poly);
    network = std::make_unique<model::ClearConnect>("network", chip, clock);
    engine->semaphores.bind(semaphores);
    engine->mono_socket.bind(network->pio_socket);
    engine->poly_socket.bind(sram->pio_socket);
    control.socket.bind(network->control_socket);
    host.socket.bind(network->host_socket);
  }
};

}  // namespace test_support
