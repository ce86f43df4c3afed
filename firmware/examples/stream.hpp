#pragma once

#include "firmware/cn/machine.hpp"
#include "firmware/examples/kernels.hpp"

namespace examples {

/// Computes y = factor y + x for long arrays, `steps` times: the more steps, the more there is to compute for
/// each word moved. run_alone() waits for each copy. run_with_threads() has one hardware thread for loads and
/// one for saves; the same plain code in each of the three threads overlaps copies and computation. The
/// results are the same.
class Stream {
 public:
  struct Problem {
    cn::MonoPointer<double> x;  ///< `blocks` x `elements` for each PE, one after the other
    cn::MonoPointer<double> y;  ///< as many; is overwritten
    double factor = 0;
    int steps = 0;
    int blocks = 0;
    int elements = 0;  ///< elements of a PE in a block, a multiple of 4
  };

  /// Throws cn::PolyMemoryOverflow, or cn::MachineFault for another number of elements.
  Stream(cn::Machine& machine, const Kernels& kernels, const Problem& problem);

  void run_alone();
  /// Takes two more threads, above the calling one. Throws cn::MachineFault if the machine has too few.
  void run_with_threads();

 private:
  /// One buffer is computed, one is saved and one loaded. With two buffers, a buffer whose save ends during a
  /// kernel would be loaded only after it, because threads change between kernels.
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
  cn::Semaphore loaded_, saved_;                 ///< signalled by copies
  cn::Semaphore empty_, full_, computed_, end_;  ///< signalled by threads
};

}  // namespace examples
