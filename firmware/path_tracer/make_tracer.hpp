#pragma once

#include <memory>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/pipeline/results_handover.hpp"
#include "firmware/path_tracer/pipeline/tracer.hpp"
#include "firmware/path_tracer/program/work.hpp"

namespace path_tracer {

/// The main program that the configuration asks for (ProgramConfig::paths and resident_paths).
/// @param machine has the scene image of `layout` in mono memory
/// @throws ProgramError, cn::PolyMemoryOverflow
std::unique_ptr<Tracer> make_tracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                                    const Layout& layout, const Work& work);

}  // namespace path_tracer
