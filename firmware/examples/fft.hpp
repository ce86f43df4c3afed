#pragma once

#include "firmware/cn/machine.hpp"
#include "firmware/examples/kernels.hpp"

namespace examples {

inline constexpr int kFftSize = 512;  ///< complex numbers in a line, and lines in an image
inline constexpr int kIndexBits = 8;
inline constexpr int kComplexPerPe = 1 << kIndexBits;  ///< half a line
inline constexpr int kScratchComplex = kComplexPerPe / 2;
inline constexpr int kGroupBits = 5;  ///< PEs work in groups of 32 on 16 lines
inline constexpr int kPieceBytes = kComplexPerPe * int{sizeof(Complex)};
inline constexpr int kLineBytes = 2 * kPieceBytes;
inline constexpr int kTileRowBytes = (1 << kGroupBits) * kPieceBytes;
inline constexpr std::uint64_t kImageBytes = std::uint64_t(kFftSize) * kLineBytes;

/// Two-dimensional FFT of 512 x 512 complex numbers in single precision, image after image.
///
/// Mono memory and its bus are the bottleneck, so each pass moves whole pieces of 2 KiB: the first transforms
/// rows and saves tiles of 16 rows x 16 columns, the second loads the 32 tiles of 16 columns. Between lines
/// and tiles, data change PEs over the PE-to-PE path. The result is transposed: line v, column u holds
/// sum of image[y][x] exp(-2 pi i (u y + v x) / 512).
class Fft {
 public:
  struct Layout {
    cn::MonoPointer<Complex> images;
    cn::MonoPointer<Complex> tiles;
    cn::MonoPointer<Complex> results;
    cn::MonoPointer<Complex> twiddles;  ///< exp(-2 pi i k / 512), k = 0..255
    int count = 0;  ///< number of images, at least 2: one is read while another is written
  };

  /// `machine` has a multiple of 32 PEs. Throws cn::MachineFault, cn::PolyMemoryOverflow.
  Fft(cn::Machine& machine, const Kernels& kernels, const Layout& layout);

  void run();

 private:
  /// `pass` 0 transforms rows, 1 columns; a batch is as many groups of lines as the array has room for.
  struct Step {
    int pass;
    int image;
    int batch;
  };

  int groups() const { return machine_.num_pes() >> kGroupBits; }
  int batches() const { return ((1 << kGroupBits) + groups() - 1) / groups(); }
  int steps() const { return 2 * layout_.count * batches(); }
  Step step(int number) const;
  cn::LaneMask enabled(const Step& step) const;
  void load(int number);
  void save(int number);
  void transform(int number);
  void exchange(int number);
  FftArguments arguments(int number);

  cn::Machine& machine_;
  const Kernels& kernels_;
  Layout layout_;
  cn::PolySpan buffer_[2];
  cn::PolySpan scratch_;
  FftPlacesArguments places_;
  cn::Semaphore loaded_;
  cn::Semaphore saved_;
};

}  // namespace examples
