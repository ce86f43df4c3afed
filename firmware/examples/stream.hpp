#pragma once

#include "firmware/cn/machine.hpp"
#include "firmware/examples/kernels.hpp"

namespace examples {

/// y = factor y + x for long arrays, `steps` times: the more steps, the more there is to compute for what is
/// moved. Alone it waits for each copy; with a hardware thread that loads and one that saves, the same plain
/// code in each of the three overlaps copies and computation. The results are the same.
class Stream {
 public:
  struct Problem {
    cn::MonoPointer<double> x;  ///< `blocks` x `elements` for each PE, one after the other
    cn::MonoPointer<double> y;  ///< as many; is overwritten
    double factor = 0;
    int steps = 0;
    int blocks = 0;
    int elements = 0;  ///< of a PE in a block, a multiple of 4
  };

  /// Throws cn::PolyMemoryOverflow, or cn::MachineFault for another number of elements.
  Stream(cn::Machine& machine, const Kernels& kernels, const Problem& problem);

  void run_alone();
  /// Takes two more threads, above the calling one. Throws cn::MachineFault if the machine has too few.
  void run_with_threads();

 private:
  /// One is computed, one is saved and one loaded. With two, the one whose save ends amid a kernel would be
  /// loaded after it: threads change between kernels.
  static constexpr int kBuffers = 3;

  void load(int block);
  void compute(int block);
  void save(int block);
  cn::MonoPlaces places(cn::MonoPointer<double> array, int block) const;

  cn::Machine& machine_;
  const Kernels& kernels_;
  Problem problem_;
  cn::LaneMask all_;
  cn::PolySpan x_[kBuffers];
  cn::PolySpan y_[kBuffers];
  cn::Semaphore loaded_, saved_;                 ///< a copy is over
  cn::Semaphore empty_, full_, computed_, end_;  ///< from thread to thread
};

}  // namespace examples
