// A chip in a platform of its own that runs a firmware plug-in, or a copy of its own where none is named. An
// observer sees each request of programmed I/O.

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "firmware/plug_in/firmware.hpp"
#include "model/config/chip_presets.hpp"
#include "model/csx600.hpp"
#include "plug_in.hpp"

namespace {

/// Copies `from` to `to`, a block of one piece a PE at a time.
class Copy : public plug_in::Firmware {
 public:
  Copy() : Firmware("copy", "copies blocks through the PEs") {}

  void prepare(int num_pes) override {
    from_.resize(std::size_t(num_pes) * kBytesPerPe * kBlocks);
    to_.resize(from_.size());
    for (std::size_t i = 0; i < from_.size(); ++i) from_[i] = std::uint8_t(i * 2654435761u >> 24);
  }
  void run(cn::Machine& machine) override {
    const cn::PolySpan piece = machine.poly_memory().allocate("piece", kBytesPerPe);
    const cn::Semaphore moved = machine.allocate_semaphore("moved");
    const cn::LaneMask all = cn::LaneMask::first(machine.num_pes());
    for (std::size_t block = 0; block < kBlocks; ++block) {
      const std::size_t first = block * std::size_t(machine.num_pes()) * kBytesPerPe;
      machine.async_copy_m2p(moved, piece, from_.places(first, kBytesPerPe), all);
      machine.sem_wait(moved);
      machine.async_copy_p2m(moved, to_.places(first, kBytesPerPe), piece, all);
      machine.sem_wait(moved);
    }
  }
  void check() const override {
    for (std::size_t i = 0; i < from_.size(); ++i)
      if (to_[i] != from_[i]) throw plug_in::CheckFailed("byte " + std::to_string(i) + " differs");
  }

 private:
  static constexpr int kBytesPerPe = 256;
  static constexpr std::size_t kBlocks = 4;
  plug_in::MonoBuffer<std::uint8_t> from_{*this, "from", plug_in::Use::upload};
  plug_in::MonoBuffer<std::uint8_t> to_{*this, "to", plug_in::Use::download};
};

/// Prints each request when its times are known.
class RequestPrinter : public model::PioObserver {
 public:
  void started(const model::PioEvent&) override {}
  void finished(const model::PioEvent& request) override {
    std::printf("request %4llu  %s  %7llu bytes of %4d PEs  queued %9llu  started %9llu  finished %9llu\n",
                static_cast<unsigned long long>(request.id),
                request.direction == cn::Direction::mono_to_poly ? "load" : "save",
                static_cast<unsigned long long>(request.bytes), request.pes,
                static_cast<unsigned long long>(request.enqueued),
                static_cast<unsigned long long>(request.started),
                static_cast<unsigned long long>(request.finished));
  }
};

/// The host's side of a run: uploads, starts the firmware, downloads.
class Host : public sc_core::sc_module {
 public:
  Host(const sc_core::sc_module_name& name, model::Csx600& chip, plug_in::Firmware& firmware)
      : sc_module(name), chip_(chip), firmware_(firmware) {
    SC_HAS_PROCESS(Host);
    SC_THREAD(run);
  }

 private:
  void run() {
    for (plug_in::MonoBufferBase* const buffer : firmware_.buffers())
      if (buffer->is_uploaded())
        wait_until(
            chip_.host_link.upload(buffer->address(), buffer->host_bytes(), buffer->size_bytes(), now()));
    chip_.control_unit.start();
    if (!chip_.control_unit.finished()) wait(chip_.control_unit.finished_event());
    for (plug_in::MonoBufferBase* const buffer : firmware_.buffers())
      if (buffer->is_downloaded())
        wait_until(
            chip_.host_link.download(buffer->address(), buffer->host_bytes(), buffer->size_bytes(), now()));
  }
  model::Cycles now() const { return chip_.clock.cycle_at(sc_core::sc_time_stamp()); }
  void wait_until(model::Cycles cycle) {
    const sc_core::sc_time target = chip_.clock.time_at(cycle);
    if (target > sc_core::sc_time_stamp()) wait(target - sc_core::sc_time_stamp());
  }

  model::Csx600& chip_;
  plug_in::Firmware& firmware_;
};

/// Buffers lie one behind the other, each from a multiple of 256 bytes on.
void place_buffers(const plug_in::Firmware& firmware) {
  cn::MonoAddress next = 0;
  for (plug_in::MonoBufferBase* const buffer : firmware.buffers()) {
    buffer->place_at(next);
    next += (buffer->size_bytes() + 255) / 256 * 256;
  }
}

void run(model::TimingStyle timing, plug_in::Firmware& firmware) {
  model::Csx600 chip("chip", model::preset("csx600"), timing);
  firmware.prepare(chip.config().chip.pes);
  place_buffers(firmware);
  RequestPrinter printer;
  chip.pio_engine.set_observer(&printer);
  const Host host("host", chip, firmware);
  chip.control_unit.load([&](cn::Machine& machine) { firmware.run(machine); });
  sc_core::sc_start(sc_core::sc_time(10, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
  chip.control_unit.require_finished();
  firmware.check();
  std::printf("%s: %llu cycles, the result is right\n", firmware.name().c_str(),
              static_cast<unsigned long long>(chip.control_unit.statistics().total()));
}

}  // namespace

int sc_main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  model::TimingStyle timing = model::TimingStyle::loosely_timed;
  if (!words.empty() && words.front() == "--at") {
    timing = model::TimingStyle::approximately_timed;
    words.erase(words.begin());
  }
  std::unique_ptr<plug_in::Firmware> firmware;
  try {
    firmware = words.empty() ? std::make_unique<Copy>() : examples::load_plug_in(words.front());
    for (std::size_t i = 1; i < words.size(); ++i) examples::set_option(*firmware, words[i]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "request_observer: %s\n", error.what());
    return 2;
  }
  try {
    run(timing, *firmware);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "request_observer: %s\n", error.what());
    return 1;
  }
}
