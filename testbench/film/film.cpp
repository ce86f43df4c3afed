#include "testbench/film/film.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "model/memory/huge_pages.hpp"
#include "testbench/mono_image/emitter.hpp"
#include "testbench/system/digest.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/memory.hpp"

namespace testbench {
namespace {

/// Squares of the smallest sample and sums of the largest squares stay within a double's range.
constexpr int kMaxScaleExponent = 300;
constexpr int kLargestSampleExponent = 20;  ///< a sample may be 2^this times the scale
// 32 bits of samples + 20 (40 for squares) bits of range + 74 (54) bits of fraction = 126 bits.
constexpr int kSumFractionBits = 74;
constexpr int kSquareFractionBits = 54;

// Not in ISO C++17. Its 113-bit mantissa keeps a small variance beside a large mean from being cancelled.
__extension__ typedef __float128 Float128;  // NOLINT(modernize-use-using)

/// The exponent e of scale = 2^e. Throws std::invalid_argument for any other scale.
int exponent_of(double scale) {
  int exponent = 0;
  const double mantissa = std::frexp(scale, &exponent);
  if (mantissa != 0.5 || std::abs(exponent - 1) > kMaxScaleExponent) {
    throw std::invalid_argument("film scale " + std::to_string(scale) +
                                " is not a power of two from 2^-300 to 2^300");
  }
  return exponent - 1;
}

std::size_t checked_pixels(FilmSize size) {
  if (size.width < 1 || size.height < 1) throw std::invalid_argument("film size must be 1x1 or more");
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

double from_float128(Float128 value, int exponent) {
  return std::ldexp(static_cast<double>(value), exponent);
}

/// Takes the memory of all pixels at once.
template <class Element>
void allocate(std::vector<Element>& elements, std::size_t pixels) {
  elements.reserve(pixels);
  model::prefer_huge_pages(elements.data(), elements.capacity() * sizeof(Element));
  elements.resize(pixels);
}

template <class Element>
char* put_bytes(const std::vector<Element>& elements, char* to) {
  static_assert(std::is_trivially_copyable_v<Element>);
  if (!elements.empty()) std::memcpy(to, elements.data(), elements.size() * sizeof(Element));
  return to + elements.size() * sizeof(Element);
}

template <class Element>
const char* get_bytes(std::vector<Element>& elements, const char* from) {
  if (!elements.empty()) std::memcpy(elements.data(), from, elements.size() * sizeof(Element));
  return from + elements.size() * sizeof(Element);
}

}  // namespace

Film::Film(FilmSize size, double scale, FilmSums sums)
    : size_(size),
      scale_(scale),
      max_radiance_(std::ldexp(scale, kLargestSampleExponent)),
      sum_quantum_exponent_(exponent_of(scale) - kSumFractionBits),
      square_quantum_exponent_(2 * exponent_of(scale) - kSquareFractionBits),
      sum_units_(std::ldexp(1.0, -sum_quantum_exponent_ - 63)),
      square_units_(std::ldexp(1.0, -square_quantum_exponent_ - 63)) {
  const std::size_t pixels = checked_pixels(size);
  const bool with_variances = sums == FilmSums::means_and_variances;
  require_memory(pixels * (sizeof(Sums) + (with_variances ? sizeof(Squares) : 0)),
                 "a film of " + std::to_string(size.width) + "x" + std::to_string(size.height) + " pixels");
  allocate(sums_, pixels);
  if (with_variances) allocate(squares_, pixels);
}

/// floor(value * units * 2^63), exact: `units` is a power of two and value * units is below 2^31.
Film::UInt128 Film::to_fixed_point(double value, double units) {
  const double scaled = value * units;
  const auto high = static_cast<std::int64_t>(scaled);
  const auto low = static_cast<std::int64_t>((scaled - static_cast<double>(high)) * 0x1p63);
  // Converts by way of 64 unsigned bits: neither half is negative, so sign extension is not needed.
  return (UInt128{static_cast<std::uint64_t>(high)} << 63) + static_cast<std::uint64_t>(low);
}

bool Film::fits(const glm::dvec3& radiance) const {
  const auto in_range = [this](double value) {
    return value >= 0.0 && value <= max_radiance_;  // false for NaN
  };
  return in_range(radiance.x) && in_range(radiance.y) && in_range(radiance.z);
}

void Film::add_to(Squares& squares, const glm::dvec3& radiance) const {
  for (int channel = 0; channel < 3; ++channel)
    squares.sum[channel] += to_fixed_point(radiance[channel] * radiance[channel], square_units_);
}

bool Film::add(int pixel_index, const glm::dvec3& radiance) {
  Sums& pixel = sums_.at(static_cast<std::size_t>(pixel_index));
  if (!fits(radiance) || pixel.samples == kMaxSamples) {
    reject(radiance);
    return false;
  }
  for (int channel = 0; channel < 3; ++channel)
    pixel.sum[channel] += to_fixed_point(radiance[channel], sum_units_);
  ++pixel.samples;
  ++all_samples_;
  if (!keeps_variances()) return true;
  add_to(squares_[static_cast<std::size_t>(pixel_index)], radiance);
  return true;
}

bool Film::add_splat(int pixel_index, const glm::dvec3& radiance) {
  const auto place = static_cast<std::size_t>(pixel_index);
  if (!fits(radiance)) {
    reject(radiance);
    return false;
  }
  take_splats();
  Squares& pixel = splats_.at(place);
  for (int channel = 0; channel < 3; ++channel)
    pixel.sum[channel] += to_fixed_point(radiance[channel], sum_units_);
  if (keeps_variances()) add_to(splat_squares_[place], radiance);
  return true;
}

void Film::take_splats() {
  if (has_splats()) return;
  const std::size_t bytes = sums_.size() * sizeof(Squares) * (keeps_variances() ? 2 : 1);
  require_memory(bytes, "the light that light paths bring to a film of " + std::to_string(size_.width) + "x" +
                            std::to_string(size_.height) + " pixels");
  allocate(splats_, sums_.size());
  if (keeps_variances()) allocate(splat_squares_, sums_.size());
}

void Film::reject(const glm::dvec3& radiance) {
  const auto any = [&radiance](auto is_bad) {
    return is_bad(radiance.x) || is_bad(radiance.y) || is_bad(radiance.z);
  };
  if (any([](double value) { return !std::isfinite(value); })) {
    ++rejected_.not_finite;
  } else if (any([](double value) { return value < 0.0; })) {
    ++rejected_.negative;
  } else {
    ++rejected_.too_large;
  }
}

void Film::merge(const Film& other) {
  if (other.size_.width != size_.width || other.size_.height != size_.height || other.scale_ != scale_ ||
      other.keeps_variances() != keeps_variances()) {
    throw std::invalid_argument("only films of the same size, scale and sums can be merged");
  }
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (sums_[i].samples + other.sums_[i].samples > kMaxSamples) {
      throw std::overflow_error("pixel " + std::to_string(i) + " would hold more than 2^32 samples");
    }
  }
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) sums_[i].sum[channel] += other.sums_[i].sum[channel];
    sums_[i].samples += other.sums_[i].samples;
  }
  all_samples_ += other.all_samples_;
  if (other.has_splats()) take_splats();
  const auto add_all = [](std::vector<Squares>& to, const std::vector<Squares>& from) {
    for (std::size_t i = 0; i < from.size(); ++i)
      for (int channel = 0; channel < 3; ++channel) to[i].sum[channel] += from[i].sum[channel];
  };
  add_all(squares_, other.squares_);
  add_all(splats_, other.splats_);
  add_all(splat_squares_, other.splat_squares_);
  rejected_.not_finite += other.rejected_.not_finite;
  rejected_.negative += other.rejected_.negative;
  rejected_.too_large += other.rejected_.too_large;
}

std::string Film::bytes() const {
  static_assert(std::is_trivially_copyable_v<RejectedSamples>);
  std::string result(byte_count(), '\0');
  char* const behind_samples = put_bytes(squares_, put_bytes(sums_, result.data()));
  std::memcpy(put_bytes(splat_squares_, put_bytes(splats_, behind_samples)), &rejected_, sizeof(rejected_));
  result.back() = has_splats();
  return result;
}

Film Film::from_bytes(FilmSize size, double scale, FilmSums sums, const std::string& bytes) {
  Film film(size, scale, sums);
  if (!bytes.empty() && bytes.back() != 0) film.take_splats();
  if (bytes.size() != film.byte_count())
    throw std::invalid_argument("these bytes are not a film of that size and sums");
  const char* const behind_samples = get_bytes(film.squares_, get_bytes(film.sums_, bytes.data()));
  const char* const behind_pixels = get_bytes(film.splat_squares_, get_bytes(film.splats_, behind_samples));
  std::memcpy(&film.rejected_, behind_pixels, sizeof(film.rejected_));
  for (const Sums& pixel : film.sums_) film.all_samples_ += pixel.samples;
  return film;
}

std::size_t Film::byte_count() const {
  return sums_.size() * sizeof(Sums) +
         (squares_.size() + splats_.size() + splat_squares_.size()) * sizeof(Squares) + sizeof(rejected_) + 1;
}

glm::dvec3 Film::mean(int pixel_index) const {
  const Sums& pixel = at(pixel_index);
  if (pixel.samples == 0) return glm::dvec3(0.0);
  glm::dvec3 result;
  for (int channel = 0; channel < 3; ++channel) {
    auto sum = static_cast<Float128>(pixel.sum[channel]);
    // What the splats would be of as many light paths as the pixel has samples: exact where all pixels have
    // as many.
    if (has_splats())
      sum += static_cast<Float128>(splats_[static_cast<std::size_t>(pixel_index)].sum[channel]) *
             (static_cast<Float128>(pixel.samples) * static_cast<Float128>(sums_.size()) /
              static_cast<Float128>(all_samples_));
    const Float128 quotient = sum / static_cast<Float128>(pixel.samples);
    result[channel] = from_float128(quotient, sum_quantum_exponent_);
  }
  return result;
}

glm::dvec3 Film::variance_of_mean(int pixel_index) const {
  const Sums& pixel = at(pixel_index);
  if (pixel.samples < 2) return glm::dvec3(0.0);
  if (!keeps_variances()) throw std::logic_error("this film keeps no variances");
  const auto samples = static_cast<Float128>(pixel.samples);
  // Shifts the squared sum to the unit of the sum of squares.
  const int shift = 2 * sum_quantum_exponent_ - square_quantum_exponent_;
  const auto sum_to_square_quanta = static_cast<Float128>(std::ldexp(1.0, shift));
  const Squares& squares_of_pixel = squares_[static_cast<std::size_t>(pixel_index)];
  glm::dvec3 result;
  for (int channel = 0; channel < 3; ++channel) {
    const auto sum = static_cast<Float128>(pixel.sum[channel]);
    const auto squares = static_cast<Float128>(squares_of_pixel.sum[channel]);
    const Float128 deviation = squares - sum * sum * sum_to_square_quanta / samples;
    const Float128 variance = deviation / (samples - 1) / samples;
    result[channel] = std::max(
        0.0, from_float128(variance, square_quantum_exponent_));  // truncated bits may make it negative
  }
  return result + variance_of_splats(pixel_index);
}

glm::dvec3 Film::variance_of_splats(int pixel_index) const {
  glm::dvec3 result(0.0);
  if (splat_squares_.empty() || all_samples_ == 0) return result;
  const Squares& squares = splat_squares_.at(static_cast<std::size_t>(pixel_index));
  const Float128 samples = static_cast<Float128>(all_samples_) / static_cast<Float128>(sums_.size());
  for (int channel = 0; channel < 3; ++channel)
    result[channel] = from_float128(static_cast<Float128>(squares.sum[channel]) / samples / samples,
                                    square_quantum_exponent_);
  return result;
}

std::uint64_t Film::rejected_samples() const {
  return rejected_.not_finite + rejected_.negative + rejected_.too_large;
}

PixelSamples Film::samples() const {
  PixelSamples found{sums_.front().samples, 0, 0, 0};
  for (const Sums& pixel : sums_) {
    found.fewest = std::min(found.fewest, pixel.samples);
    found.most = std::max(found.most, pixel.samples);
    found.mean += double(pixel.samples);
    if (pixel.samples == 0) ++found.pixels_without;
  }
  found.mean /= double(sums_.size());
  return found;
}

std::vector<double> Film::rgb() const {
  std::vector<double> result;
  result.reserve(3 * sums_.size());
  for (int pixel = 0; pixel < pixel_count(); ++pixel) {
    const glm::dvec3 value = mean(pixel);
    result.insert(result.end(), {value.x, value.y, value.z});
  }
  return result;
}

std::string Film::sha256() const {
  Sha256 digest;
  std::string bytes;
  for (int pixel = 0; pixel < pixel_count(); ++pixel) {
    const glm::dvec3 value = mean(pixel);
    for (int channel = 0; channel < 3; ++channel) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &value[channel], sizeof bits);
      for (int shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<char>(bits >> shift));
    }
    if ((pixel + 1) % size_.width != 0) continue;
    digest.add(bytes);
    bytes.clear();
  }
  return digest.finish();
}

namespace {

double largest_channel(const glm::dvec3& colour) {
  return std::max({colour.x, colour.y, colour.z});
}

/// The radiance of what a light without area lights strongly: a surface at a sixteenth of the scene's radius
/// from a point, or one that faces a sun. A sun's disk may be 2^20 times as bright.
double radiance_by(const Light& light, double radius) {
  const bool is_near = light.kind == LightKind::point || light.kind == LightKind::spot;
  const double distance = radius / 16.0;
  return largest_channel(light.intensity) / (is_near ? distance * distance : 1.0);
}

double largest_radiance(const Environment& environment) {
  if (!environment.image) return largest_channel(environment.constant);
  const std::vector<float>& rgb = environment.image->rgb;
  return environment.scale * double(*std::max_element(rgb.begin(), rgb.end()));
}

}  // namespace

double film_scale(const Scene& scene) {
  double largest = std::max(0.0, largest_radiance(scene.environment));
  if (!scene.lights.empty()) {
    const double radius = surroundings_of(scene).radius;
    for (const Light& light : scene.lights) largest = std::max(largest, radiance_by(light, radius));
  }
  for (const Material& material : scene.materials) {
    for (int channel = 0; channel < 3; ++channel) largest = std::max(largest, material.emission[channel]);
  }
  double scale = std::ldexp(1.0, -kMaxScaleExponent);
  while (scale < largest && scale < std::ldexp(1.0, kMaxScaleExponent)) scale *= 2.0;
  return scale;
}

}  // namespace testbench
