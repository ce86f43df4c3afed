// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/kernels/kernels.hpp"

#include "firmware/path_tracer/kernels/camera_rays.hpp"
#include "firmware/path_tracer/kernels/coverage.hpp"
#include "firmware/path_tracer/kernels/intersection.hpp"
#include "firmware/path_tracer/kernels/light_candidates.hpp"
#include "firmware/path_tracer/kernels/outside.hpp"
#include "firmware/path_tracer/kernels/places.hpp"
#include "firmware/path_tracer/kernels/shade.hpp"
#include "firmware/path_tracer/kernels/textures.hpp"
#include "firmware/path_tracer/prefilter/prefilter_search.hpp"
#include "firmware/path_tracer/sampling/light_sampling.hpp"
#include "firmware/path_tracer/sampling/sampler.hpp"

namespace path_tracer {

inline namespace CN_LEVEL {
const TraversalKernels& traversal_kernel_table();
const PacketKernels& packet_kernel_table();
const LargePacketKernels& large_packet_kernel_table();
const RayStreamKernels& ray_stream_kernel_table();
const StreamKernels& stream_kernel_table();
const ResidentKernels& resident_kernel_table();
const PairKernels& pair_kernel_table();
cn::Kernel<IntersectArguments> tree_search_kernel();
}  // namespace CN_LEVEL

namespace {

mask kept_mask(const LaneMask& lanes) {
  return cn::recall(lanes);
}

void intersect(const IntersectArguments& arguments) {
  const RayOperands ray = rays_to_intersect(arguments);
  Nearest nearest;
  search_by(PrefilteredSearch{arguments.prefilter}, ray, arguments.reach, triangles_to_intersect(arguments),
            nearest);
  write_found(arguments, ray, nearest);
}

struct Surface {
  Point3 position;
  Direction3 normal;  ///< on the side that the ray arrived from
  vec3<poly<double>> reflectance;
};

/// Aims a shadow ray from `surface` and records what it contributes if it reaches its light. `wants_light` is
/// true where the surface can reflect light.
void aim(const ScatterArguments& arguments, const Surface& surface, const mask& wants_light) {
  const PolyPointer<LightRecord>& light = arguments.light;
  const LightSurface light_surface{light.get(&LightRecord::vertex), light.get(&LightRecord::edge1),
                                   light.get(&LightRecord::edge2), light.get(&LightRecord::normal)};
  const poly<double> u = arguments.path.get(&PathRecord::light_u);
  const poly<double> v = arguments.path.get(&PathRecord::light_v);
  const LightSample sample =
      sample_light(arguments.light_sampling, light_surface, light.get(&LightRecord::shape), surface.position,
                   surface.normal, u, v);
  const mask facing = sample.weight > 0.0;
  poly<double> scale = cn::select(facing, sample.weight, poly<double>(0.0)) *
                       light.get(&LightRecord::inverse_pdf) * (1.0 / kPi);
  if (arguments.resamples_lights)
    scale.assign_all_lanes(scale * arguments.resampling.get(&LightResampling::factor));
  arguments.shadow_ray.set(&RayRecord::origin, surface.position);
  arguments.shadow_ray.set(&RayRecord::direction, sample.to_light);
  arguments.shadow_ray.set(&RayRecord::left_face, arguments.surface.get(&SurfaceRecord::face));
  arguments.shadow_ray.set(&RayRecord::light_face, light.get(&LightRecord::face));
  arguments.lighting.set(&LightingRecord::weight, surface.reflectance * scale);
  arguments.lighting.set(&LightingRecord::light_face, light.get(&LightRecord::face));
  if (arguments.is_in_layers)
    arguments.lighting.set(&LightingRecord::light,
                           light_number(arguments.light_place.read(), arguments.lights));
  cn::keep(arguments.cull_shadow_rays ? wants_light & facing : wants_light, *arguments.casts);
}

void scatter(const ScatterArguments& arguments) {
  const mask hit = arguments.hit.get(&HitRecord::hit) != 0;
  const mask front = arguments.hit.get(&HitRecord::front) != 0;
  const poly<std::int32_t> depth = arguments.path.get(&PathRecord::depth);
  const Direction3 surface_normal = arguments.surface.get(&SurfaceRecord::normal);
  const Surface surface{arguments.hit.get(&HitRecord::position),
                        cn::select(front, surface_normal, surface_normal * -1.0),
                        arguments.surface.get(&SurfaceRecord::reflectance)};
  const poly<double> albedo = largest_channel(surface.reflectance);
  const ScatterNumbers random =
      scatter_numbers(arguments.sampler, arguments.seed, arguments.path.get(&PathRecord::pixel),
                      arguments.path.get(&PathRecord::sample), depth);

  // Russian roulette depends on the surface alone, so that the path before it need not be loaded.
  const mask safe = depth < arguments.roulette_start;
  const poly<double> survival =
      cn::select(safe, poly<double>(1.0), cn::min(albedo, poly<double>(arguments.max_survival)));
  const mask reflects = hit & (albedo > 0.0);
  const mask goes_on = reflects & (random.roulette < survival);
  const poly<double> inverse_survival = 1.0 / cn::select(goes_on, survival, poly<double>(1.0));

  const vec3<poly<double>> none{0.0, 0.0, 0.0};
  const mask emits = hit & front & (arguments.casts_shadow_rays ? depth == 0 : depth >= 0);
  arguments.scatter.set(&ScatterRecord::position, surface.position);
  arguments.scatter.set(&ScatterRecord::direction,
                        sample_cosine(surface.normal, random.direction.u, random.direction.v));
  arguments.scatter.set(&ScatterRecord::radiance,
                        cn::select(emits, arguments.surface.get(&SurfaceRecord::emission), none));
  arguments.scatter.set(&ScatterRecord::weight,
                        cn::select(goes_on, surface.reflectance * inverse_survival, none));
  arguments.scatter.set(&ScatterRecord::face, arguments.surface.get(&SurfaceRecord::face));
  arguments.scatter.set(&ScatterRecord::ended,
                        cn::select(goes_on, poly<std::int32_t>(0), poly<std::int32_t>(1)));
  if (arguments.casts_shadow_rays) aim(arguments, surface, reflects);
}

/// Whether the ray hit its light. A face is one light, except in layered scenes, where it may hold several
/// lights and walls.
mask is_light(const IlluminateArguments& arguments) {
  if (arguments.is_in_layers)
    return arguments.surface.get(&SurfaceRecord::light) == arguments.lighting.get(&LightingRecord::light);
  return arguments.surface.get(&SurfaceRecord::face) == arguments.lighting.get(&LightingRecord::light_face);
}

/// Whether what the shadow ray hit lets it through.
mask lets_shadow_ray_through(const IlluminateArguments& arguments) {
  const auto chance = [&] {
    const auto numbers = tail<ShadowNumbersRecord>(arguments.lighting);
    return coverage_number(arguments.sampler, arguments.seed, numbers.get(&ShadowNumbersRecord::pixel),
                           numbers.get(&ShadowNumbersRecord::sample),
                           numbers.get(&ShadowNumbersRecord::depth),
                           arguments.surface.get(&SurfaceRecord::face));
  };
  return lets_through(arguments.features, arguments.sizes, arguments.surface, arguments.look_ups,
                      arguments.hit.get(&HitRecord::front) != 0, chance);
}

/// The rest of a shadow ray's direction behind its hit. That of a near light without a triangle ends at the
/// light.
Direction3 rest_of_shadow_ray(const IlluminateArguments& arguments) {
  const auto arrival = tail<ArrivalRecord>(arguments.hit);
  const Direction3 direction = arrival.get(&ArrivalRecord::direction);
  if (!arguments.features.lights.points) return direction;
  const poly<double> rest = 1.0 - arrival.get(&ArrivalRecord::distance);
  const mask is_near = arguments.lighting.get(&LightingRecord::light_face) == poly<std::int32_t>(kNoFace);
  return direction * cn::select(is_near, rest, poly<double>(1.0));
}

/// The PEs whose shadow ray ends where it hit. In scenes with coverage, the others' rays go on unless they
/// are at their light.
mask end_shadow_rays(const IlluminateArguments& arguments, const mask& hit, const mask& at_light) {
  const mask passes = hit & lets_shadow_ray_through(arguments);
  arguments.shadow_ray.set(&RayRecord::origin, arguments.hit.get(&HitRecord::position));
  arguments.shadow_ray.set(&RayRecord::direction, rest_of_shadow_ray(arguments));
  arguments.shadow_ray.set(&RayRecord::left_face, arguments.surface.get(&SurfaceRecord::face));
  arguments.shadow_ray.set(&RayRecord::light_face, poly<std::int32_t>(kNoFace));
  cn::keep(passes & !at_light, *arguments.goes_on);
  return !passes;
}

void illuminate_by_any(const IlluminateArguments& arguments) {
  const vec3<poly<double>> none{0.0, 0.0, 0.0};
  const LightWithoutTriangle other = light_without_triangle(arguments);
  Rgb radiance = cn::select(other.sees, other.radiance, none);
  const mask hit = arguments.hit.get(&HitRecord::hit) != 0;
  mask sees = hit & (arguments.features.lights.surfaces ? is_light(arguments) : other.sees);
  if (arguments.features.coverage) sees = sees & end_shadow_rays(arguments, hit, other.sees | sees);
  if (arguments.features.lights.surfaces)
    radiance =
        cn::select(sees, emission_at_hit(arguments.surface, arguments.sizes, arguments.look_ups), radiance);
  arguments.direct_light.set(&DirectLightRecord::radiance,
                             radiance * arguments.lighting.get(&LightingRecord::weight));
}

void illuminate(const IlluminateArguments& arguments) {
  if (arguments.features.lights.without_triangles()) {
    illuminate_by_any(arguments);
    return;
  }
  const mask hit = arguments.hit.get(&HitRecord::hit) != 0;
  const mask at_light = is_light(arguments);
  mask sees = hit & at_light;
  if (arguments.features.coverage) sees = sees & end_shadow_rays(arguments, hit, at_light);
  const vec3<poly<double>> none{0.0, 0.0, 0.0};
  const vec3<poly<double>> light = emission_at_hit(arguments.surface, arguments.sizes, arguments.look_ups) *
                                   arguments.lighting.get(&LightingRecord::weight);
  arguments.direct_light.set(&DirectLightRecord::radiance, cn::select(sees, light, none));
}

void append(const AppendArguments& arguments) {
  const poly<std::int32_t> vertices = arguments.path.get(&PathRecord::vertices);
  const mask ended = arguments.scatter.get(&ScatterRecord::ended) != 0;
  const mask finished = ended | (vertices + 1 >= arguments.slot_vertices);

  vec3<poly<double>> radiance = arguments.scatter.get(&ScatterRecord::radiance);
  cn::poly_if(kept_mask(*arguments.has_direct_light), [&] {
    const vec3<poly<double>> sum = radiance + arguments.direct_light.get(&DirectLightRecord::radiance);
    radiance = sum;
  });
  arguments.vertex.set(&VertexRecord::radiance, radiance);
  arguments.vertex.set(&VertexRecord::weight, arguments.scatter.get(&ScatterRecord::weight));
  const poly<std::int32_t> slot_in_block = cn::pe_num();
  arguments.vertex_place.write(place_of(
      arguments.block_vertices, slot_in_block * arguments.slot_vertices + vertices, sizeof(VertexRecord)));

  const auto& entry = arguments.finished_record;
  entry.set(&FinishedRecord::slot, slot_in_block + arguments.first_slot);
  entry.set(&FinishedRecord::vertices, vertices + 1);
  entry.set(&FinishedRecord::pixel, arguments.path.get(&PathRecord::pixel));
  entry.set(&FinishedRecord::sample, arguments.path.get(&PathRecord::sample));
  entry.set(&FinishedRecord::folded, arguments.path.get(&PathRecord::folded));
  entry.set(&FinishedRecord::ended, arguments.scatter.get(&ScatterRecord::ended));
  cn::keep(ended, *arguments.ended);
  cn::keep(finished, *arguments.finished);
}

void listed_sample(const ListedSampleArguments& arguments) {
  const poly<std::int32_t> number = arguments.number.read();
  arguments.place.write(place_of(arguments.next_listed, number, sizeof(CameraSampleRecord)));
  cn::keep(number < arguments.started, *arguments.starts);
}

/// The sample with that number, of the list or in order.
CameraSample next_sample(const ContinuePathsArguments& arguments, const poly<std::int32_t>& number) {
  if (!arguments.is_listed) return camera_sample(*arguments.camera, arguments.camera_rays, number);
  return {arguments.next_path.get(&PathRecord::pixel), arguments.next_path.get(&PathRecord::sample)};
}

/// The camera ray with that number begins a path.
void start_path(const ContinuePathsArguments& arguments, const poly<std::int32_t>& number) {
  const CameraSample at = next_sample(arguments, number);
  const CameraRay ray = generate_camera_ray(*arguments.camera, arguments.sampler, arguments.seed, at);
  arguments.ray.set(&RayRecord::origin, ray.origin);
  arguments.ray.set(&RayRecord::direction, ray.direction);
  arguments.ray.set(&RayRecord::left_face, poly<std::int32_t>(kNoFace));
  arguments.ray.set(&RayRecord::light_face, poly<std::int32_t>(kNoFace));
  arguments.next_path.set(&PathRecord::pixel, at.pixel);
  arguments.next_path.set(&PathRecord::sample, at.sample);
  arguments.next_path.set(&PathRecord::depth, poly<std::int32_t>(0));
  arguments.next_path.set(&PathRecord::vertices, poly<std::int32_t>(0));
  arguments.next_path.set(&PathRecord::folded, poly<std::int32_t>(0));
  if (arguments.path_has_tail)
    tail<DirectionRecord>(arguments.next_path).set(&DirectionRecord::pdf, poly<double>(kInfinity));
  if (arguments.has_passed)
    passed_behind(arguments.next_path).set(&PassedRecord::distance, poly<double>(0.0));
}

void continue_path(const ContinuePathsArguments& arguments) {
  const mask flushed = kept_mask(*arguments.finished);
  arguments.ray.set(&RayRecord::origin, arguments.scatter.get(&ScatterRecord::position));
  arguments.ray.set(&RayRecord::direction, arguments.scatter.get(&ScatterRecord::direction));
  arguments.ray.set(&RayRecord::left_face, arguments.scatter.get(&ScatterRecord::face));
  arguments.ray.set(&RayRecord::light_face, poly<std::int32_t>(kNoFace));
  arguments.next_path.set(&PathRecord::pixel, arguments.path.get(&PathRecord::pixel));
  arguments.next_path.set(&PathRecord::sample, arguments.path.get(&PathRecord::sample));
  arguments.next_path.set(&PathRecord::depth, arguments.path.get(&PathRecord::depth) + 1);
  const poly<std::int32_t> vertices = arguments.path.get(&PathRecord::vertices) + 1;
  arguments.next_path.set(&PathRecord::vertices, cn::select(flushed, poly<std::int32_t>(0), vertices));
  const poly<std::int32_t> folded = arguments.path.get(&PathRecord::folded);
  arguments.next_path.set(&PathRecord::folded, cn::select(flushed, poly<std::int32_t>(1), folded));
  if (arguments.path_has_tail)
    tail<DirectionRecord>(arguments.next_path)
        .set(&DirectionRecord::pdf, tail<DirectionRecord>(arguments.scatter).get(&DirectionRecord::pdf));
  if (arguments.has_passed)
    passed_behind(arguments.next_path)
        .set(&PassedRecord::distance, passed_behind(arguments.scatter).get(&PassedRecord::distance));
}

/// Chooses the light for the shadow ray of the vertex that the new ray will find. It is chosen this early
/// because the light is loaded together with the vertex.
void choose_light(const ContinuePathsArguments& arguments) {
  const PolyPointer<PathRecord>& path = arguments.next_path;
  const LightNumbers numbers =
      light_numbers(arguments.sampler, arguments.seed, path.get(&PathRecord::pixel),
                    path.get(&PathRecord::sample), path.get(&PathRecord::depth), arguments.light_table);
  path.set(&PathRecord::light_u, numbers.position.u);
  path.set(&PathRecord::light_v, numbers.position.v);
  arguments.light_place.write(place_of(arguments.lights, numbers.light, sizeof(LightRecord)));
}

void continue_paths(const ContinuePathsArguments& arguments) {
  const mask ended = kept_mask(*arguments.ended);
  const poly<std::int32_t> number = arguments.number.read();
  const mask starts = ended & (number < arguments.remaining);
  cn::poly_if_any(starts, [&] { start_path(arguments, number); });
  cn::poly_if_any(!ended, [&] { continue_path(arguments); });
  if (arguments.light_table.cdf != nullptr) choose_light(arguments);
  cn::keep(starts | !ended, *arguments.live);
}

void numbered_place(const NumberedPlaceArguments& arguments) {
  arguments.place.write(place_of(arguments.records, arguments.number.read()));
}

void bin_hit(const BinHitArguments& arguments) {
  const mask hit_something = kept_mask(*arguments.hit_something);
  arguments.hit.set(&BinnedHit::surface_place,
                    cn::select(hit_something, arguments.surface_place.read(), poly<MonoAddress>(0u)));
  arguments.hit.set(&BinnedHit::light_place, arguments.light_place.read());
  arguments.hit.set(&BinnedHit::slot, cn::pe_num() + arguments.first_slot);
}

void locate_slot(const LocateSlotArguments& arguments) {
  const poly<std::int32_t> slot = arguments.slot.read();
  for (int i = 0; i < arguments.places; ++i) arguments.place[i].write(place_of(arguments.records[i], slot));
}

void flag(const FlagArguments& arguments) {
  arguments.flag.write(cn::select(kept_mask(*arguments.lanes), poly<MonoAddress>(1u), poly<MonoAddress>(0u)));
}

void list(const ListArguments& arguments) {
  const FinishedPath& path = arguments.path;
  const poly<std::int32_t> slot = arguments.entry.get(&FinishedRecord::slot);
  const poly<std::int32_t> vertices = arguments.entry.get(&FinishedRecord::vertices);
  const mask ended = arguments.entry.get(&FinishedRecord::ended) != 0;
  path.vertex_place.write(
      place_of(arguments.vertices, slot, std::size_t(arguments.slot_vertices) * sizeof(VertexRecord)));
  path.fold_place.write(place_of(arguments.folds, slot, sizeof(FoldRecord)));
  path.vertices.write(vertices);
  path.pixel.write(cn::select(ended, arguments.entry.get(&FinishedRecord::pixel), poly<std::int32_t>(-1)));
  path.sample.write(arguments.entry.get(&FinishedRecord::sample));
  for (int load = 0; load * kVerticesPerLoad < arguments.slot_vertices; ++load)
    cn::keep(vertices > load * kVerticesPerLoad, arguments.needs_load[load]);
  cn::keep(arguments.entry.get(&FinishedRecord::folded) != 0, *arguments.folded);
  cn::keep(!ended, *arguments.flushed);
}

struct FoldSum {
  vec3<poly<double>> radiance;
  vec3<poly<double>> throughput;
};

/// Prepends the vertices that were folded when the slot was full to those of `sum`.
void join_earlier(const FoldArguments& arguments, FoldSum& sum) {
  cn::poly_if(kept_mask(*arguments.folded), [&] {
    const vec3<poly<double>> throughput = arguments.earlier.get(&FoldRecord::throughput);
    sum.radiance = arguments.earlier.get(&FoldRecord::radiance) + throughput * sum.radiance;
    sum.throughput = throughput * sum.throughput;
  });
}

void save_sum(const FoldArguments& arguments, const FoldSum& sum) {
  arguments.radiance.set(&RadianceRecord::radiance, sum.radiance);
  arguments.radiance.set(&RadianceRecord::pixel, arguments.path.pixel.read());
  arguments.radiance.set(&RadianceRecord::sample, arguments.path.sample.read());
  if (arguments.folded == nullptr) return;
  arguments.flushed.set(&FoldRecord::radiance, sum.radiance);
  arguments.flushed.set(&FoldRecord::throughput, sum.throughput);
}

/// The recursion L = radiance + weight * L, from a path's last vertex to its first. If only a part of the
/// path is here, the product of its weights is kept as well.
void fold(const FoldArguments& arguments) {
  FoldSum sum{{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};
  if (!arguments.starts) {
    sum.radiance = arguments.sum.get(&FoldRecord::radiance);
    if (arguments.folded != nullptr) sum.throughput = arguments.sum.get(&FoldRecord::throughput);
  }
  const poly<std::int32_t> vertices = arguments.path.vertices.read();
  for (int i = kVerticesPerLoad - 1; i >= 0; --i) {
    cn::poly_if(vertices > arguments.first_vertex + i, [&] {
      const PolyPointer<VertexRecord> vertex = arguments.vertices[i];
      const vec3<poly<double>> weight = vertex.get(&VertexRecord::weight);
      sum.radiance = vertex.get(&VertexRecord::radiance) + weight * sum.radiance;
      if (arguments.folded != nullptr) sum.throughput = weight * sum.throughput;
    });
  }
  if (arguments.first_vertex > 0) {
    arguments.sum.set(&FoldRecord::radiance, sum.radiance);
    if (arguments.folded != nullptr) arguments.sum.set(&FoldRecord::throughput, sum.throughput);
    return;
  }
  if (arguments.folded != nullptr) join_earlier(arguments, sum);
  save_sum(arguments, sum);
}

}  // namespace

inline namespace CN_LEVEL {

const Kernels& kernel_table() {
  static const Kernels table{
      cn::kernel<IntersectArguments, intersect>("intersect"),
      tree_search_kernel(),
      cn::kernel<ScatterArguments, scatter>("scatter"),
      cn::kernel<LookUpArguments, look_up>("look_up"),
      cn::kernel<EnvironmentLookUpArguments, look_up_environment>("look_up_environment"),
      cn::kernel<LightCandidatesArguments, find_light_candidates>("find_light_candidates"),
      cn::kernel<LightCandidatesArguments, resample_light>("resample_light"),
      cn::kernel<ShadeArguments, shade>("shade"),
      cn::kernel<IlluminateArguments, illuminate>("illuminate"),
      cn::kernel<AppendArguments, append>("append"),
      cn::kernel<ListedSampleArguments, listed_sample>("listed_sample"),
      cn::kernel<ContinuePathsArguments, continue_paths>("continue_paths"),
      cn::kernel<NumberedPlaceArguments, numbered_place>("finished_place"),
      cn::kernel<ListArguments, list>("list"),
      cn::kernel<FoldArguments, fold>("fold"),
      cn::kernel<BinHitArguments, bin_hit>("bin_hit"),
      cn::kernel<NumberedPlaceArguments, numbered_place>("binned_hit_place"),
      cn::kernel<LocateSlotArguments, locate_slot>("locate_slot"),
      cn::kernel<FlagArguments, flag>("flag"),
      traversal_kernel_table,
      packet_kernel_table,
      large_packet_kernel_table,
      ray_stream_kernel_table,
      stream_kernel_table,
      resident_kernel_table,
      pair_kernel_table,
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
