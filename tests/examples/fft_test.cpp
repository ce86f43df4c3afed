#include "firmware/examples/fft.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/support/native_example.hpp"

namespace fft_test {

using examples::Complex;
using examples::Fft;
using examples::kFftSize;
using test_support::run_natively;
using test_support::verdict;
using testbench::fft_run;

constexpr std::size_t kPixels = std::size_t(kFftSize) * kFftSize;
using Image = std::vector<Complex>;

/// Transforms two images.
std::vector<Image> transform(const std::vector<Image>& images, int num_pes = 96) {
  testbench::ExampleRun run = fft_run(2, num_pes, cn::narrowest_level());
  for (std::size_t i = 0; i < 2; ++i)
    std::memcpy(run.mono.data() + i * examples::kImageBytes, images[i].data(), examples::kImageBytes);
  const std::vector<std::uint8_t> mono = run_natively(run, num_pes);
  std::vector<Image> results(2, Image(kPixels));
  for (std::size_t i = 0; i < 2; ++i)  // after the images and the tiles
    std::memcpy(results[i].data(), mono.data() + (4 + i) * examples::kImageBytes, examples::kImageBytes);
  return results;
}

TEST(FftExample, OutputsAreTheSumsThatDefineThem) {
  for (const int num_pes : {32, 64, 96, 256}) {
    const testbench::ExampleRun run = fft_run(2, num_pes, cn::narrowest_level());
    EXPECT_EQ(verdict(run, run_natively(run, num_pes)), "") << num_pes;
  }
}

TEST(FftExample, LevelsAndPeCountsGiveTheSameBits) {
  const auto first = run_natively(fft_run(2, 96, cn::narrowest_level()), 96);
  for (const cn::Level level : cn::usable_levels())
    EXPECT_EQ(run_natively(fft_run(2, 96, level), 96), first) << int(level);
  EXPECT_EQ(run_natively(fft_run(2, 64, cn::narrowest_level()), 64), first);
}

TEST(FftExample, ImpulseBecomesAWaveAndAWaveAnImpulse) {
  constexpr std::size_t kU = 37;
  constexpr std::size_t kV = 402;
  constexpr double kTwoPi = 6.283185307179586477;
  Image impulse(kPixels);
  impulse[kU * kFftSize + kV] = {1, 0};
  Image wave(kPixels);
  for (std::size_t y = 0; y < kFftSize; ++y)
    for (std::size_t x = 0; x < kFftSize; ++x) {
      const double angle = kTwoPi * double((kU * y + kV * x) % kFftSize) / kFftSize;
      wave[y * kFftSize + x] = {float(std::cos(angle)), float(std::sin(angle))};
    }
  const std::vector<Image> found = transform({impulse, wave});
  for (std::size_t v = 0; v < kFftSize; ++v)
    for (std::size_t u = 0; u < kFftSize; ++u) {
      const std::size_t at = v * kFftSize + u;
      const double angle = -kTwoPi * double((kU * u + kV * v) % kFftSize) / kFftSize;
      ASSERT_NEAR(found[0][at].real, std::cos(angle), 1e-6) << u << " " << v;
      ASSERT_NEAR(found[0][at].imaginary, std::sin(angle), 1e-6) << u << " " << v;
      ASSERT_NEAR(found[1][at].real, u == kU && v == kV ? double(kPixels) : 0.0, 0.2) << u << " " << v;
      ASSERT_NEAR(found[1][at].imaginary, 0.0, 0.2) << u << " " << v;
    }
}

/// Two forward transforms give the image mirrored and scaled. The results are transposed, and two
/// transpositions cancel.
TEST(FftExample, TwiceGivesTheMirroredImage) {
  Image image(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i)
    image[i] = {float(i * 2654435761u % 1000) / 1000 - 0.5f, float(i * 40503u % 777) / 777 - 0.5f};
  const std::vector<Image> once = transform({image, image});
  const std::vector<Image> twice = transform(once);
  for (std::size_t y = 0; y < kFftSize; ++y)
    for (std::size_t x = 0; x < kFftSize; ++x) {
      const std::size_t mirrored = (kFftSize - y) % kFftSize * kFftSize + (kFftSize - x) % kFftSize;
      const Complex& found = twice[1][y * kFftSize + x];
      ASSERT_NEAR(found.real / kPixels, image[mirrored].real, 2e-6) << x << " " << y;
      ASSERT_NEAR(found.imaginary / kPixels, image[mirrored].imaginary, 2e-6) << x << " " << y;
    }
}

TEST(FftExample, CheckNoticesAWrongTransform) {
  const testbench::ExampleRun run = fft_run(2, 96, cn::narrowest_level());
  std::vector<std::uint8_t> mono = run_natively(run, 96);
  EXPECT_NE(verdict(run, run.mono), "");
  std::swap_ranges(mono.begin() + 4 * examples::kImageBytes,
                   mono.begin() + 4 * examples::kImageBytes + examples::kLineBytes,
                   mono.begin() + 4 * examples::kImageBytes + 5 * examples::kLineBytes);
  EXPECT_NE(verdict(run, mono).find("FFT: output ("), std::string::npos);  // line 5 is among those compared
}

TEST(FftExample, RefusesWhatItCannotDo) {
  const testbench::ExampleRun one = fft_run(1, 96, cn::narrowest_level());
  EXPECT_THROW(run_natively(one, 96), cn::MachineFault);
  const testbench::ExampleRun two = fft_run(2, 96, cn::narrowest_level());
  EXPECT_THROW(run_natively(two, 48), cn::MachineFault);
}

}  // namespace fft_test
