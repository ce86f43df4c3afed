#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/film/error_curve.hpp"
#include "testbench/film/light_pixels.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/message_text.hpp"

namespace testbench {
namespace {

struct BenchImageCommand {
  std::string image;
  std::string reference;
  std::string scene;
  ReachOption reach;

  void run() const;

 private:
  std::vector<bool> pixels_that_count(const ExrFilm& truth) const;
};

std::string size_text(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

std::vector<bool> BenchImageCommand::pixels_that_count(const ExrFilm& truth) const {
  if (scene.empty()) return std::vector<bool>(truth.rgb.size() / 3, true);
  Scene loaded = load_scene(scene, reach.is_outside_allowed());
  loaded.film = {truth.width, truth.height};
  std::vector<bool> counts = light_pixels(loaded);
  counts.flip();
  if (std::find(counts.begin(), counts.end(), true) == counts.end())
    throw InputError(scene + ": found the light in every pixel; allowed: at least one pixel without it");
  return counts;
}

void BenchImageCommand::run() const {
  const RadianceImage picture = read_exr_rgb(image);
  const ExrFilm truth = read_exr_film(reference);
  if (picture.width != truth.width || picture.height != truth.height)
    throw InputError(image + ": found " + size_text(picture.width, picture.height) +
                     " pixels, allowed is the reference's size, " + size_text(truth.width, truth.height));
  const std::vector<double> rgb(picture.rgb.begin(), picture.rgb.end());
  const ImageError error = image_error(rgb, truth, pixels_that_count(truth));
  std::printf("%s, %s, against %s%s\n", printable(image).c_str(),
              size_text(truth.width, truth.height).c_str(), printable(reference).c_str(),
              scene.empty() ? "" : ", light's pixels left out");
  std::printf("RMSE                  %.6e\nrelative MSE          %.6e\nFLIP                  %.6f\n",
              error.mse > 0 ? std::sqrt(error.mse) : 0.0, error.relative_mse, error.flip);
  std::printf("mean bias R, G, B, %%  %+.4f %+.4f %+.4f\n", 100 * error.mean_bias[0],
              100 * error.mean_bias[1], 100 * error.mean_bias[2]);
}

}  // namespace

void add_bench_image_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "image", "Error of an image, of any program, against a reference: RMSE, relative MSE, FLIP");
  const auto state = std::make_shared<BenchImageCommand>();
  command.add_option("image", state->image, "OpenEXR file with channels R, G and B")
      ->type_name("FILE")
      ->required();
  command
      .add_option("reference", state->reference,
                  "File of `csx600 bench reference`, or of `csx600 render --exr`")
      ->type_name("FILE")
      ->required();
  command.add_option("--scene", state->scene, "Leave out the pixels of this scene's light")
      ->type_name("SCENE");
  state->reach.add_to(command);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
