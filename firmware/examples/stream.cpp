#include "firmware/examples/stream.hpp"

#include "firmware/examples/mono_cost.hpp"

namespace examples {
namespace {

constexpr int kAbove = cn::kFirstThreadPriority + 1;

}  // namespace

Stream::Stream(cn::Machine& machine, const Kernels& kernels, const Problem& problem)
    : machine_(machine), kernels_(kernels), problem_(problem), all_(cn::LaneMask::first(machine.num_pes())) {
  if (problem.elements < 4 || problem.elements % 4 != 0)
    throw cn::MachineFault("stream elements: found " + std::to_string(problem.elements) +
                           ", allowed is a positive multiple of 4");
  const int bytes = problem.elements * static_cast<int>(sizeof(double));
  for (cn::PolySpan& x : x_) x = machine.poly_memory().allocate("x", bytes);
  for (cn::PolySpan& y : y_) y = machine.poly_memory().allocate("y", bytes);
  loaded_ = machine.allocate_semaphore("loaded");
  saved_ = machine.allocate_semaphore("saved");
  empty_ = machine.allocate_semaphore("buffer empty");
  full_ = machine.allocate_semaphore("buffer full");
  computed_ = machine.allocate_semaphore("computed");
  end_ = machine.allocate_semaphore("all saved");
}

void Stream::run_alone() {
  for (int block = 0; block < problem_.blocks; ++block) {
    load(block);
    compute(block);
    save(block);
  }
}

void Stream::run_with_threads() {
  for (int i = 0; i < kBuffers; ++i) machine_.sem_signal(empty_);
  machine_.start_thread(kAbove, "loads", [this] {
    for (int block = 0; block < problem_.blocks; ++block) {
      machine_.sem_wait(empty_);
      load(block);
      machine_.sem_signal(full_);
    }
  });
  machine_.start_thread(kAbove, "saves", [this] {
    for (int block = 0; block < problem_.blocks; ++block) {
      machine_.sem_wait(computed_);
      save(block);
      machine_.sem_signal(empty_);
    }
    machine_.sem_signal(end_);
  });
  for (int block = 0; block < problem_.blocks; ++block) {
    machine_.sem_wait(full_);
    compute(block);
    machine_.sem_signal(computed_);
  }
  machine_.sem_wait(end_);
}

void Stream::load(int block) {
  for (const auto& [to, from] :
       {std::pair{x_[block % kBuffers], problem_.x}, {y_[block % kBuffers], problem_.y}}) {
    machine_.issue_mono(kRequestInstructions);
    machine_.async_copy_m2p(loaded_, to, places(from, block), all_);
  }
  for (int copy = 0; copy < 2; ++copy) machine_.sem_wait(loaded_);
}

void Stream::compute(int block) {
  const ScaleAndAddArguments arguments{PolyArray<double>(x_[block % kBuffers]),
                                       PolyArray<double>(y_[block % kBuffers]), problem_.factor,
                                       problem_.steps, problem_.elements};
  machine_.run(kernels_.scale_and_add, arguments, all_);
}

void Stream::save(int block) {
  machine_.issue_mono(kRequestInstructions);
  machine_.async_copy_p2m(saved_, places(problem_.y, block), y_[block % kBuffers], all_);
  machine_.sem_wait(saved_);
}

cn::MonoPlaces Stream::places(cn::MonoPointer<double> array, int block) const {
  const auto elements = std::uint64_t(problem_.elements);
  const auto first = std::uint64_t(block) * std::uint64_t(machine_.num_pes()) * elements;
  return cn::MonoPlaces::array((array + first).address, elements * sizeof(double));
}

}  // namespace examples
