#include "firmware/path_tracer/program/program_config.hpp"

#include <string>

#include "firmware/path_tracer/program/program_options.hpp"

namespace path_tracer {
namespace {

void require(bool ok, const std::string& what, const std::string& found, const std::string& allowed) {
  if (!ok) throw ProgramError(what + ": found " + found + ", allowed is " + allowed);
}

/// The program without bins has one order of work, and its radiance is a part of it.
void require_what_resident_paths_allow(const ProgramConfig& config) {
  const std::string with = " with resident_paths " + std::to_string(config.resident_paths);
  const auto require_value = [&](const char* option, const std::string& allowed) {
    const std::string found = option_text(config, option);
    require(found == allowed, option, found, allowed + with);
  };
  require_value("program", name_of(Program::full));
  require_value("traversal", name_of(Traversal::brute_force));
  require_value("scratchpad", name_of(Scratchpad::none));
  require_value("execution", name_of(Execution::mtap));
  require_value("paths", name_of(Paths::unidirectional));
  require_value("light_candidates", "1");
  require(!config.bins_hits(), "shading", name_of(config.shading), "every_lobe or present_lobes" + with);
}

/// What bidirectional paths leave no choice of.
void require_bidirectional(const ProgramConfig& config) {
  const auto with_these = [](const char* allowed) {
    return std::string(allowed) + " with paths bidirectional";
  };
  require(config.program == Program::full, "program", name_of(config.program), with_these("full"));
  require(!config.bins_hits(), "shading", name_of(config.shading), with_these("every_lobe or present_lobes"));
  require(config.light_candidates == 1, "light_candidates", std::to_string(config.light_candidates),
          with_these("1"));
  require(config.skips_empty_blocks, "empty_blocks", "process", with_these("skip"));
  require(config.cull_shadow_rays, "shadow_rays", "all", with_these("facing"));
  require(!config.is_stream(), "execution", name_of(config.execution), with_these(name_of(Execution::mtap)));
}

}  // namespace

void validate(const ProgramConfig& config) {
  for (const ProgramOption& option : program_options()) {
    if (option.group == OptionGroup::tree && !config.uses_tree()) continue;
    const OptionValue value = option.read(config);
    require(is_allowed(option, value), option.name, value_text(value), allowed_text(option));
  }
  // Paper, section 3.3: "the bins must be at least n * (number of PEs) in length".
  require(config.n <= config.bin_blocks, "n", std::to_string(config.n),
          "at most the bin length, " + std::to_string(config.bin_blocks) + " blocks");
  require(config.uses_tree() || config.scratchpad != Scratchpad::nodes, "scratchpad", "nodes",
          "none, triangles or fitting with traversal brute_force, which has no nodes");
  require(!config.is_stream() || !config.uses_tree(), "traversal", name_of(config.traversal),
          "brute_force with execution stream");
  require(!config.is_stream() || !config.bins_hits(), "shading", name_of(config.shading),
          "every_lobe or present_lobes with execution stream, which sorts no hits");
  if (config.keeps_paths_in_sram()) require_what_resident_paths_allow(config);
  if (config.is_bidirectional()) require_bidirectional(config);
  const NodeLayout& layout = config.tree.layout;
  require(!config.uses_tree() || layout.has_kernel(), "node_width", std::to_string(layout.width),
          "4 or 8 with node_format quantised8");
}

}  // namespace path_tracer
