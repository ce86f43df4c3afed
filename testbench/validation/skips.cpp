#include "testbench/validation/skips.hpp"

namespace testbench {

const std::vector<Skip>& skip_table() {
  using path_tracer::ProgramConfig;
  static const std::vector<Skip> table = {
      {"features that the scene does not have", "--built-for anything",
       [](ProgramConfig& program) { program.built_for = path_tracer::kBuiltForAnything; }, false, nullptr},
      {"look-ups of textures of one colour", "--constant-textures look_up",
       [](ProgramConfig& program) { program.folds_constant_textures = false; }, false,
       [](const RenderResult& result) {
         return SkipCount{result.textures.constant, result.textures.all};
       }},
      {"lobes that no hit of a block has", "--shading every_lobe",
       [](ProgramConfig& program) { program.shading = path_tracer::Shading::every_lobe; }, true, nullptr},
      {"shadow rays that cannot contribute", "--shadow-rays all",
       [](ProgramConfig& program) { program.cull_shadow_rays = false; }, true,
       [](const RenderResult& result) {
         const path_tracer::RunCounts& counts = result.counts;
         return SkipCount{counts.culled_shadow_rays, counts.culled_shadow_rays + counts.shadow_rays};
       }},
      {"blocks of slots without a path", "--empty-blocks process",
       [](ProgramConfig& program) { program.skips_empty_blocks = false; }, true,
       [](const RenderResult& result) {
         const path_tracer::RunCounts& counts = result.counts;
         return SkipCount{counts.skipped_blocks, counts.skipped_blocks + counts.blocks};
       }},
      {"loads of nodes that every PE keeps", "--resident-nodes 1",
       [](ProgramConfig& program) { program.tree.resident_nodes = 1; }, true, nullptr},
  };
  return table;
}

}  // namespace testbench
