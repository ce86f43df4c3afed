#include "firmware/path_tracer/stages/surface_loads.hpp"

namespace path_tracer {
namespace {

void load_texels_of(const StageContext& context, std::uint64_t step, int block_of_slots,
                    const Bins::Block& rays, const SurfaceLoads& to, TextureSlot slot) {
  const RecordSizes& sizes = context.layout.sizes;
  LaneMask needs;
  LookUpArguments arguments;
  arguments.hit = to.hit;
  arguments.texture = PolyPointer<TextureRecord>(to.surface.span().offset_bytes + sizes.texture[int(slot)]);
  arguments.footprint_bytes = footprint_bytes(slot);
  arguments.look_up = PolyPointer<TextureLookUp>(to.look_ups.span().offset_bytes + sizes.look_up[int(slot)]);
  arguments.needs = &needs;
  context.machine.run(
      context.kernels.look_up, arguments,
      counts_for_shadow_rays(slot) ? rays.hit_something : rays.hit_something.without(rays.shadow));
  const cn::PolySpan look_up = arguments.look_up.span();
  context.loads.copy_m2p(step, block_of_slots,
                         {look_up.offset_bytes + look_up.size_bytes, footprint_bytes(slot)},
                         context.machine.places_in(arguments.look_up.field(&TextureLookUp::place)), needs);
}

}  // namespace

void load_surfaces(const StageContext& context, std::uint64_t step, int block_of_slots,
                   const Bins::Block& rays, const SurfaceLoads& to) {
  const int bytes = context.layout.sizes.surface;
  const cn::MonoPlaces places = context.machine.places_in(rays.surface_place);
  const int bytes_of_shadow_ray = context.layout.sizes.surface_of_shadow_ray;
  const bool spares_tails = context.config.casts_shadow_rays() && bytes > bytes_of_shadow_ray;
  const LaneMask with_tails = spares_tails ? rays.hit_something.without(rays.shadow) : rays.hit_something;
  const auto load = [&](int size_bytes, const LaneMask& lanes) {
    context.loads.copy_m2p(step, block_of_slots, {to.surface.span().offset_bytes, size_bytes}, places, lanes);
  };
  load(bytes, with_tails);
  if (spares_tails) load(bytes_of_shadow_ray, rays.hit_something.without(with_tails));
}

void load_texels(const StageContext& context, std::uint64_t step, int block_of_slots, const Bins::Block& rays,
                 const SurfaceLoads& to) {
  for (int slot = 0; slot < kTextureSlots; ++slot)
    if (context.config.features.textures.looks_up(TextureSlot(slot)))
      load_texels_of(context, step, block_of_slots, rays, to, TextureSlot(slot));
}

}  // namespace path_tracer
