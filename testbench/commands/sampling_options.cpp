#include "testbench/commands/sampling_options.hpp"

#include "testbench/sampling/importance_map.hpp"

namespace testbench {

void ImportanceOption::add_to(CLI::App& command) {
  command
      .add_option(
          "--importance", file_,
          "OpenEXR image of the film's size: its luminance, or its only channel, times --samples is the "
          "mean number of paths of each pixel")
      ->check(error_of_no_file, "")
      ->type_name("FILE");
}

MeanSamples ImportanceOption::means(FilmSize film, int samples) const {
  if (!is_given()) return MeanSamples(std::size_t(film.width) * std::size_t(film.height), double(samples));
  return mean_samples(read_importance(file_, film), samples, file_, film);
}

}  // namespace testbench
