// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/bidirectional/pair_kernels.hpp"
#include "firmware/path_tracer/bidirectional/path_vertex.hpp"
#include "firmware/path_tracer/kernels/coverage.hpp"

namespace path_tracer {
namespace {

/// Whether nothing stands between both ends of a connection.
mask is_unblocked(const SeeArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const poly<std::int32_t> target = pair.get(&PairRecord::target_face);
  const mask hit = arguments.hit.get(&HitRecord::hit) != 0;
  const poly<double> distance = tail<ArrivalRecord>(arguments.hit).get(&ArrivalRecord::distance);
  mask at_target = arguments.surface.get(&SurfaceRecord::face) == target;
  if (arguments.is_in_layers) {
    const poly<std::int32_t> light = pair.get(&PairRecord::target_light);
    at_target = at_target & ((light == poly<std::int32_t>(kNoLight)) |
                             (arguments.surface.get(&SurfaceRecord::light) == light));
  }
  const mask is_near = target == poly<std::int32_t>(kNoFace);  // a lens or a light at a point
  return (hit & at_target & (target >= 0)) | (is_near & !(hit & (distance < 1.0))) |
         ((target < kNoFace) & !hit);
}

/// The light's radiance, where a connection does not have it yet.
Rgb radiance_at_light(const SeeArguments& arguments, const mask& to_light) {
  const poly<double> one = 1.0;
  const Rgb ones{one, one, one};
  const poly<std::int32_t> target = arguments.pair.get(&PairRecord::target_face);
  Rgb radiance = ones;
  if (arguments.features.lights.surfaces)
    bsdf_detail::assign(
        radiance, cn::select(to_light & (target >= 0),
                             emission_at_hit(arguments.surface, arguments.sizes, arguments.look_ups), ones));
  if (!arguments.features.lights.environment) return radiance;
  const auto texel = tail<EnvironmentLookUp>(arguments.look_ups, arguments.sizes.environment)
                         .part(&EnvironmentLookUp::texel);
  bsdf_detail::assign(radiance,
                      cn::select(to_light & (target == kEnvironmentFace), radiance_of(texel), radiance));
  return radiance;
}

/// Where the surface that a connection's ray hit lets it through. Each kind of connection has numbers of its
/// own, so that no path depends on what another one found.
mask lets_connection_through(const SeeArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const auto chance = [&] {
    const poly<std::int32_t> ray = pair.get(&PairRecord::ray);
    const mask to_vertex = is_ray(ray, PairRay::light_vertex);
    const poly<std::int32_t> depth = pair.get(&PairRecord::depth);
    const poly<std::int32_t> of_vertices = depth * kMaxLightVertices + pair.get(&PairRecord::target);
    const poly<std::uint32_t> purpose =
        cn::select(to_vertex, word_of(Purpose::light_vertex_coverage),
                   cn::select(is_ray(ray, PairRay::lens), word_of(Purpose::lens_coverage),
                              word_of(Purpose::light_sample_coverage)));
    return coverage_number(arguments.sampler, arguments.seed, pair.get(&PairRecord::pixel),
                           pair.get(&PairRecord::sample), cn::select(to_vertex, of_vertices, depth),
                           arguments.surface.get(&SurfaceRecord::face), purpose);
  };
  return (arguments.hit.get(&HitRecord::hit) != 0) &
         lets_through(arguments.features, arguments.sizes, arguments.surface, arguments.look_ups,
                      arguments.hit.get(&HitRecord::front) != 0, chance);
}

/// Lets connections go on that a surface lets through before their end.
/// @param at_end where nothing else is in between
/// @return where they are at their end, and a light is there
mask pass_connections_on(const SeeArguments& arguments, const mask& at_end) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const mask passes = lets_connection_through(arguments);
  const poly<std::int32_t> target = pair.get(&PairRecord::target_face);
  const auto arrival = tail<ArrivalRecord>(arguments.hit);
  const mask ends_near = target == poly<std::int32_t>(kNoFace);
  const poly<double> rest =
      cn::select(ends_near, 1.0 - arrival.get(&ArrivalRecord::distance), poly<double>(1.0));
  const PolyPointer<PassingRecord> passing = passing_of(pair, arguments.pair_sizes);
  passing.set(&PassingRecord::origin, arguments.hit.get(&HitRecord::position));
  passing.set(&PassingRecord::direction, arrival.get(&ArrivalRecord::direction) * rest);
  passing.set(&PassingRecord::face, arguments.surface.get(&SurfaceRecord::face));
  passing.set(&PassingRecord::passes,
              cn::select(passes & !at_end, poly<std::int32_t>(1), poly<std::int32_t>(0)));
  const mask is_no_light = is_ray(pair.get(&PairRecord::ray), PairRay::light_sample) & (target >= 0) & passes;
  return at_end & !is_no_light;
}

void see(const SeeArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const poly<std::int32_t> ray = pair.get(&PairRecord::ray);
  const mask to_lens = is_ray(ray, PairRay::lens);
  mask sees = is_unblocked(arguments);
  if (arguments.features.coverage) sees = pass_connections_on(arguments, sees);
  const Rgb light =
      pair.get(&PairRecord::contribution) * radiance_at_light(arguments, is_ray(ray, PairRay::light_sample));
  const poly<double> zero = 0.0;
  const Rgb brought = cn::select(sees, light, Rgb{zero, zero, zero});
  const mask reaches_lens = to_lens & (largest_channel(brought) > 0.0);
  const Rgb radiance = pair.get(&PairRecord::radiance);
  pair.set(&PairRecord::radiance, cn::select(to_lens, radiance, radiance + brought));
  arguments.result.set(&RadianceRecord::radiance, brought);
  arguments.result.set(&RadianceRecord::pixel, pair.get(&PairRecord::target));
  arguments.result.set(&RadianceRecord::sample, poly<std::int32_t>(kSplatSample));
  cn::keep(reaches_lens, *arguments.is_result);
}

/// The lowest connection that is left, or `none`.
poly<std::int32_t> first_connection(const poly<std::uint32_t>& bits, int none) {
  poly<std::int32_t> first = none;
  for (int i = none - 1; i >= 0; --i)
    first = cn::select((bits & poly<std::uint32_t>(1u << i)) != poly<std::uint32_t>(0u),
                       poly<std::int32_t>(i), first);
  return first;
}

/// What slots do next whose ray has ended.
void decide_next(const DecideArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const int kept = arguments.light_vertices;
  const auto number_of = [](PairRay ray) { return poly<std::int32_t>(static_cast<std::int32_t>(ray)); };
  const poly<std::int32_t> ray = pair.get(&PairRecord::ray);
  const mask is_light = is_ray(ray, PairRay::light_segment) | is_ray(ray, PairRay::lens);
  const poly<std::uint32_t> bits = pair.get(&PairRecord::connections);
  const poly<std::int32_t> first = first_connection(bits, kept + 1);
  const mask connects = first <= kept;
  const mask to_vertex = first < kept;
  const mask goes_on = pair.get(&PairRecord::goes_on) != 0;
  const poly<std::int32_t> connection =
      cn::select(is_light, number_of(PairRay::lens),
                 cn::select(to_vertex, number_of(PairRay::light_vertex), number_of(PairRay::light_sample)));
  const poly<std::int32_t> segment = cn::select(
      is_light, cn::select(goes_on, number_of(PairRay::light_segment), number_of(PairRay::eye_start)),
      number_of(PairRay::eye_segment));
  pair.set(&PairRecord::ray, cn::select(connects, connection, segment));
  pair.set(&PairRecord::target, first);
  pair.set(&PairRecord::connections, bits & (bits - 1u));
  const mask ended = (!is_light) & (!connects) & !goes_on;
  cn::poly_if_any(ended, [&] {
    arguments.result.set(&RadianceRecord::radiance, pair.get(&PairRecord::radiance));
    arguments.result.set(&RadianceRecord::pixel, pair.get(&PairRecord::pixel));
    arguments.result.set(&RadianceRecord::sample, pair.get(&PairRecord::sample));
  });
  cn::keep(ended, *arguments.ended);
}

void decide(const DecideArguments& arguments) {
  if (arguments.pair_sizes.passing == 0) {
    decide_next(arguments);
  } else {
    cn::poly_if(!has_passed(arguments.pair, arguments.pair_sizes), [&] { decide_next(arguments); });
  }
}

void begin_pair(const BeginPairArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const poly<std::int32_t> number = arguments.number.read();
  if (!arguments.is_listed) {
    const CameraSample at = camera_sample(*arguments.camera, arguments.order, number);
    pair.set(&PairRecord::pixel, at.pixel);
    pair.set(&PairRecord::sample, at.sample);
  }
  const PairRay first = arguments.has_lights ? PairRay::light_start : PairRay::eye_start;
  pair.set(&PairRecord::ray, poly<std::int32_t>(static_cast<std::int32_t>(first)));
  pair.set(&PairRecord::depth, poly<std::int32_t>(0));
  pair.set(&PairRecord::light_vertices, poly<std::int32_t>(0));
  pair.set(&PairRecord::connections, poly<std::uint32_t>(0u));
  cn::keep(number < poly<std::int32_t>(arguments.remaining), *arguments.begins);
}

void locate_far(const LocateFarArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const poly<std::int32_t> ray = pair.get(&PairRecord::ray);
  const int kept = arguments.light_vertices;
  const poly<std::int32_t> first = cn::pe_num() * (kept + 1);
  mask to_lens = is_ray(ray, PairRay::lens);
  mask to_light = is_ray(ray, PairRay::light_sample);
  mask to_vertex = is_ray(ray, PairRay::light_vertex);
  if (arguments.pair_sizes.passing != 0) {
    const mask is_new = !has_passed(pair, arguments.pair_sizes);
    to_lens = to_lens & is_new;
    to_light = to_light & is_new;
    to_vertex = to_vertex & is_new;
  }
  const mask starts = is_ray(ray, PairRay::light_start);
  const auto bytes = std::size_t(arguments.vertex_bytes);
  const poly<std::int32_t> newest =
      cn::select(to_lens, pair.get(&PairRecord::light_vertices) - 1, poly<std::int32_t>(kept));
  arguments.near_place.write(place_of(arguments.block_vertices, first + newest, bytes));
  arguments.far_place.write(place_of(arguments.block_vertices, first + pair.get(&PairRecord::target), bytes));
  cn::keep(to_lens | to_light | to_vertex, *arguments.needs_near);
  cn::keep(to_light | is_ray(ray, PairRay::light_segment) | is_ray(ray, PairRay::eye_segment),
           *arguments.needs_segment);
  cn::keep(starts | is_ray(ray, PairRay::eye_start), *arguments.starts);
  cn::keep(to_vertex, *arguments.needs_far);
  cn::keep(to_light | starts, *arguments.needs_light);
  cn::keep(arguments.has_silent_lights ? to_light | starts : starts, *arguments.needs_emission);
  if (arguments.light_table.cdf == nullptr) return;
  const LightNumbers numbers =
      light_numbers(arguments.sampler, arguments.seed, pair.get(&PairRecord::pixel),
                    pair.get(&PairRecord::sample), pair.get(&PairRecord::depth), arguments.light_table,
                    cn::select(starts, word_of(Purpose::light_start), word_of(Purpose::light)));
  pair.set(&PairRecord::light_u, numbers.position.u);
  pair.set(&PairRecord::light_v, numbers.position.v);
  arguments.light_place.write(place_of(arguments.lights, numbers.light, sizeof(LightRecord)));
  arguments.emission_place.write(
      place_of(arguments.light_emission, numbers.light, sizeof(LightEmissionRecord)));
}

void copy_pair(const CopyPairArguments& arguments) {
  for (int i = 0; i < arguments.bytes; i += int{sizeof(std::uint64_t)}) {
    const PolyField<std::uint64_t> from{arguments.from_offset + i};
    PolyField<std::uint64_t>{arguments.to_offset + i}.write(from.read());
  }
}

void look_up_sky(const SkyLookUpArguments& arguments) {
  const Direction3 direction = tail<ArrivalRecord>(arguments.hit).get(&ArrivalRecord::direction);
  const mask of_light = is_ray(arguments.pair.get(&PairRecord::ray), PairRay::light_segment);
  const mask from_sky =
      of_light & (arguments.pair.get(&PairRecord::target_face) == poly<std::int32_t>(kEnvironmentFace));
  arguments.look_up.set(&EnvironmentLookUp::place,
                        place_in_image(arguments.image, cn::select(of_light, direction * -1.0, direction)));
  const mask hit = arguments.hit.get(&HitRecord::hit) != 0;
  cn::keep((hit & from_sky) | !(hit | of_light), *arguments.needs);
}

}  // namespace

inline namespace CN_LEVEL {

cn::Kernel<ReachArguments> reach_kernel();
cn::Kernel<ConnectArguments> connect_kernel();

const PairKernels& pair_kernel_table() {
  static const PairKernels table{
      reach_kernel(),
      cn::kernel<SeeArguments, see>("see"),
      cn::kernel<DecideArguments, decide>("decide"),
      cn::kernel<BeginPairArguments, begin_pair>("begin_pair"),
      cn::kernel<LocateFarArguments, locate_far>("locate_far"),
      connect_kernel(),
      cn::kernel<CopyPairArguments, copy_pair>("copy_pair"),
      cn::kernel<SkyLookUpArguments, look_up_sky>("look_up_sky"),
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
