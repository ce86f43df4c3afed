// The shipped references are of the scenes as they are: renders of today have the same mean.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "testbench/benchmark/error_run.hpp"
#include "testbench/film/image_file.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "tests/support/native_paths.hpp"

namespace references_test {

using testbench::ExrFilm;
using testbench::Film;
using testbench::RenderOptions;
using testbench::Scene;

/// Folders of scenes/ that hold a reference.
std::vector<std::filesystem::path> scenes_with_reference() {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(CSX600_SCENES_DIR))
    if (std::filesystem::exists(entry.path() / "reference.exr")) found.push_back(entry.path());
  return found;
}

Film rendered(const Scene& scene, int samples) {
  RenderOptions options = test_support::render_options(path_tracer::Program::full, samples);
  options.program = path_tracer::default_program();
  options.program.sampler =
      path_tracer::Sampler::philox;  // films know the variance of independent samples only
  options.program = program_for(scene, options.chip, options.program);
  return render_natively(scene, options).film;
}

TEST(References, AreOfTheScenesAsTheyAre) {
  const std::vector<std::filesystem::path> folders = scenes_with_reference();
  EXPECT_GE(folders.size(), 5u);
  for (const std::filesystem::path& folder : folders) {
    const ExrFilm reference = testbench::read_exr_film(folder / "reference.exr");
    Scene scene = testbench::load_scene(folder);
    scene.film = {reference.width, reference.height};
    const Film film = rendered(scene, 128);
    for (int channel = 0; channel < 3; ++channel) {
      double difference = 0;
      double variance = 0;
      double sum = 0;
      for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
        const std::size_t index = 3 * std::size_t(pixel) + std::size_t(channel);
        difference += film.mean(pixel)[channel] - double(reference.rgb[index]);
        variance += film.variance_of_mean(pixel)[channel] + double(reference.variance[index]);
        sum += double(reference.rgb[index]);
      }
      EXPECT_LT(std::sqrt(variance), 0.02 * sum) << folder << ": too noisy to tell";
      EXPECT_LT(std::abs(difference), 4.5 * std::sqrt(variance)) << folder << ", channel " << channel;
    }
  }
}

}  // namespace references_test
