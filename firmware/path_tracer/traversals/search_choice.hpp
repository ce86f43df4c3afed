#pragma once

#include <memory>

#include "firmware/path_tracer/pipeline/ray_search.hpp"
#include "firmware/path_tracer/pipeline/tracer.hpp"

namespace path_tracer {

/// The search that the configuration asks for (ProgramConfig::traversal).
/// @param layout of `context`; a search may move bins
std::unique_ptr<RaySearch> make_search(const StageContext& context, Layout& layout);

/// The rings of a main program, whose steps take turns with those of the search.
/// @param load_bytes, save_bytes of its own stages
Rings make_rings(cn::Machine& machine, const ProgramConfig& config, const Layers& layers, int load_bytes,
                 int save_bytes);

}  // namespace path_tracer
