#pragma once

#include "firmware/path_tracer/kernels/textures.hpp"
#include "firmware/path_tracer/sampling/sampler.hpp"

/// Coverage: whether a surface is there where a ray hit it, or lets the ray through.
namespace path_tracer {

/// @param surface a SurfaceRecord with its CoverageRecord and its texture of alpha
/// @param chance returns a random number for surfaces that are there by chance, in scenes that have such
template <class Chance>  // () -> poly<double>
mask lets_through(const Features& features, const RecordSizes& sizes,
                  const PolyPointer<SurfaceRecord>& surface, const PolyPointer<TextureLookUp>& look_ups,
                  const mask& front, const Chance& chance) {
  const auto record = tail<CoverageRecord>(surface, sizes.coverage);
  poly<double> alpha = record.get(&CoverageRecord::alpha);
  if (features.textures.has(TextureSlot::alpha))
    alpha.assign_all_lanes(alpha * TexturesAtHit(surface, sizes, look_ups).channel(TextureSlot::alpha));
  const poly<double> cutoff = record.get(&CoverageRecord::cutoff);
  if (!features.blended_coverage) return alpha < cutoff;
  const mask passes = alpha < cn::select(cutoff < 0.0, chance(), cutoff);
  return passes | (!front & (record.get(&CoverageRecord::front_only) != 0));
}

}  // namespace path_tracer
