#include "testbench/run/simulator_choice.hpp"

#include "model/config/chip_parameters.hpp"

namespace testbench {
namespace {

using path_tracer::ProgramConfig;

/// A block costs the simulator something for each kernel and copy, and a bin as much cache as it has slots.
/// Measured on the shipped scenes at 48 x 48 pixels: 96, 192, 256, 384 and 512 PEs.
constexpr int kSimulatorPes = 384;
constexpr int kBinBlocks = 4;

/// Whether hits are shaded faster in bins of their kind than where their slots are. A bin costs about 6 % of
/// a diffuse scene's time. It pays where vertices cost much: by textures, rough facets, refraction or
/// candidates of lights. Without textures it does not where paths leave early for the sky: blocks of camera
/// rays are of a kind anyway.
bool bins_of_hits_pay(const ProgramConfig& program) {
  const path_tracer::Features& features = program.features;
  if (features.textures.any()) return true;
  if (features.environment || features.lights.environment) return false;
  return features.lobes.rough_specular() || features.lobes.transmissive() || program.light_candidates > 1;
}

bool allows_bins_of_hits(const ProgramConfig& program) {
  return !program.is_stream() && !program.keeps_paths_in_sram() && !program.is_bidirectional();
}

}  // namespace

std::string suit_to_simulator(const GivenOptions& given, RenderOptions& options) {
  search_natively(options);
  ProgramConfig& program = options.program;
  // Who asks for a chip of another width wants its counters.
  if (options.chip.chip.pes == model::default_chip_config().chip.pes) options.chip.chip.pes = kSimulatorPes;
  if (given.count("bin_blocks") == 0) program.bin_blocks = kBinBlocks;
  if (given.count("n") == 0) program.n = 0;  // transfers are instant
  const bool bins = given.count("shading") == 0 && allows_bins_of_hits(program) && bins_of_hits_pay(program);
  if (bins) program.shading = path_tracer::Shading::material_bins;
  return std::string("native: through the simulator's own tree, blocks of ") +
         std::to_string(options.chip.chip.pes) + (bins ? ", hits in bins of their material" : "");
}

}  // namespace testbench
