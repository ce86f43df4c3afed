// A CSX600 beside a foreign initiator: the DMA of a camera writes pictures into one of two buffers while the
// chip adds up the other.

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/tlm_quantumkeeper.h>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "model/config/chip_presets.hpp"
#include "model/csx600.hpp"
#include "shared_memory.hpp"

namespace {

constexpr int kPictures = 16;
constexpr std::uint64_t kPictureBytes = 192 << 10;
constexpr std::uint64_t kBurstBytes = 256;
constexpr int kBytesPerPe = 512;
constexpr double kMemoryBytesPerSecond = 1.6e9;
constexpr double kCameraBytesPerSecond = 0.4e9;

// Semaphores that the firmware allocates first, so that both sides know their numbers.
constexpr cn::Semaphore kFilled{0};
constexpr cn::Semaphore kEmpty{1};

cn::MonoAddress buffer_of(int picture) {
  return std::uint64_t(picture % 2) * kPictureBytes;
}

std::uint64_t pixel_sum(int picture) {
  return std::uint64_t(picture + 1) * (kPictureBytes / 8);
}

/// Loosely timed, with the quantum keeper of TLM-2.0.
class Camera : public sc_core::sc_module {
 public:
  tlm_utils::simple_initiator_socket<Camera> socket{"socket"};

  Camera(const sc_core::sc_module_name& name, model::ControlUnit& chip) : sc_module(name), chip_(chip) {
    chip_.host_semaphores().share(kFilled);
    chip_.host_semaphores().share(kEmpty);
    SC_HAS_PROCESS(Camera);
    SC_THREAD(run);
  }
  int pictures_written() const { return pictures_written_; }

 private:
  void run() {
    chip_.start();
    keeper_.reset();
    for (int picture = 0; picture < kPictures; ++picture) {
      if (picture >= 2) {
        keeper_.sync();
        while (!chip_.host_semaphores().try_wait(kEmpty)) wait(chip_.host_semaphores().firmware_signalled());
        keeper_.reset();
      }
      write(picture);
      keeper_.sync();
      chip_.host_semaphores().signal(kFilled);
      ++pictures_written_;
    }
  }

  /// A picture whose every 8 bytes hold its number, counted from 1. The sensor does not wait: bursts leave at
  /// its pace, and the picture is there when the memory has taken the last.
  void write(int picture) {
    std::vector<std::uint64_t> burst(kBurstBytes / 8, std::uint64_t(picture + 1));
    sc_core::sc_time taken;  ///< from the present on
    for (std::uint64_t done = 0; done < kPictureBytes; done += kBurstBytes) {
      tlm::tlm_generic_payload payload;
      payload.set_command(tlm::TLM_WRITE_COMMAND);
      payload.set_address(buffer_of(picture) + done);
      payload.set_data_ptr(reinterpret_cast<unsigned char*>(burst.data()));
      payload.set_data_length(kBurstBytes);
      payload.set_streaming_width(kBurstBytes);
      sc_core::sc_time delay = keeper_.get_local_time();
      socket->b_transport(payload, delay);
      if (payload.is_response_error())
        throw std::runtime_error(std::string(name()) + ": " + payload.get_response_string());
      taken = delay;
      keeper_.inc(sc_core::sc_time(double(kBurstBytes) / kCameraBytesPerSecond, sc_core::SC_SEC));
      if (keeper_.need_sync()) {
        taken -= std::min(taken, keeper_.get_local_time());
        keeper_.sync();
      }
    }
    keeper_.set(std::max(taken, keeper_.get_local_time()));
  }

  model::ControlUnit& chip_;
  tlm_utils::tlm_quantumkeeper keeper_;
  int pictures_written_ = 0;
};

/// Firmware: adds up the 8-byte words of each picture. Its arithmetic runs on the control unit, so that the
/// example needs no kernels.
void add_up(cn::Machine& machine, std::vector<std::uint64_t>& sums) {
  const cn::Semaphore filled = machine.allocate_semaphore("filled");
  const cn::Semaphore empty = machine.allocate_semaphore("empty");
  const cn::Semaphore loaded = machine.allocate_semaphore("loaded");
  const cn::PolySpan piece = machine.poly_memory().allocate("piece", kBytesPerPe);
  const int pes = machine.num_pes();
  const std::uint64_t block_bytes = std::uint64_t(pes) * kBytesPerPe;
  for (int picture = 0; picture < kPictures; ++picture) {
    machine.sem_wait(filled);
    std::uint64_t sum = 0;
    for (std::uint64_t done = 0; done < kPictureBytes; done += block_bytes) {
      machine.async_copy_m2p(loaded, piece, cn::MonoPlaces::array(buffer_of(picture) + done, kBytesPerPe),
                             cn::LaneMask::first(pes));
      machine.sem_wait(loaded);
      for (int pe = 0; pe < pes; ++pe)
        for (int byte = 0; byte < kBytesPerPe; byte += 8)
          sum += machine.poly_memory().word(pe, piece.offset_bytes + byte);
      machine.issue_mono(200);
    }
    sums.push_back(sum);
    machine.sem_signal(empty);
  }
}

void run(model::TimingStyle timing) {
  model::ChipConfig config = model::preset("csx600");
  config.ddr.size_bytes = 1 << 20;
  examples::SharedMemory memory("memory", 2, config.ddr.size_bytes, kMemoryBytesPerSecond,
                                sc_core::sc_time(60, sc_core::SC_NS));
  model::Csx600 chip("chip", config, timing, model::MonoMemory::bound_outside);
  Camera camera("camera", chip.control_unit);
  chip.clear_connect.ddr_socket.bind(memory.sockets[0]);
  camera.socket.bind(memory.sockets[1]);
  std::vector<std::uint64_t> sums;
  chip.control_unit.load([&](cn::Machine& machine) { add_up(machine, sums); });
  sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
  chip.control_unit.require_finished();
  for (int picture = 0; picture < kPictures; ++picture)
    if (sums.at(std::size_t(picture)) != pixel_sum(picture))
      throw std::runtime_error("picture " + std::to_string(picture) + ": found the sum " +
                               std::to_string(sums[std::size_t(picture)]) + ", expected " +
                               std::to_string(pixel_sum(picture)));
  const model::ControlStatistics& statistics = chip.control_unit.statistics();
  std::printf("%d pictures, %llu cycles, of which %llu waiting for the camera; memory busy %.1f %%\n",
              camera.pictures_written(), static_cast<unsigned long long>(statistics.total()),
              static_cast<unsigned long long>(statistics[model::CycleCause::wait_host]),
              100 * (memory.busy() / sc_core::sc_time_stamp()));
}

}  // namespace

int sc_main(int argc, char** argv) {
  model::TimingStyle timing = model::TimingStyle::loosely_timed;
  for (int i = 1; i < argc; ++i) {
    char* end = nullptr;
    const double quantum_nanoseconds = std::strtod(argv[i], &end);
    if (std::string(argv[i]) == "--at") {
      timing = model::TimingStyle::approximately_timed;
    } else if (end != argv[i] && *end == 0 && quantum_nanoseconds >= 0 && quantum_nanoseconds <= 1e9) {
      tlm::tlm_global_quantum::instance().set(sc_core::sc_time(quantum_nanoseconds, sc_core::SC_NS));
    } else {
      std::fprintf(stderr, "foreign_initiator: found '%s'; allowed: --at, or a quantum of 0 to 1e9 ns\n",
                   argv[i]);
      return 2;
    }
  }
  try {
    run(timing);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "foreign_initiator: %s\n", error.what());
    return 1;
  }
}
