#include "tests/support/checked_firmware.hpp"

#include <array>
#include <cstring>
#include <deque>

#include "testbench/film.hpp"
#include "testbench/mono_image.hpp"
#include "testbench/results.hpp"
#include "tests/support/hazards.hpp"
#include "tests/support/scenes.hpp"

namespace test_support {
namespace {

using path_tracer::HostSemaphores;

class BrokenMachine : public testbench::NativeMachine {
 public:
  BrokenMachine(int num_pes, std::uint64_t mono_bytes, int dropped_wait)
      : NativeMachine(num_pes, kPolyBytes, mono_bytes), dropped_wait_(dropped_wait) {}

  void sem_wait(cn::Semaphore semaphore) override {
    const bool for_transfer = semaphore.index > HostSemaphores::kResultsFree.index;
    if (for_transfer && note_wait(waits_[std::size_t(semaphore.index)]) && next_wait_++ == dropped_wait_)
      return;
    NativeMachine::sem_wait(semaphore);
  }
  void timed(bool on) override {
    timed_ = on;
    NativeMachine::timed(on);
  }
  const std::vector<int>& needed_waits() const { return needed_waits_; }

 protected:
  void start_transfer(const cn::Transfer& transfer) override {
    waits_[std::size_t(transfer.done.index)].moves_data.push_back(transfer.enabled.any());
    NativeMachine::start_transfer(transfer);
  }

 private:
  static constexpr int kPolyBytes = 16384;  // eight buffers of one stage need more than the CSX600's 6 KiB

  struct Waits {
    std::deque<bool> moves_data;  ///< a transfer that was not waited for; signals come in their order
    std::vector<int> perhaps_needed;
  };

  /// Whether it counts.
  bool note_wait(Waits& waits) {
    if (waits.moves_data.empty()) return false;  // the machine stops it
    const bool moved_data = waits.moves_data.front();
    waits.moves_data.pop_front();
    if (!timed_) return false;
    waits.perhaps_needed.push_back(next_wait_);
    if (!moved_data) return true;
    needed_waits_.insert(needed_waits_.end(), waits.perhaps_needed.begin(), waits.perhaps_needed.end());
    waits.perhaps_needed.clear();
    return true;
  }

  int dropped_wait_;
  int next_wait_ = 0;
  std::array<Waits, kSemaphores> waits_;
  std::vector<int> needed_waits_;
  bool timed_ = true;
};

}  // namespace

CheckedRun run_checked(const testbench::Scene& scene, const path_tracer::ProgramConfig& config, int num_pes,
                       int samples, const Mutation& mutation) {
  testbench::MonoImage image = testbench::make_mono_image(scene, num_pes, config);
  mutation.layout(image.layout);
  BrokenMachine machine(num_pes, image.layout.total_bytes, mutation.dropped_wait);
  std::memcpy(machine.mono(), image.bytes.data(), image.bytes.size());

  model::HazardChecker checker(machine);
  for (const path_tracer::Layout::Region& region : image.layout.regions)
    checker.name_mono(region.name, {region.first, region.bytes});
  machine.set_access_observer(&checker);

  testbench::Film film(scene.film, testbench::film_scale(scene));
  testbench::ResultReader results(image.layout, film);
  machine.on_signal(HostSemaphores::kResultsReady, [&] {
    results.fetch([&](cn::MonoAddress from, void* to, std::size_t bytes) {
      checker.host_touches_mono(cn::Access::read, {from, bytes});
      std::memcpy(to, machine.mono() + from, bytes);
    });
    machine.sem_signal(HostSemaphores::kResultsFree);
  });
  CheckedRun run;
  run.fault = fault_of([&] {
    path_tracer::PathTracer tracer(machine, path_tracer::observed_kernels(), config, image.layout,
                                   {0, samples});
    tracer.run({});
    checker.firmware_ends();
  });
  run.waits = machine.needed_waits();
  run.requests = checker.requests();
  return run;
}

testbench::Scene small_scene() {
  return closed_cube(0.8, 1.0, {6, 4});
}

testbench::Scene open_scene() {
  return triangle_soup(20, 3, {9, 7});
}

}  // namespace test_support
