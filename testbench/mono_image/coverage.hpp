#pragma once

#include "firmware/path_tracer/records/tails.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// Whether rays pass a material somewhere, or by chance.
bool lets_rays_through(const Scene& scene, const Material& material);

path_tracer::CoverageRecord coverage_record(const Material& material);

}  // namespace testbench
