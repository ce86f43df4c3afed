#include <array>
#include <cmath>
#include <complex>

#include "firmware/examples/fft.hpp"
#include "firmware/examples/firmwares.hpp"
#include "firmware/plug_in/random.hpp"

namespace examples {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint64_t kSize = kFftSize;
constexpr std::uint64_t kPixels = kSize * kSize;
constexpr std::uint64_t kOutputs = 24;  ///< of each image, compared with the sum that defines them
/// Outputs have a magnitude of about 400; rounding in 18 stages of single precision leaves a relative error
/// of 1e-6.
constexpr double kTolerance = 5e-3;

/// The pixel of all images, by its number.
Complex pixel(std::uint64_t number) {
  const auto part = [](std::uint64_t index) { return float(2 * plug_in::random_of(index) - 1); };
  return {part(2 * number), part(2 * number + 1)};
}

std::complex<double> to_double(const Complex& a) {
  return {a.real, a.imaginary};
}

std::complex<double> root(std::uint64_t k) {
  return std::polar(1.0, -2 * kPi * double(k) / kFftSize);
}

class FftFirmware : public plug_in::Firmware {
 public:
  FftFirmware(const Kernels& kernels, int images)
      : Firmware("FFT", "transforms of 512 x 512 complex numbers in single precision"),
        kernels_(kernels),
        count_{*this, "images", images, {2, 64}, "number of images"} {
    for (std::size_t k = 0; k < kSize; ++k) root_[k] = root(k);
  }

  void prepare(int num_pes) override;
  void run(cn::Machine& machine) override {
    Fft(machine, kernels_, {images_.mono(), tiles_.mono(), results_.mono(), twiddles_.mono(), count_}).run();
  }
  void check() const override {
    for (std::uint64_t image = 0; image < std::uint64_t(count_); ++image) check_image(image);
  }
  plug_in::Work work() const override {
    return {count_ * 5 * double(kPixels) * std::log2(double(kPixels)), "floating-point operations"};
  }

 private:
  void check_image(std::uint64_t image) const;
  void check_energy(std::uint64_t image) const;
  std::complex<double> output(std::uint64_t image, std::uint64_t u, std::uint64_t v) const;

  const Kernels& kernels_;
  std::array<std::complex<double>, kSize> root_;
  plug_in::Option<int> count_;
  plug_in::MonoBuffer<Complex> images_{*this, "images", plug_in::Use::upload};
  plug_in::MonoBuffer<Complex> tiles_{*this, "tiles", plug_in::Use::scratch};
  plug_in::MonoBuffer<Complex> results_{*this, "results", plug_in::Use::download};
  plug_in::MonoBuffer<Complex> twiddles_{*this, "twiddles", plug_in::Use::upload};
  plug_in::Counter largest_error_{*this, "largest_error", "-", "of the outputs that were compared"};
};

void FftFirmware::prepare(int num_pes) {
  constexpr int kPesPerGroup = 1 << kGroupBits;
  if (num_pes % kPesPerGroup != 0)
    throw plug_in::OptionError("found " + std::to_string(num_pes) + " PEs, allowed is a multiple of " +
                               std::to_string(kPesPerGroup));
  const std::uint64_t pixels = kPixels * std::uint64_t(count_);
  for (plug_in::MonoBuffer<Complex>* const buffer : {&images_, &tiles_, &results_}) buffer->resize(pixels);
  for (std::uint64_t number = 0; number < pixels; ++number) images_[number] = pixel(number);
  twiddles_.resize(kComplexPerPe);
  for (std::size_t k = 0; k < kComplexPerPe; ++k)
    twiddles_[k] = {float(root_[k].real()), float(root_[k].imag())};
}

void FftFirmware::check_image(std::uint64_t image) const {
  check_energy(image);
  for (std::uint64_t i = 0; i < kOutputs; ++i) {
    const std::uint64_t u = (i * 197 + image * 31 + 3) % kSize;
    const std::uint64_t v = (i * 331 + image * 17 + 5) % kSize;
    const double error = std::abs(to_double(results_[(image * kSize + v) * kSize + u]) - output(image, u, v));
    largest_error_.set(std::max(largest_error_.value(), error));
    if (!(error <= kTolerance))
      throw plug_in::CheckFailed("output (" + std::to_string(u) + ", " + std::to_string(v) + ") of image " +
                                 std::to_string(image) + " is off by " + std::to_string(error));
  }
}

void FftFirmware::check_energy(std::uint64_t image) const {
  double before = 0;
  double after = 0;
  for (std::uint64_t i = image * kPixels; i < (image + 1) * kPixels; ++i) {
    before += std::norm(to_double(pixel(i)));
    after += std::norm(to_double(results_[i]));
  }
  const double ratio = after / (before * double(kPixels));
  if (!(std::abs(ratio - 1) <= 1e-6))
    throw plug_in::CheckFailed("energy of image " + std::to_string(image) + " changed by a factor of " +
                               std::to_string(ratio));
}

std::complex<double> FftFirmware::output(std::uint64_t image, std::uint64_t u, std::uint64_t v) const {
  std::complex<double> sum = 0;
  for (std::uint64_t y = 0; y < kSize; ++y)
    for (std::uint64_t x = 0; x < kSize; ++x)
      sum += to_double(pixel((image * kSize + y) * kSize + x)) * root_[(u * y + v * x) % kSize];
  return sum;
}

}  // namespace

std::unique_ptr<plug_in::Firmware> make_fft(const Kernels& kernels, int images) {
  return std::make_unique<FftFirmware>(kernels, images);
}

}  // namespace examples
