#pragma once

#include <functional>
#include <memory>
#include <string>

#include "model/config/timing_style.hpp"
#include "model/memory/mono_ddr.hpp"
#include "model/network/clear_connect.hpp"
#include "model/pe_array/poly_sram.hpp"
#include "model/pio/pio_engine.hpp"
#include "model/time/event_queue.hpp"
#include "tests/support/protocol_checker.hpp"
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

/// The process of a test's body, because an approximately timed unit lets time pass in its calls.
class Driver : public sc_core::sc_module {
 public:
  explicit Driver(const sc_core::sc_module_name& name) : sc_module(name) {
    SC_HAS_PROCESS(Driver);
    SC_THREAD(run);
  }
  std::function<void()> body;

 private:
  void run() {
    if (body) body();
  }
};

/// PIO engine, network, SRAM and a memory. The test drives them in place of the control unit.
class PioBench : public SystemCFixture {
 protected:
  void build(const model::ChipConfig& chip) {
    build_unelaborated(chip);
    elaborate();
  }
  /// For tests whose body is run(), which makes the same calls in either style.
  void build(const model::ChipConfig& chip, model::TimingStyle style) {
    if (style == model::TimingStyle::approximately_timed)
      event_queue = std::make_unique<model::EventQueue>("event_queue", clock);
    build_unelaborated(chip);
  }
  void build_unelaborated(const model::ChipConfig& chip) {
    prepare(chip);
    ddr = std::make_unique<model::MonoDdr>("ddr", chip, clock, event_queue.get());
    network->ddr_socket.bind(at_memory.in);
    at_memory.out.bind(ddr->socket);
  }
  /// Runs `body` in a process until no events are left.
  void run(std::function<void()> body) {
    driver.body = std::move(body);
    sc_core::sc_start();
    EXPECT_EQ(at_engine.violations(), std::vector<std::string>{});
    EXPECT_EQ(at_memory.violations(), std::vector<std::string>{});
    EXPECT_EQ(at_engine.active(), 0u);
    EXPECT_EQ(at_memory.active(), 0u);
  }
  /// A bench with another memory in place of MonoDdr.
  void build_with_minimal_memory(const model::ChipConfig& chip, double latency_nanoseconds) {
    prepare(chip);
    minimal = std::make_unique<MinimalMemory>("minimal", chip.ddr.size_bytes,
                                              sc_core::sc_time(latency_nanoseconds, sc_core::SC_NS));
    network->ddr_socket.bind(at_memory.in);
    at_memory.out.bind(minimal->socket);
    elaborate();
  }

  std::uint8_t* mono() { return minimal ? minimal->bytes.data() : ddr->memory().data(); }
  std::uint64_t& mono_word(std::uint64_t address) {
    return *reinterpret_cast<std::uint64_t*>(mono() + address);
  }

  /// Gives every word of mono memory and of the SRAMs a value of its own.
  void fill_memories(std::uint64_t mono_bytes) {
    for (std::uint64_t address = 0; address < mono_bytes; address += 8)
      mono_word(address) = 0xd000000 + address;
    std::uint64_t number = 0x5000000;
    for (int offset_bytes = 0; offset_bytes < 1024; offset_bytes += 8)
      for (int pe = 0; pe < poly->num_pes(); ++pe) poly->word(pe, offset_bytes) = number++;
  }
  std::uint64_t poly_word(int pe, int offset) const { return poly->word(pe, offset); }

  static cn::Transfer read(const cn::MonoPlaces& from, int bytes, const cn::LaneMask& enabled,
                           int semaphore = 0) {
    return {cn::Direction::mono_to_poly, {0, bytes}, from, enabled, {semaphore}};
  }
  static cn::Transfer write(const cn::MonoPlaces& to, int bytes, const cn::LaneMask& enabled,
                            int semaphore = 0) {
    return {cn::Direction::poly_to_mono, {0, bytes}, to, enabled, {semaphore}};
  }
  /// A contiguous transfer of 8 x 32 bytes: 100 setup + 8 x (10 + 4) = 212 cycles in the engine.
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
  /// Serves all queued requests and returns the cycle of the semaphore's only signal so far.
  model::Cycles signal(int semaphore = 0) {
    serve_all();
    EXPECT_EQ(semaphores.signals[semaphore].size(), 1u) << "semaphore " << semaphore;
    return semaphores.signals[semaphore].empty() ? 0 : semaphores.signals[semaphore].back();
  }

  void prepare(const model::ChipConfig& chip) {
    poly = std::make_unique<cn::PolyMemory>(chip.chip.pes, chip.poly.sram_bytes);
    engine = std::make_unique<model::PioEngine>("engine", chip, clock, *poly, event_queue.get());
    sram = std::make_unique<model::PolySram>("sram", chip, *poly);
    network = std::make_unique<model::ClearConnect>("network", chip, clock, event_queue.get());
    engine->semaphores.bind(semaphores);
    engine->mono_socket.bind(at_engine.in);
    at_engine.out.bind(network->pio_socket);
    engine->poly_socket.bind(sram->pio_socket);
    control.socket.bind(network->control_socket);
    host.socket.bind(network->host_socket);
  }

  model::ClockDomain clock{1e9};
  std::unique_ptr<model::EventQueue> event_queue;
  ProtocolChecker at_engine{"at_engine"};  ///< between engine and network
  ProtocolChecker at_memory{"at_memory"};  ///< between network and memory
  Driver driver{"driver"};
  std::unique_ptr<cn::PolyMemory> poly;
  std::unique_ptr<model::PioEngine> engine;
  std::unique_ptr<model::PolySram> sram;
  std::unique_ptr<model::ClearConnect> network;
  std::unique_ptr<model::MonoDdr> ddr;
  std::unique_ptr<MinimalMemory> minimal;
  SignalRecorder semaphores{"semaphores"};
  TestInitiator control{"control"};
  TestInitiator host{"host"};
};

}  // namespace test_support
