#pragma once

#include "firmware/path_tracer/stages/stage.hpp"

/// Loads of what rays have hit, for stages that shade.
namespace path_tracer {

/// Where a step's hits are in its load buffer, with what they show.
struct SurfaceLoads {
  PolyPointer<HitRecord> hit;
  PolyPointer<SurfaceRecord> surface;
  PolyPointer<TextureLookUp> look_ups;
};

/// Loads the surfaces at the hits. A shadow ray needs no more of a tail than the coverage of what it hit and
/// the texture of a light.
/// @param block_of_slots for TransferRing::wait_block()
void load_surfaces(const StageContext& context, std::uint64_t step, int block_of_slots,
                   const Bins::Block& rays, const SurfaceLoads& to);

/// Loads the texels of all texture slots, once the surfaces are there.
void load_texels(const StageContext& context, std::uint64_t step, int block_of_slots, const Bins::Block& rays,
                 const SurfaceLoads& to);

}  // namespace path_tracer
