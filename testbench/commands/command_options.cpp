#include "testbench/commands/command_options.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <thread>

#include "model/config/chip_file.hpp"
#include "model/config/chip_parameters.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/film/film_size.hpp"
#include "testbench/run/program_names.hpp"
#include "testbench/run/render.hpp"
#include "testbench/scene/scene_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// "480x480".
FilmSize parse_size(const std::string& text) {
  if (const std::optional<FilmSize> size = parse_film_size(text)) return *size;
  throw InputError("--size: found '" + text + "', allowed is " + allowed_film_size());
}

}  // namespace

void require_files_of_their_own(const std::vector<OutputOption>& outputs) {
  std::map<std::filesystem::path, std::string> option_of;
  for (const auto& [option, path] : outputs) {
    if (path.empty()) continue;
    const auto [other, is_first] =
        option_of.emplace(std::filesystem::absolute(path).lexically_normal(), option);
    if (!is_first)
      throw InputError(std::string(option) + ": found '" + path + "', which " + other->second +
                       " writes too; allowed is a file of its own");
  }
}

void SetOptions::add_to(CLI::App& command) {
  command.add_option("--set", settings_, "One parameter, key=value; may be repeated")
      ->allow_extra_args(false);
}

void ChipOptions::add_to(CLI::App& command, const std::string& default_chip) {
  chip_ = default_chip;
  command.add_option("--chip", chip_, "Preset or .toml file (see `csx600 params`)")->capture_default_str();
  settings_.add_to(command);
}

model::ChipConfig SetOptions::chip(const std::string& name) const {
  try {
    model::ChipConfig config = model::load_chip(name);
    for (const std::string& setting : settings_) {
      const std::size_t equals = setting.find('=');
      if (equals == std::string::npos)
        throw InputError("--set: found '" + setting + "', allowed is key=value");
      model::set_parameter(config, setting.substr(0, equals), setting.substr(equals + 1), "--set");
    }
    model::validate(config);
    return config;
  } catch (const model::ConfigError& error) {
    throw InputError(error.what());
  }
}

void TimingOption::add_to(CLI::App& command) {
  command
      .add_option("--timing", text_,
                  "lt: loosely timed, fast; at: approximately timed, packet by packet in SystemC time")
      ->check(CLI::IsMember({"lt", "at"}))
      ->capture_default_str();
}

model::TimingStyle TimingOption::style() const {
  return text_ == "at" ? model::TimingStyle::approximately_timed : model::TimingStyle::loosely_timed;
}

void LevelOption::add_to(CLI::App& command) {
  command.add_option("--level", level_, "x86-64 level of the kernels: auto, v2, v3 or v4")
      ->check(CLI::IsMember({"auto", "v2", "v3", "v4"}))
      ->capture_default_str();
}

path_tracer::Level LevelOption::level() const {
  if (level_ == "auto") return widest_level();
  const std::vector<cn::Level> usable = cn::usable_levels();
  std::string allowed = "auto";
  for (const cn::Level level : usable) {
    if (cn::name_of(level) == level_) return level;
    allowed += " or " + cn::name_of(level);
  }
  throw InputError("--level: found " + level_ + ", this build on this machine has " + allowed);
}

void add_samples_option(CLI::App& command, int& samples) {
  command.add_option("--samples", samples, "Paths a pixel")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
}

void add_jobs_option(CLI::App& command, int& jobs) {
  jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  command.add_option("--jobs", jobs, "Runs at a time, each a process")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

void add_check_hazards_flag(CLI::App& command, bool& check_hazards) {
  command.add_flag(
      "--check-hazards", check_hazards,
      "Stop when the firmware uses what a transfer may still read or write (kernels at level v2)");
}

Scene load_scene_for_film(const std::string& path, const std::string& size) {
  std::optional<FilmSize> film;
  if (!size.empty()) film = parse_size(size);
  Scene loaded = load_scene(path);
  if (film) loaded.film = *film;
  return loaded;
}

void add_sampling_options(CLI::App& command, path_tracer::ProgramConfig& program) {
  using path_tracer::LightSampling;
  using path_tracer::Sampler;
  command
      .add_option("--sampler", program.sampler, "Random numbers: philox (independent) or sobol (stratified)")
      ->transform(named_values<Sampler>({{"philox", Sampler::philox}, {"sobol", Sampler::sobol}}))
      ->default_str(sampler_name(program.sampler));
  command
      .add_option("--light-sampling", program.light_sampling,
                  "Points of a light: uniform in its area, or in the solid_angle it takes")
      ->transform(named_values<LightSampling>(
          {{"area", LightSampling::area}, {"solid_angle", LightSampling::solid_angle}}))
      ->default_str(light_sampling_name(program.light_sampling));
  command
      .add_option("--roulette-start", program.roulette_start,
                  "Segments that a path lives without Russian roulette")
      ->capture_default_str();
  command
      .add_option("--max-survival", program.max_survival,
                  "Largest probability with which roulette lets a path go on")
      ->capture_default_str();
  command.add_option("--seed", program.seed, "Seed of the random numbers")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

void TraversalOption::add_to(CLI::App& command, path_tracer::ProgramConfig& program) {
  command
      .add_option("--traversal", chosen_,
                  "How rays find triangles, by default what the scene and the chip make fastest: " +
                      CLI::detail::join(traversal_names(), ", "))
      ->transform(named_values(traversals_by_name()));
  path_tracer::TreeShape& tree = program.tree;
  tree.resident_nodes = kAsManyAsFit;
  command.add_option("--node-format", wishes_.node_format, "Boxes of the tree: fp64, fp32 or quantised8")
      ->transform(named_values(node_formats_by_name()))
      ->default_str("what the traversal makes fastest");
  command.add_option("--node-width", wishes_.node_width, "Children of a node: 2, 4 or 8")
      ->check(CLI::IsMember(
          std::vector<int>(std::begin(path_tracer::kNodeWidth), std::end(path_tracer::kNodeWidth))))
      ->default_str("what the scene makes fastest");
  command.add_option("--leaf-triangles", tree.leaf_triangles, "Triangles of a leaf, at most")
      ->capture_default_str();
  command.add_option("--treelet-nodes", wishes_.treelet_nodes, "Nodes that a PE loads at a time")
      ->default_str("8 / node width, fewer if they do not fit");
  command.add_option("--resident-nodes", tree.resident_nodes, "Nodes around the root that every PE keeps")
      ->default_str("as many as fit");
  command
      .add_option("--stack-entries", wishes_.stack_entries,
                  "Entries of a ray's short stack: 0 or a power of two")
      ->default_str(std::to_string(tree.stack_entries) + ", fewer if they do not fit");
  command
      .add_option("--visits", wishes_.visits,
                  "Nodes that a ray visits before PEs load again, at most; 0: all that are in SRAM")
      ->default_str("2 to 8, by the traversal and the nodes' width and format");
}

std::string TraversalOption::choose(const Scene& scene, const model::ChipConfig& chip,
                                    path_tracer::ProgramConfig& program) const {
  program.tree = wished_tree(program, wishes_);
  const TraversalChoice choice = choose_traversal(scene.triangles.size(), program.tree, chip);
  program.traversal = chosen_.value_or(choice.traversal);
  fit_tree(scene.triangles.size(), chip, wishes_, program);
  return chosen_ ? "" : choice.reason;
}

}  // namespace testbench
