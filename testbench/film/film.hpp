#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Number of samples that a film refused, by cause (the first that applies, in this order).
struct RejectedSamples {
  std::uint64_t not_finite = 0;
  std::uint64_t negative = 0;
  std::uint64_t too_large =
      0;  ///< a channel above Film::max_radiance(), or a pixel already holds Film::kMaxSamples
};

/// Numbers of samples over the pixels of a film.
struct PixelSamples {
  std::uint64_t fewest = 0;  ///< of a pixel
  std::uint64_t most = 0;
  double mean = 0;
  int pixels_without = 0;
};

/// What a film keeps of each pixel's samples besides their number.
enum class FilmSums : std::uint8_t {
  means,                ///< 56 bytes a pixel
  means_and_variances,  ///< 104 bytes a pixel
};

/// Sums radiance samples in exact integer arithmetic, so the result depends neither on their order nor on how
/// they were distributed over films that are merged later. Pixels are numbered row by row from the top left.
///
/// Number format: a channel's sum is a multiple of scale * 2^-74, its sum of squares a multiple of scale^2 *
/// 2^-54; a sample's bits below that are cut off. Both hold 2^32 samples of 2^20 * scale (126 bits) without
/// overflow. One film belongs to one thread; merge() joins them.
class Film {
 public:
  static constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 32;

  /// `scale` is a power of two near the scene's largest emission, 2^-300 .. 2^300 (see film_scale()).
  /// Throws std::invalid_argument for any other scale or an empty size, RunError if there is no memory.
  Film(FilmSize size, double scale, FilmSums sums = FilmSums::means_and_variances);

  /// Adds a sample of linear RGB radiance. Returns false, and counts the sample in rejected() instead, if a
  /// channel is not finite, negative or above max_radiance(). `pixel` must be in [0, pixel_count())
  /// (std::out_of_range).
  bool add(int pixel, const glm::dvec3& radiance);

  /// Adds light that is no sample of the pixel's own: what a light path brings to it, over the number of
  /// pixels. Each sample of any pixel has a light path, and any of them may bring light here: so splats are
  /// divided by samples_for_each_pixel(), and a pixel's mean is that of its samples plus that of its splats.
  /// Else as add().
  bool add_splat(int pixel, const glm::dvec3& radiance);

  /// Prefetches the pixel for add(). A film is larger than the caches of the x86, and paths end in no order
  /// of pixels, so callers announce samples in advance. With prefetch(), both functions take 4 % of a render;
  /// without it, add() alone takes 6.5 %.
  void prefetch(int pixel) const {
    prefetch(sums_.data() + pixel);
    if (keeps_variances()) prefetch(squares_.data() + pixel);
  }

  /// Adds all samples of a film of the same size, scale and sums (else std::invalid_argument). Throws
  /// std::overflow_error, with this film unchanged, if a pixel would hold more than kMaxSamples.
  void merge(const Film& other);

  /// All samples as bytes that from_bytes() of the same build reads, to send a film to another process.
  std::string bytes() const;
  /// Throws std::invalid_argument when `bytes` are not those of a film of this size.
  static Film from_bytes(FilmSize size, double scale, FilmSums sums, const std::string& bytes);

  FilmSize size() const { return size_; }
  int pixel_count() const { return size_.width * size_.height; }
  double scale() const { return scale_; }
  double max_radiance() const { return max_radiance_; }

  std::uint64_t sample_count(int pixel) const { return at(pixel).samples; }
  PixelSamples samples() const;
  /// Samples of all pixels over the number of pixels.
  double samples_for_each_pixel() const { return double(all_samples_) / double(pixel_count()); }
  /// Mean radiance; 0 for a pixel without samples.
  glm::dvec3 mean(int pixel) const;
  bool keeps_variances() const { return !squares_.empty(); }
  /// Unbiased estimate of the variance of mean(): sample variance / samples, and that of splats. 0 with fewer
  /// than two samples. Throws std::logic_error if there are more and the film keeps no variances.
  glm::dvec3 variance_of_mean(int pixel) const;
  /// The part of variance_of_mean() that is of splats. Each is one of many rare events, so it is the sum of
  /// their squares / samples_for_each_pixel()^2.
  glm::dvec3 variance_of_splats(int pixel) const;

  const RejectedSamples& rejected() const { return rejected_; }
  std::uint64_t rejected_samples() const;

  /// Means, 3 * pixel_count() values: R, G, B of each pixel, row by row, the top row first.
  std::vector<double> rgb() const;
  /// SHA-256 (64 hexadecimal digits) over the little-endian IEEE-754 bits of rgb().
  std::string sha256() const;

 private:
  // ISO C++17 has no 128-bit integer; __extension__ keeps -Wpedantic quiet about the compiler's own.
  __extension__ typedef unsigned __int128 UInt128;  // NOLINT(modernize-use-using)

  // On 8 bytes instead of 16, so that no pixel holds padding.
  struct __attribute__((packed, aligned(8))) Sums {
    UInt128 sum[3] = {0, 0, 0};
    std::uint64_t samples = 0;
  };
  /// Sums of squares, apart from the sums: films that keep no variances have none.
  struct __attribute__((packed, aligned(8))) Squares {
    UInt128 sum[3] = {0, 0, 0};
  };

  template <class Element>
  static void prefetch(const Element* element) {
    const char* const address = reinterpret_cast<const char*>(element);
    __builtin_prefetch(address, 1);
    __builtin_prefetch(address + sizeof(Element) - 1, 1);
  }
  static UInt128 to_fixed_point(double value, double units);
  const Sums& at(int pixel) const { return sums_.at(static_cast<std::size_t>(pixel)); }
  bool has_splats() const { return !splats_.empty(); }
  bool fits(const glm::dvec3& radiance) const;
  void add_to(Squares& squares, const glm::dvec3& radiance) const;
  void take_splats();
  void reject(const glm::dvec3& radiance);
  std::size_t byte_count() const;  ///< of bytes(): all sums, what was rejected, and whether there are splats

  FilmSize size_;
  double scale_;
  double max_radiance_;
  int sum_quantum_exponent_;     ///< the unit of Sums::sum is 2^this
  int square_quantum_exponent_;  ///< the unit of Squares::sum is 2^this
  double sum_units_;             ///< 2^-63 / (unit of Sums::sum)
  double square_units_;          ///< 2^-63 / (unit of Squares::sum)
  std::vector<Sums> sums_;
  std::uint64_t all_samples_ = 0;  ///< of all pixels
  std::vector<Squares> squares_;   ///< empty if no variances are kept
  // Of splats; empty until there is one.
  std::vector<Squares> splats_;         ///< sums in the unit of Sums::sum
  std::vector<Squares> splat_squares_;  ///< empty if no variances are kept
  RejectedSamples rejected_;
};

/// The scale for a film of this scene: the smallest power of two not below its largest emission, the largest
/// radiance of its environment and what its lights without area make of surfaces near them, within 2^-300 ..
/// 2^300. So dim and bright scenes keep as many bits.
double film_scale(const Scene& scene);

}  // namespace testbench
