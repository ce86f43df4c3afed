// Two CSX600 that share a memory. Each copies its half of it, alone and then both at once; an observer counts
// what goes through the memory's port.

#include <array>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>

#include "model/config/chip_presets.hpp"
#include "model/csx600.hpp"
#include "shared_memory.hpp"

namespace {

constexpr std::uint64_t kRegionBytes = 1 << 20;  ///< that a chip copies
constexpr int kBytesPerPe = 512;
constexpr double kMemoryBytesPerSecond = 1.6e9;
const sc_core::sc_time kMemoryLatency(60, sc_core::SC_NS);

/// Firmware: copies kRegionBytes from `from` to `to` through the PEs, with two buffers.
void copy(cn::Machine& machine, cn::MonoAddress from, cn::MonoAddress to) {
  const std::array<cn::PolySpan, 2> buffers = {machine.poly_memory().allocate("even", kBytesPerPe),
                                               machine.poly_memory().allocate("odd", kBytesPerPe)};
  const cn::Semaphore loaded = machine.allocate_semaphore("loaded");
  const cn::Semaphore saved = machine.allocate_semaphore("saved");
  const int pes = machine.num_pes();
  const std::uint64_t block_bytes = std::uint64_t(pes) * kBytesPerPe;
  for (std::uint64_t done = 0, block = 0; done < kRegionBytes; done += block_bytes, ++block) {
    const int pes_left =
        int(std::min<std::uint64_t>(std::uint64_t(pes), (kRegionBytes - done) / kBytesPerPe));
    const cn::LaneMask enabled = cn::LaneMask::first(pes_left);
    if (block >= 2) machine.sem_wait(saved);  // the buffer is free again
    machine.async_copy_m2p(loaded, buffers[block % 2], cn::MonoPlaces::array(from + done, kBytesPerPe),
                           enabled);
    machine.sem_wait(loaded);
    machine.async_copy_p2m(saved, cn::MonoPlaces::array(to + done, kBytesPerPe), buffers[block % 2], enabled);
  }
  for (int save = 0; save < 2; ++save) machine.sem_wait(saved);
}

/// Two chips at one memory.
class Platform {
 public:
  explicit Platform(model::TimingStyle timing)
      : config_(config()),
        memory_("memory", 2, config_.ddr.size_bytes, kMemoryBytesPerSecond, kMemoryLatency),
        left_("left", config_, timing, model::MonoMemory::bound_outside),
        right_("right", config_, timing, model::MonoMemory::bound_outside) {
    for (std::size_t i = 0; i < chips_.size(); ++i) {
      chips_[i]->clear_connect.ddr_socket.bind(memory_.sockets[i]);
      chips_[i]->control_unit.load([i](cn::Machine& machine) { copy(machine, source(i), target(i)); });
    }
    memory_.set_observer([this](const examples::SharedMemory::Access& access) {
      bytes_[std::size_t(access.initiator)] += access.bytes;
    });
    for (std::uint64_t i = 0; i < 2 * kRegionBytes; ++i)
      memory_.data()[i] = std::uint8_t(i * 2654435761u >> 24);
  }

  /// Runs the chips of which `takes_part` says so. Throws std::runtime_error if a copy is wrong.
  void run(const std::string& what, const std::array<bool, 2>& takes_part) {
    for (std::size_t i = 0; i < chips_.size(); ++i) std::memset(memory_.data() + target(i), 0, kRegionBytes);
    bytes_ = {};
    for (std::size_t i = 0; i < chips_.size(); ++i)
      if (takes_part[i]) chips_[i]->control_unit.start();
    sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
    for (std::size_t i = 0; i < chips_.size(); ++i)
      if (takes_part[i]) report(what, i);
  }

 private:
  static model::ChipConfig config() {
    model::ChipConfig config = model::preset("csx600");
    config.ddr.size_bytes = 4 * kRegionBytes;
    return config;
  }
  static cn::MonoAddress source(std::size_t chip) { return chip * kRegionBytes; }
  static cn::MonoAddress target(std::size_t chip) { return (2 + chip) * kRegionBytes; }

  void report(const std::string& what, std::size_t i) {
    model::Csx600& chip = *chips_[i];
    chip.control_unit.require_finished();
    if (std::memcmp(memory_.data() + source(i), memory_.data() + target(i), kRegionBytes) != 0)
      throw std::runtime_error(std::string(chip.name()) + ": the copy differs from the original");
    const double seconds = chip.clock.time_at(chip.control_unit.statistics().total()).to_seconds();
    std::printf("%-5s %-5s %7llu cycles, %7llu bytes through the memory's port, %.2f GB/s\n", what.c_str(),
                chip.name(), static_cast<unsigned long long>(chip.control_unit.statistics().total()),
                static_cast<unsigned long long>(bytes_[i]), double(bytes_[i]) / seconds / 1e9);
  }

  model::ChipConfig config_;
  examples::SharedMemory memory_;
  model::Csx600 left_;
  model::Csx600 right_;
  std::array<model::Csx600*, 2> chips_{&left_, &right_};
  std::array<std::uint64_t, 2> bytes_{};  ///< by chip, as the observer saw them
};

}  // namespace

int sc_main(int argc, char** argv) {
  const bool approximately_timed = argc == 2 && std::string(argv[1]) == "--at";
  if (argc > 1 && !approximately_timed) {
    std::fprintf(stderr, "two_chips: found '%s'; allowed: --at or nothing\n", argv[1]);
    return 2;
  }
  try {
    Platform platform(approximately_timed ? model::TimingStyle::approximately_timed
                                          : model::TimingStyle::loosely_timed);
    platform.run("alone", {true, false});
    platform.run("both", {true, true});
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "two_chips: %s\n", error.what());
    return 1;
  }
}
