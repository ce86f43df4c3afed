#pragma once

#include "firmware/cn/machine.hpp"
#include "firmware/examples/kernels.hpp"

namespace examples {

/// C = A B in double precision, both in mono memory in blocks, as a BLAS packs them.
///
/// Each PE keeps a block of `rows` x `columns` of C in its SRAM. Step by step it gets `depth` columns of its
/// own rows of A by programmed I/O, loaded one step ahead, and all PEs are broadcast the same rows of B,
/// which the control unit reads through its data cache. So every element of A and B crosses the bus once for
/// a block of C.
class Dgemm {
 public:
  /// Of a PE's blocks. Bounds: C and two blocks of A in 6 KiB, a block of B in the 4 KiB data cache. More
  /// rows make more of each element of B, which the control unit waits for; more columns more of each of A.
  struct Shape {
    int rows = 16;     ///< a multiple of 4
    int columns = 30;  ///< a multiple of 3
    int depth = 8;
  };
  struct Problem {
    Shape shape;
    int row_blocks = 1;  ///< of num_pes x rows
    int column_blocks = 1;
    int depth_blocks = 1;
    cn::MonoPointer<double> a;  ///< [row block][depth block][PE][depth][row]
    cn::MonoPointer<double> b;  ///< [column block][depth block][depth][column]
    cn::MonoPointer<double> c;  ///< [row block][column block][PE][column][row]
  };

  /// Throws cn::MachineFault, cn::PolyMemoryOverflow.
  Dgemm(cn::Machine& machine, const Kernels& kernels, const Problem& problem);

  void run();

 private:
  struct Step {
    int row_block;
    int column_block;
    int depth_block;
  };

  int steps() const { return problem_.row_blocks * problem_.column_blocks * problem_.depth_blocks; }
  Step step(int number) const;
  void load_a(int number);
  void multiply(int number);
  void save_c(const Step& at);

  cn::Machine& machine_;
  const Kernels& kernels_;
  Problem problem_;
  cn::PolySpan c_;
  cn::PolySpan a_[2];
  cn::Semaphore loaded_;
  cn::Semaphore saved_;
  cn::LaneMask all_;
};

}  // namespace examples
