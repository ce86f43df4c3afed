#pragma once

#include <vector>

#include "firmware/path_tracer/kernels/kernels.hpp"

namespace path_tracer {

/// The state of the bins outside mono memory: conditions that PEs hold for each block, and addresses that are
/// kept in poly memory from one bin to the next (paper, section 3.3: "a small piece of data is kept in poly
/// memory").
struct Bins {
  struct Block {
    LaneMask live;  ///< slots that hold a path
    LaneMask hit_something;
    LaneMask shadow;  ///< slots whose ray is a shadow ray
    LaneMask casts;   ///< slots whose next ray is a shadow ray
    // Of stream execution, between the halves of the path stage:
    LaneMask ended;     ///< slots whose path ended
    LaneMask finished;  ///< slots whose path ended or fills its slot
    PolyField<MonoAddress> surface_place;
    PolyField<MonoAddress> light_place;
    // As the latest step that makes rays left it, for the control unit and counts:
    int segment_count = 0;
    int shadow_ray_count = 0;

    void count_rays() {
      segment_count = segments().count();
      shadow_ray_count = shadow.count();
    }
    bool has_rays() const { return segment_count + shadow_ray_count > 0; }

    LaneMask segments() const { return live.without(shadow); }  ///< slots whose ray is a segment
    LaneMask ended_shadow() const {
      return shadow.without(casts);
    }                                                       ///< slots whose shadow ray goes on no more
    LaneMask ready() const { return live.without(casts); }  ///< slots whose vertex is complete
  };
  std::vector<Block> blocks;
};

/// Allocates the places of all blocks in poly memory; not in stream execution, where no PE keeps them.
Bins make_bins(cn::PolyMemory& memory, const ProgramConfig& config);

}  // namespace path_tracer
