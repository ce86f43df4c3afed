#pragma once

#include "firmware/path_tracer/program/program.hpp"

namespace testbench {

/// Segments without roulette that give the least error for the time (`csx600 bench error`, Cornell box).
inline constexpr int kRouletteStart = 3;

/// Sobol points, lights by solid angle, roulette from kRouletteStart on: the least error for the time.
inline void choose_best_sampling(path_tracer::ProgramConfig& program) {
  program.sampler = path_tracer::Sampler::sobol;
  program.light_sampling = path_tracer::LightSampling::solid_angle;
  program.roulette_start = kRouletteStart;
}

}  // namespace testbench
