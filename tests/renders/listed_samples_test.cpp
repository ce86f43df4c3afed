// Renders whose paths are a list of camera samples: the same paths as without one, each counted where it
// belongs.

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "testbench/run/render.hpp"
#include "testbench/sampling/sample_counts.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace listed_samples_test {

using path_tracer::Program;
using path_tracer::RadianceRecord;
using path_tracer::Traversal;
using test_support::FilmSize;
using test_support::render_options;
using testbench::Film;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::SampleCounts;
using testbench::Scene;

constexpr FilmSize kFilm{17, 5};
constexpr int kPixels = 17 * 5;

class ListedSamples : public test_support::SystemCFixture {
 protected:
  static RenderResult on_chip(const Scene& scene, const RenderOptions& options) {
    new_context();
    return testbench::render_on_chip(scene, options);
  }
};

RenderOptions listed(RenderOptions options, const SampleCounts& counts) {
  options.camera_samples =
      testbench::list_samples(SampleCounts(counts.size(), 0), counts, options.program.pixel_stride);
  return options;
}

/// 0 to 6 samples, different from pixel to pixel.
SampleCounts uneven_counts() {
  SampleCounts counts;
  for (int pixel = 0; pixel < kPixels; ++pixel) counts.push_back(pixel * 5 % 7);
  return counts;
}

TEST_F(ListedSamples, OfEveryPixelMakeThePictureOfARunWithoutAList) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  for (const Program program : {Program::segments, Program::direct, Program::full}) {
    const RenderOptions plain = render_options(program, 6);
    const RenderOptions list = listed(plain, SampleCounts(kPixels, 6));
    const RenderResult expected = on_chip(scene, plain);
    const RenderResult found = on_chip(scene, list);
    EXPECT_EQ(found.film.sha256(), expected.film.sha256());
    EXPECT_EQ(found.counts.segments, expected.counts.segments);
    EXPECT_EQ(found.counts.shadow_rays, expected.counts.shadow_rays);
    EXPECT_GT(found.chip->firmware_cycles, expected.chip->firmware_cycles) << "a list is not free";
    EXPECT_EQ(found.chip->poly_sram.peak_bytes, expected.chip->poly_sram.peak_bytes);
  }
}

TEST_F(ListedSamples, ArePathsOfTheirPixelAndNumber) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  const RenderOptions plain = render_options(Program::full, 6);
  const SampleCounts counts = uneven_counts();
  Film expected(scene.film, testbench::film_scale(scene));
  for (const RadianceRecord& path : test_support::native_paths(scene, plain))
    if (path.sample < counts[std::size_t(path.pixel)])
      expected.add(path.pixel, {path.radiance.x, path.radiance.y, path.radiance.z});
  const Film film = testbench::render_natively(scene, listed(plain, counts)).film;
  EXPECT_EQ(film.sha256(), expected.sha256());
  for (int pixel = 0; pixel < kPixels; ++pixel)
    EXPECT_EQ(film.sample_count(pixel), std::uint64_t(counts[std::size_t(pixel)]));
}

TEST_F(ListedSamples, GiveTheSameBitsHoweverTheyAreRun) {
  const Scene scene = test_support::small_cornell_box(kFilm);
  const SampleCounts counts = uneven_counts();
  const RenderOptions base = render_options(Program::full, 6);
  const std::string expected = testbench::render_natively(scene, listed(base, counts)).film.sha256();
  std::vector<RenderOptions> variations;
  for (const int n : {0, 1, 3}) {
    variations.push_back(base);
    variations.back().program.n = n;
    variations.back().program.buffer_saves = n % 2 == 0;
  }
  for (const int pes : {16, 128}) {
    variations.push_back(base);
    variations.back().chip.chip.pes = pes;
  }
  for (const Traversal traversal : {Traversal::refill, Traversal::temporary_bin}) {
    variations.push_back(base);
    variations.back().program.traversal = traversal;
  }
  variations.push_back(base);
  variations.back().program.bin_blocks = 1;
  variations.push_back(base);
  variations.back().program.pixel_stride = 7;
  variations.push_back(base);
  variations.back().timing = model::TimingStyle::approximately_timed;
  variations.push_back(base);
  variations.back().check_hazards = true;
  for (const RenderOptions& options : variations) {
    EXPECT_EQ(on_chip(scene, listed(options, counts)).film.sha256(), expected);
    EXPECT_EQ(testbench::render_natively(scene, listed(options, counts)).film.sha256(), expected);
  }
}

TEST_F(ListedSamples, NeedRoomInMonoMemory) {
  RenderOptions options = render_options(Program::full, 1);
  const Scene scene = test_support::small_cornell_box(kFilm);
  const auto image = testbench::make_image(scene, options);
  options.image = image;
  options.chip.ddr.size_bytes = image->layout.total_bytes + 8 * 100;
  const auto fits = listed(options, SampleCounts(kPixels, 1));
  EXPECT_EQ(testbench::render_natively(scene, fits).film.sample_count(3), 1u);
  EXPECT_THROW(testbench::render_natively(scene, listed(options, SampleCounts(kPixels, 2))),
               testbench::InputError);
}

}  // namespace listed_samples_test
