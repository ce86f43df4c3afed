#include "testbench/validation/skips.hpp"

namespace testbench {

const std::vector<Skip>& skip_table() {
  using path_tracer::ProgramConfig;
  using path_tracer::RunCounts;
  static const std::vector<Skip> table = {
      {"features that the scene does not have", "--built-for anything",
       [](ProgramConfig& program) { program.built_for = path_tracer::kBuiltForAnything; }, false, nullptr},
      {"lobes that no hit of a block has", "--shading every_lobe",
       [](ProgramConfig& program) { program.shading = path_tracer::Shading::every_lobe; }, true, nullptr},
      {"shadow rays that cannot contribute", "--shadow-rays all",
       [](ProgramConfig& program) { program.cull_shadow_rays = false; }, true,
       [](const RunCounts& counts) {
         return SkipCount{counts.culled_shadow_rays, counts.culled_shadow_rays + counts.shadow_rays};
       }},
      {"blocks of slots without a path", "--empty-blocks process",
       [](ProgramConfig& program) { program.skips_empty_blocks = false; }, true,
       [](const RunCounts& counts) {
         return SkipCount{counts.skipped_blocks, counts.skipped_blocks + counts.blocks};
       }},
      {"loads of nodes that every PE keeps", "--resident-nodes 1",
       [](ProgramConfig& program) { program.tree.resident_nodes = 1; }, true, nullptr},
  };
  return table;
}

}  // namespace testbench
