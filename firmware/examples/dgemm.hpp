#pragma once

#include "firmware/cn/machine.hpp"
#include "firmware/examples/kernels.hpp"

namespace examples {

/// C = A B in double precision, all in mono memory in blocks, as a BLAS packs them.
///
/// Each PE keeps two rows of a block of C in its SRAM, and `depth` columns of the same rows of A. The rows of
/// B travel down the PE-to-PE path, four elements to a vector: each passes all PEs and is loaded from mono
/// memory only once for a block of C. The path is a line without a link from its end to its start, so PE p is
/// p rows of B ahead of PE 0: it takes them in the order p, p + 1, ..., K - 1, 0, ..., p - 1, its columns of
/// A are packed in that order, and it sums in that order. A vector that has not passed all PEs when the panel
/// ends waits in SRAM.
///
/// The last kFeeders PEs compute nothing: they hold the rows of B that follow, where the others hold C.
///
/// Cycles of one row of B and one tile of C (2 x 4), of which the 8 products and sums are the work:
///
///     multiply-adds   2 vectors of 4                                           8
///     path            1 vector of 4 by one step, overlaps with nothing         4
///     feeding         every 8 rows a load that is enabled in the feeders       1/4
///     loads           A 2 doubles, 4; feeders 1: beside the multiply-adds      0
///
/// and once a tile and panel 26 to store C (16) and B (8) under an enable bit (2). With depth d that is 8 d /
/// (12.25 d + 26) of the peak, in 88 of 96 PEs: 0.58 for d = 64.
///
/// Programmed I/O takes a cycle a word from loads and stores, which fill 0.45 of these cycles. For a row of B
/// it moves N + 2 x 88 words (N = 4 x tiles), which is 0.66 a cycle, and that leaves 0.58 / (1 + 0.66 x 0.45)
/// = 0.45. Larger N moves less, but SRAM bounds it: 764 doubles hold 2 N of C, N of B and, as A is loaded a
/// panel ahead, 4 d of A. Loading takes 0.8 of the time that multiplying takes.
class Dgemm {
 public:
  static constexpr int kRows = 2;         ///< rows of C in a PE
  static constexpr int kTileColumns = 4;  ///< columns of C in a vector
  static constexpr int kFeeders = 8;      ///< PEs that feed the path

  struct Shape {
    int tiles = 40;       ///< in a PE's block of C, of 4 columns each
    int depth = 64;       ///< depth of a panel, a multiple of kFeeders
    int chunk_tiles = 5;  ///< tiles for which B is loaded at a time; divides `tiles`
  };
  struct Problem {
    Shape shape;
    int row_blocks = 1;  ///< blocks of 2 rows x (num_pes - kFeeders)
    int column_blocks = 1;
    int panels = 1;                    ///< K = panels x depth
    cn::MonoPointer<double> a;         ///< [row block][panel][PE][k][row], from the PE's own k on
    cn::MonoPointer<double> b_start;   ///< [column block][PE][tile][column]: row PE % K of B
    cn::MonoPointer<double> b_stream;  ///< [column block][panel][chunk][feeder][tile][k / kFeeders][column]
    cn::MonoPointer<double> c;         ///< [row block][column block][PE][tile][row][column]
  };

  /// Throws cn::MachineFault, cn::PolyMemoryOverflow.
  Dgemm(cn::Machine& machine, const Kernels& kernels, const Problem& problem);

  void run();

 private:
  /// One step of the multiplication.
  struct Step {
    int row_block;
    int column_block;
    int panel;
    int chunk;
  };

  int computing_pes() const { return machine_.num_pes() - kFeeders; }
  int chunks() const { return problem_.shape.tiles / problem_.shape.chunk_tiles; }
  int steps() const { return problem_.row_blocks * problem_.column_blocks * problem_.panels * chunks(); }
  int panel_number(int step) const { return step / chunks(); }
  Step step(int number) const;
  cn::PolySpan fed(int number) const;
  void load_a(int panel_number, int part);
  void load_b_start(const Step& at);
  void load_b_stream(int number);
  void multiply(int number);
  void save_c(const Step& at);

  cn::Machine& machine_;
  const Kernels& kernels_;
  Problem problem_;
  cn::PolySpan c_;
  cn::PolySpan b_;
  cn::PolySpan a_[2];
  cn::Semaphore a_loaded_;
  cn::Semaphore b_loaded_;
  cn::Semaphore fed_;
  cn::Semaphore saved_;
};

}  // namespace examples
