#pragma once

#include <vector>

#include "firmware/path_tracer/bidirectional/pair_kernels.hpp"
#include "firmware/path_tracer/stages/buffer_cutter.hpp"
#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// What the stages of bidirectional paths share: what is known of slots outside mono memory, beside Bins.
struct PairContext {
  struct Block {
    LaneMask occupied;  ///< slots that hold a pair of paths
    LaneMask of_light;  ///< slots whose ray is a segment of a light path
    LaneMask needs_light;
    LaneMask needs_emission;
    LaneMask needs_near;
    LaneMask needs_far;
    LaneMask needs_segment;  ///< slots that need all of their PairRecord
    LaneMask starts;         ///< slots that start a path
    LaneMask to_lens;        ///< slots whose ray is a connection to the lens
    LaneMask to_vertex;      ///< or to a vertex of the light path
    PolyField<MonoAddress> emission_place;
    PolyField<MonoAddress> near_place;
    PolyField<MonoAddress> far_place;
  };

  PairContext(const StageContext& context, const PairKernels& pair_kernels);

  const PairKernels& kernels;
  PairSizes sizes;
  PairWorld world;
  std::vector<Block> blocks;

  Block& block(int number) { return blocks[std::size_t(number)]; }
};

}  // namespace path_tracer
