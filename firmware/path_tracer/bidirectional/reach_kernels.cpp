// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/bidirectional/pair_kernels.hpp"
#include "firmware/path_tracer/bidirectional/path_vertex.hpp"
#include "firmware/path_tracer/bidirectional/weights.hpp"

namespace path_tracer {
namespace {

/// How a segment arrived.
struct Arrival {
  mask is_light;  ///< of a light path
  mask hit;
  mask front;
  Point3 position;
  Direction3 direction;
  poly<double> distance;  ///< from where the ray began, which may be a surface that let it through
  poly<double> whole;     ///< from the vertex before
  Rgb let_through;
  poly<double> distance_squared;  ///< of weights.hpp
  poly<double> inverse_pdf;
  Direction3 normal;  ///< of the triangle, on its front
};

Rgb share_let_through(const ReachArguments& arguments, const mask& is_light, const mask& front,
                      const poly<double>& distance) {
  const poly<double> one = 1.0;
  if (!arguments.features.lobes.absorption) return {one, one, one};
  const Rgb of_light = transmittance(arguments.pair.get(&PairRecord::absorption), distance);
  return cn::select(is_light, of_light, absorb(arguments, front));
}

Arrival arrive(const ReachArguments& arguments) {
  const auto record = tail<ArrivalRecord>(arguments.hit);
  Arrival arrival;
  arrival.is_light = is_ray(arguments.pair.get(&PairRecord::ray), PairRay::light_segment);
  arrival.hit = arguments.hit.get(&HitRecord::hit) != 0;
  arrival.front = arguments.hit.get(&HitRecord::front) != 0;
  bsdf_detail::assign(arrival.position, arguments.hit.get(&HitRecord::position));
  bsdf_detail::assign(arrival.direction, record.get(&ArrivalRecord::direction));
  arrival.distance.assign_all_lanes(record.get(&ArrivalRecord::distance));
  bsdf_detail::assign(arrival.let_through,
                      share_let_through(arguments, arrival.is_light, arrival.front, arrival.distance));
  arrival.whole.assign_all_lanes(arrival.distance);
  if (arguments.features.coverage)
    arrival.whole.assign_all_lanes(
        arrival.distance + passing_of(arguments.pair, arguments.pair_sizes).get(&PassingRecord::distance));
  const mask parallel = arguments.pair.get(&PairRecord::is_parallel) != 0;
  arrival.distance_squared.assign_all_lanes(
      cn::select(parallel, poly<double>(1.0), arrival.whole * arrival.whole));
  arrival.inverse_pdf.assign_all_lanes(
      bounded(arrival.distance_squared / arguments.pair.get(&PairRecord::pdf)));
  bsdf_detail::assign(arrival.normal, arguments.surface.get(&SurfaceRecord::normal));
  return arrival;
}

/// Weight of a hit of a light, strategy 0.
/// @param light_to_direction P(l, x_0) over the cosine there
/// @param pdf density of the light's direction by which light paths leave it
poly<double> weight_of_light_hit(const ReachArguments& arguments, const poly<double>& inverse_pdf,
                                 const poly<double>& distance_squared, const poly<double>& light_pdf,
                                 const poly<double>& emission_pdf) {
  const Window window(arguments.pair, arguments.pair_sizes, arguments.world.light_vertices);
  const poly<double> sum =
      squared(light_pdf) * sum_from(inverse_pdf, arguments.pair.get(&PairRecord::connects), emission_pdf,
                                    distance_squared, window.whole());
  const mask sees_lens = arguments.pair.get(&PairRecord::depth) == 0;
  return cn::select(sees_lens, poly<double>(1.0), 1.0 / (1.0 + sum));
}

/// Whether light paths begin at the surface, if it emits (may_begin_light_paths() of the host).
mask begins_light_paths(const ReachArguments& arguments) {
  mask begins(cn::mask_from_bits(0xff));
  if (!arguments.world.has_silent_lights) return begins;
  const auto has_texture = [&](TextureSlot slot) {
    const auto record = tail<TextureRecord>(arguments.surface, arguments.sizes.texture[int(slot)]);
    return record.get(&TextureRecord::footprints) != poly<MonoAddress>(MonoAddress{0});
  };
  for (const TextureSlot slot : {TextureSlot::emission, TextureSlot::alpha})
    if (arguments.features.textures.looks_up(slot)) begins = begins & !has_texture(slot);
  if (!arguments.features.coverage) return begins;
  const auto coverage = tail<CoverageRecord>(arguments.surface, arguments.sizes.coverage);
  return begins & (coverage.get(&CoverageRecord::alpha) == 1.0);
}

/// Radiance of what an eye path has hit.
Rgb emitted(const ReachArguments& arguments, const Arrival& arrival) {
  const Rgb emission = emission_at_hit(arguments.surface, arguments.sizes, arguments.look_ups);
  const Rgb none{0.0, 0.0, 0.0};
  const mask emits = arrival.hit & arrival.front;
  if (arguments.sizes.aim == RecordSizes::kNone) return cn::select(emits, emission, none);
  const poly<double> cosine = cn::max(-dot(arrival.direction, arrival.normal), poly<double>(kLeastCosine));
  const poly<double> inverse_pdf =
      tail<AimRecord>(arguments.surface, arguments.sizes.aim).get(&AimRecord::inverse_pdf);
  const poly<double> emission_pdf =
      cn::select(begins_light_paths(arguments), cosine * (1.0 / kPi), poly<double>(0.0));
  const poly<double> weight = weight_of_light_hit(arguments, arrival.inverse_pdf, arrival.distance_squared,
                                                  1.0 / (inverse_pdf * cosine), emission_pdf);
  return cn::select(emits, emission * weight, none);
}

/// Suns that an eye path sees. The disk of a sun is found as the texels of an environment's image are.
Rgb pair_radiance_of_suns(const ReachArguments& arguments, const Arrival& arrival) {
  Rgb sum{0.0, 0.0, 0.0};
  const poly<double> one = 1.0;
  const double disk_pdf = 1.0 / (kPi * arguments.world.radius * arguments.world.radius);
  const poly<double> inverse_pdf = bounded(one / arguments.pair.get(&PairRecord::pdf));
  for (int i = 0; i < arguments.sun_count; ++i) {
    const SunRecord& sun = arguments.suns[i];
    cn::issue(cn::InstructionClass::mono, 8);
    cn::poly_if_any(along_axis(arrival.direction, sun.direction) >= sun.cosine, [&] {
      const poly<double> weight =
          weight_of_light_hit(arguments, inverse_pdf, one, poly<double>(arguments.sun_pdfs[i]), disk_pdf);
      sum = sum + Rgb{sun.radiance.x, sun.radiance.y, sun.radiance.z} * weight;
    });
  }
  return sum;
}

/// Radiance of what an eye path sees that has hit nothing.
Rgb radiance_of_sky(const ReachArguments& arguments, const Arrival& arrival) {
  const vec3<double>& constant = arguments.environment;
  Rgb radiance =
      arguments.features.environment ? Rgb{constant.x, constant.y, constant.z} : Rgb{0.0, 0.0, 0.0};
  if (arguments.features.lights.environment) {
    const auto texel = tail<EnvironmentLookUp>(arguments.look_ups, arguments.sizes.environment)
                           .part(&EnvironmentLookUp::texel);
    const poly<double> pdf = arguments.pair.get(&PairRecord::pdf);
    const double disk_pdf = 1.0 / (kPi * arguments.world.radius * arguments.world.radius);
    const poly<double> one = 1.0;
    const poly<double> weight = weight_of_light_hit(
        arguments, bounded(one / pdf), one, cn::convert<double>(texel.get(&EnvironmentTexel::pdf)), disk_pdf);
    bsdf_detail::assign(radiance, radiance + radiance_of(texel) * weight);
  }
  if (arguments.features.lights.distant)
    bsdf_detail::assign(radiance, radiance + pair_radiance_of_suns(arguments, arrival));
  return radiance;
}

/// What the segment adds to the eye path.
void add_radiance(const ReachArguments& arguments, const Arrival& arrival, const Rgb& throughput) {
  const Rgb outside = radiance_of_sky(arguments, arrival) * throughput;
  const Rgb inside = emitted(arguments, arrival) * throughput * arrival.let_through;
  const Rgb radiance = arguments.pair.get(&PairRecord::radiance);
  arguments.pair.set(&PairRecord::radiance, radiance + cn::select(arrival.hit, inside, outside));
}

/// The normal of shading on the front, before it is known who looks.
Direction3 front_shading_normal(const ReachArguments& arguments, const Arrival& arrival) {
  Direction3 unit = arguments.features.normals
                        ? interpolated_normal(arguments, arrival.position, arrival.normal)
                        : arrival.normal;
  if (arguments.features.textures.has(TextureSlot::normal))
    bsdf_detail::assign(unit, mapped_normal(arguments, arrival.position, unit));
  return unit;
}

/// The throughput with which a segment arrives. A light path's first one brings the sky's radiance, whose
/// texel was not known before.
Rgb arriving_throughput(const ReachArguments& arguments, const Arrival& arrival) {
  Rgb throughput = arguments.pair.get(&PairRecord::throughput);
  if (!arguments.features.lights.environment) return throughput;
  const auto texel = tail<EnvironmentLookUp>(arguments.look_ups, arguments.sizes.environment)
                         .part(&EnvironmentLookUp::texel);
  const mask is_of_sky = arrival.is_light & (arguments.pair.get(&PairRecord::target_face) ==
                                             poly<std::int32_t>(kEnvironmentFace));
  bsdf_detail::assign(throughput, cn::select(is_of_sky, throughput * radiance_of(texel), throughput));
  return throughput;
}

PathVertex vertex_at_hit(const ReachArguments& arguments, const Arrival& arrival, const Rgb& throughput) {
  const mask all(cn::mask_from_bits(0xff));
  PathVertex vertex{};
  bsdf_detail::assign(vertex.position, arrival.position);
  bsdf_detail::assign(vertex.normal, arrival.normal);
  if (arguments.features.shading_normals())
    bsdf_detail::assign(vertex.shading_normal, front_shading_normal(arguments, arrival));
  bsdf_detail::assign(vertex.to_previous, arrival.direction * -1.0);
  bsdf_detail::assign(vertex.throughput, throughput * arrival.let_through);
  vertex.material = read_material(arguments, all);
  if (arguments.features.lobes.absorption)
    bsdf_detail::assign(vertex.absorption,
                        tail<AbsorptionRecord>(arguments.surface, arguments.sizes.absorption)
                            .get(&AbsorptionRecord::coefficient));
  vertex.inverse_pdf.assign_all_lanes(arrival.inverse_pdf);
  vertex.distance_squared.assign_all_lanes(arrival.distance_squared);
  vertex.connects_before.assign_all_lanes(arguments.pair.get(&PairRecord::connects));
  vertex.light_sum.assign_all_lanes(arguments.pair.get(&PairRecord::light_sum));
  vertex.face.assign_all_lanes(arguments.surface.get(&SurfaceRecord::face));
  return vertex;
}

/// Where a single direction is the same from both of its ends, as it must be for strategies to share it.
mask is_same_from_both_ends(const Bsdf& here, const Bsdf& there, const Direction3& to_previous) {
  const mask all(cn::mask_from_bits(0xff));
  if (!here.config.shading_normals) return all;
  const poly<double> turn = dot(here.point.normal, there.point.normal);
  const mask same_normal = cn::abs(turn) > 1.0 - 1e-9;
  return same_normal & bsdf_detail::light_side(there, to_previous).lit;
}

/// Factor of a light path's throughput where it goes on in a single direction.
poly<double> single_direction_factor(const Bsdf& bsdf, const BsdfSample& sample, const PathVertex& vertex) {
  poly<double> factor = roulette_factor(bsdf, sample);
  if (!bsdf.config.shading_normals) return factor;
  const Direction3& normal = bsdf.point.normal;
  const poly<double> shading = cn::abs(dot(normal, vertex.to_previous)) /
                               cn::max(cn::abs(dot(normal, sample.direction)), poly<double>(kLeastCosine));
  return factor * shading * cosine_ratio(vertex, sample.direction, vertex.to_previous);
}

/// A way on from a vertex.
struct WayOn {
  Direction3 direction;
  Rgb weight;
  poly<double> pdf;
  poly<double> reverse_pdf;
  mask is_single;            ///< direction without a density
  poly<double> survival_of;  ///< what roulette looks at
};

WayOn go_on(const Arrival& arrival, const PathVertex& vertex, const Bsdf& bsdf, const BsdfSample& sample) {
  const Bsdf other = bsdf_from(bsdf.config, vertex, sample.direction);
  const BsdfValue back = evaluate_bsdf(other, vertex.to_previous);
  const poly<double> one = 1.0;
  const poly<double> none = 0.0;
  const poly<double> pdf = cn::select(sample.is_delta | (sample.pdf == 0.0), one, sample.pdf);
  const Rgb of_light = back.value * (cosine_ratio(vertex, sample.direction, vertex.to_previous) / pdf);
  Rgb weight = cn::select(arrival.is_light, of_light, sample.weight);
  poly<double> reverse_pdf = back.pdf;
  if (bsdf.config.lobes.smooth_specular() || bsdf.config.lobes.coat) {
    const mask same = is_same_from_both_ends(bsdf, other, vertex.to_previous);
    const Rgb single = sample.weight * single_direction_factor(bsdf, sample, vertex);
    const Rgb used = cn::select(same, single, Rgb{none, none, none});
    bsdf_detail::assign(weight, cn::select(sample.is_delta & arrival.is_light, used, weight));
    reverse_pdf.assign_all_lanes(cn::select(sample.is_delta, cn::select(same, one, none), reverse_pdf));
  }
  return {sample.direction, weight,          pdf,
          reverse_pdf,      sample.is_delta, largest_channel(sample.weight) * roulette_factor(bsdf, sample)};
}

/// Whether roulette lets the path go on, and the factor if it does.
struct Survival {
  mask survives;
  poly<double> factor;
};
Survival play_roulette(const ReachArguments& arguments, const WayOn& way, const BsdfSample& sample,
                       const poly<double>& number) {
  const poly<double> survival =
      survival_of(arguments, arguments.pair.get(&PairRecord::depth), sample, way.survival_of);
  const mask survives = (way.survival_of > 0.0) & (number < survival) & (largest_channel(way.weight) > 0.0);
  return {survives, 1.0 / cn::select(survives, survival, poly<double>(1.0))};
}

/// Whether light vertices may be joined with the eye vertex: a bit each.
poly<std::uint32_t> joinable(const ReachArguments& arguments, const PathVertex& vertex,
                             const Direction3& side, const mask& both_sides) {
  poly<std::uint32_t> bits = 0u;
  const poly<std::int32_t> count = arguments.pair.get(&PairRecord::light_vertices);
  for (int i = 0; i < arguments.world.light_vertices; ++i)
    cn::poly_if_any(count > i, [&] {
      const PolyPointer<LightHeadRecord> head = arguments.heads[i];
      const poly<std::int32_t> sides = head.get(&LightHeadRecord::sides);
      const Direction3 to_light = head.get(&LightHeadRecord::position) - vertex.position;
      const mask faces_here = both_sides | (dot(to_light, side) > 0.0);
      const mask faces_there =
          (sides == 2) | ((dot(to_light, head.get(&LightHeadRecord::normal)) < 0.0) & (sides == 1));
      bits = cn::select(faces_here & faces_there, bits | poly<std::uint32_t>(1u << i), bits);
    });
  return bits;
}

/// What the vertex is to be joined with.
poly<std::uint32_t> connections_of(const ReachArguments& arguments, const Arrival& arrival,
                                   const PathVertex& vertex, const mask& is_wide, const Direction3& side,
                                   const mask& both_sides) {
  const poly<std::uint32_t> last = 1u << arguments.world.light_vertices;
  const poly<std::uint32_t> none = 0u;
  const SeenPoint seen = see_point(arguments.world.lens, vertex.position);
  const mask faces_lens = seen.is_seen & (both_sides | (dot(side, seen.to_lens) > 0.0));
  poly<std::uint32_t> of_eye = arguments.world.has_lights ? last : none;
  cn::poly_if_any(!arrival.is_light,
                  [&] { of_eye = of_eye | joinable(arguments, vertex, side, both_sides); });
  const poly<std::uint32_t> all = cn::select(arrival.is_light, cn::select(faces_lens, last, none), of_eye);
  return cn::select(is_wide & arrival.hit, all, none);
}

void store_head(const ReachArguments& arguments, const PathVertex& vertex, const Direction3& side,
                const mask& is_wide, const mask& both_sides) {
  arguments.head.set(&LightHeadRecord::position, vertex.position);
  arguments.head.set(&LightHeadRecord::normal, side);
  const poly<std::int32_t> sides = cn::select(both_sides, poly<std::int32_t>(2), poly<std::int32_t>(1));
  arguments.head.set(&LightHeadRecord::sides, cn::select(is_wide, sides, poly<std::int32_t>(0)));
}

/// Where the vertex and its head go. The eye path's vertex has the place behind the light path's.
void place_vertex(const ReachArguments& arguments, const Arrival& arrival) {
  const int kept = arguments.world.light_vertices;
  const poly<std::int32_t> slot = cn::pe_num();
  const poly<std::int32_t> count = arguments.pair.get(&PairRecord::light_vertices);
  const poly<std::int32_t> number = cn::select(arrival.is_light, count, poly<std::int32_t>(kept));
  arguments.vertex_place.write(place_of(arguments.block_vertices, slot * (kept + 1) + number,
                                        std::size_t(arguments.pair_sizes.vertex)));
  arguments.head_place.write(place_of(arguments.block_heads, slot * kept + count, sizeof(LightHeadRecord)));
}

void advance_sums(const ReachArguments& arguments, const Arrival& arrival) {
  cn::poly_if_any(arrival.is_light,
                  [&] { arguments.pair.set(&PairRecord::light_sum, advanced_light_sum(arguments.pair)); });
  cn::poly_if_any(!arrival.is_light, [&] {
    Window(arguments.pair, arguments.pair_sizes, arguments.world.light_vertices).advance(arguments.pair);
  });
}

BsdfSample sample_way_on(const ReachArguments& arguments, const Arrival& arrival, const Bsdf& bsdf,
                         poly<double>& roulette) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const poly<std::int32_t> pixel = pair.get(&PairRecord::pixel);
  const poly<std::int32_t> number = pair.get(&PairRecord::sample);
  const poly<std::int32_t> depth = pair.get(&PairRecord::depth);
  const auto purpose = [&](Purpose of_light, Purpose of_eye) {
    return cn::select(arrival.is_light, word_of(of_light), word_of(of_eye));
  };
  const ScatterNumbers random = scatter_numbers(arguments.sampler, arguments.seed, pixel, number, depth,
                                                purpose(Purpose::light_scatter, Purpose::scatter));
  roulette.assign_all_lanes(random.roulette);
  const poly<double> lobe = arguments.features.lobes.only_diffuse()
                                ? random.roulette
                                : lobe_number(arguments.sampler, arguments.seed, pixel, number, depth,
                                              purpose(Purpose::light_lobe, Purpose::lobe));
  return sample_bsdf(bsdf, random.direction, lobe);
}

void write_way_on(const ReachArguments& arguments, const Arrival& arrival, const PathVertex& vertex,
                  const WayOn& way, const Survival& survival) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const poly<std::int32_t> count = pair.get(&PairRecord::light_vertices);
  const mask has_room = (!arrival.is_light) | (count + 1 < arguments.world.light_vertices);
  const mask goes_on = arrival.hit & survival.survives & has_room;
  pair.set(&PairRecord::goes_on, cn::select(goes_on, poly<std::int32_t>(1), poly<std::int32_t>(0)));
  pair.set(&PairRecord::light_vertices, cn::select(arrival.is_light & arrival.hit, count + 1, count));
  pair.set(&PairRecord::depth, pair.get(&PairRecord::depth) + 1);
  pair.set(&PairRecord::position, vertex.position);
  pair.set(&PairRecord::direction, way.direction);
  pair.set(&PairRecord::face, vertex.face);
  pair.set(&PairRecord::target_face, poly<std::int32_t>(kNoFace));
  pair.set(&PairRecord::is_parallel, poly<std::int32_t>(0));
  pair.set(&PairRecord::throughput, vertex.throughput * way.weight * survival.factor);
  pair.set(&PairRecord::pdf, way.pdf);
  pair.set(&PairRecord::reverse_pdf, way.reverse_pdf);
  pair.set(&PairRecord::inverse_pdf, vertex.inverse_pdf);
  pair.set(&PairRecord::distance_squared, vertex.distance_squared);
  pair.set(&PairRecord::connects_before, vertex.connects_before);
  pair.set(&PairRecord::connects, one_or_none(!way.is_single));
  if (!arguments.features.lobes.absorption) return;
  const mask behind = dot(vertex.normal, way.direction) < 0.0;
  const poly<double> none = 0.0;
  pair.set(&PairRecord::absorption, cn::select(behind, vertex.absorption, Rgb{none, none, none}));
}

/// The surface is where the segment hit it, or there is none: a vertex, or the end of the path.
void end_segment(const ReachArguments& arguments, const Arrival& arrival) {
  if (arguments.features.coverage) forget_passing(arguments.pair, arguments.pair_sizes);
  advance_sums(arguments, arrival);
  const Rgb throughput = arriving_throughput(arguments, arrival);
  cn::poly_if_any(!arrival.is_light, [&] { add_radiance(arguments, arrival, throughput); });

  const PathVertex vertex = vertex_at_hit(arguments, arrival, throughput);
  const BsdfConfig config = pair_bsdf_config(arguments.features, arguments.skips_absent_lobes);
  const Bsdf bsdf = bsdf_from(config, vertex, vertex.to_previous);
  const mask is_wide = scatters_widely(bsdf);
  const mask both_sides = passes_light(config.lobes, vertex.material);
  const Direction3& side = bsdf.point.geometric_normal;
  arguments.pair.set(&PairRecord::connections,
                     connections_of(arguments, arrival, vertex, is_wide, side, both_sides));
  store_vertex(vertex, arguments.pair_sizes, config.lobes, arguments.vertex);
  store_head(arguments, vertex, side, is_wide, both_sides);
  place_vertex(arguments, arrival);

  poly<double> roulette;
  const BsdfSample sample = sample_way_on(arguments, arrival, bsdf, roulette);
  const WayOn way = go_on(arrival, vertex, bsdf, sample);
  write_way_on(arguments, arrival, vertex, way, play_roulette(arguments, way, sample, roulette));
  cn::keep(arrival.hit, *arguments.is_vertex);
  cn::keep(arrival.hit & arrival.is_light, *arguments.is_light_vertex);
  observe_lobes(bsdf, arrival.front, arrival.hit, *arguments.lobe_use);
}

/// Where the surface that a segment hit lets it through.
mask lets_segment_through(const ReachArguments& arguments, const Arrival& arrival) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const auto chance = [&] {
    return coverage_number(
        arguments.sampler, arguments.seed, pair.get(&PairRecord::pixel), pair.get(&PairRecord::sample),
        pair.get(&PairRecord::depth), arguments.surface.get(&SurfaceRecord::face),
        cn::select(arrival.is_light, word_of(Purpose::light_coverage), word_of(Purpose::coverage)));
  };
  return arrival.hit & lets_through(arguments.features, arguments.sizes, arguments.surface,
                                    arguments.look_ups, arrival.front, chance);
}

/// The segment goes straight on: no vertex, and its densities are those of the whole.
void pass_segment_on(const ReachArguments& arguments, const Arrival& arrival) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  pair.set(&PairRecord::position, arrival.position);
  pair.set(&PairRecord::face, arguments.surface.get(&SurfaceRecord::face));
  if (arguments.features.lobes.absorption)
    pair.set(&PairRecord::throughput, pair.get(&PairRecord::throughput) * arrival.let_through);
  const auto passing = passing_of(pair, arguments.pair_sizes);
  passing.set(&PassingRecord::distance, arrival.whole);
  passing.set(&PassingRecord::passes, poly<std::int32_t>(1));
}

void reach(const ReachArguments& arguments) {
  const Arrival arrival = arrive(arguments);
  if (!arguments.features.coverage) {
    end_segment(arguments, arrival);
    return;
  }
  const mask passes = lets_segment_through(arguments, arrival);
  cn::poly_if_any(passes, [&] { pass_segment_on(arguments, arrival); });
  cn::poly_if(!passes, [&] { end_segment(arguments, arrival); });
}

}  // namespace

inline namespace CN_LEVEL {

cn::Kernel<ReachArguments> reach_kernel() {
  return cn::kernel<ReachArguments, reach>("reach");
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
