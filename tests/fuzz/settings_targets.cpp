#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>

#include "firmware/path_tracer/program/program_config.hpp"
#include "model/config/chip_file.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/wave_options.hpp"
#include "testbench/film/film_size.hpp"
#include "testbench/golden/golden.hpp"
#include "testbench/run/run_settings.hpp"
#include "testbench/sweep/sweep_file.hpp"
#include "tests/fuzz/input_files.hpp"
#include "tests/fuzz/targets.hpp"

namespace fuzz {

void read_chip(std::string_view input) {
  write_file("chip.toml", input);
  const std::string text = model::effective_toml(testbench::load_chip("chip.toml"));
  write_file("again.toml", text);
  if (model::effective_toml(testbench::load_chip("again.toml")) != text)
    fail("a chip that changes on its way");
}

void read_sweep(std::string_view input) {
  write_parts(input, {"sweep.toml", "chip.toml"});
  testbench::load_sweep_file("sweep.toml");
}

void read_golden_grid(std::string_view input) {
  write_parts(input, {"grid.toml", "chip.toml"});
  testbench::read_golden_grid(".");
}

/// The options that take more than a name: ranges, sizes, windows, patterns, settings.
void read_command_line(std::string_view input) {
  std::vector<std::string> words;
  for (std::size_t end = 0; end != std::string_view::npos;
       input.remove_prefix(std::min(end + 1, input.size()))) {
    end = input.find('\n');
    words.emplace_back(input.substr(0, end));
  }
  std::reverse(words.begin(), words.end());  // as CLI11 wants them
  CLI::App program;
  testbench::ObservationOption observation;
  testbench::SetOptions settings;
  testbench::FirmwareOptions firmware;
  testbench::TimingOption timing;
  path_tracer::ProgramConfig config = path_tracer::default_program();
  int samples = 1;
  testbench::SizeOption size;
  observation.add_to(program);
  settings.add_to(program);
  timing.add_to(program);
  firmware.add_to(
      program, config,
      {path_tracer::OptionGroup::bins, path_tracer::OptionGroup::sampling, path_tracer::OptionGroup::tree});
  testbench::add_samples_option(program, samples);
  size.add_to(program);
  program.parse(std::move(words));
  const model::ChipConfig chip = settings.chip("csx600");
  const testbench::ObservationOptions options = observation.options(chip);
  if (options.waves) model::check_waves(options.waves->config, chip);
  size.require_valid();
}

}  // namespace fuzz
