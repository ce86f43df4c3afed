// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/bidirectional/light_start.hpp"
#include "firmware/path_tracer/bidirectional/pair_kernels.hpp"

namespace path_tracer {
namespace {

/// The ray of a connection, and what it brings.
struct Connection {
  Direction3 direction;
  Rgb contribution;
  poly<std::int32_t> target_face;
  poly<std::int32_t> target_light;
  poly<std::int32_t> searched_face;  ///< RayRecord::light_face
  poly<std::int32_t> target;         ///< PairRecord::target
};

BsdfConfig config_of(const ConnectArguments& arguments) {
  return pair_bsdf_config(arguments.features, arguments.skips_absent_lobes);
}

poly<double> weight_of(const poly<double>& light_side, const poly<double>& eye_side) {
  return 1.0 / (1.0 + light_side + eye_side);
}

/// The sum over strategies that take less from the light than a vertex of the light path.
/// @param density P(e, vertex)
poly<double> light_side_sum(const PathVertex& vertex, const poly<double>& density,
                            const poly<double>& pdf_to_light) {
  return squared(density) * sum_from(vertex.inverse_pdf, vertex.connects_before, pdf_to_light,
                                     vertex.distance_squared, vertex.light_sum);
}

/// The sum over the strategies that take more from the light than what a vertex of the eye path is joined
/// with.
/// @param density P(l, vertex)
/// @param strategies how many there are at most
poly<double> eye_side_sum(const ConnectArguments& arguments, const PathVertex& vertex,
                          const poly<double>& density, const poly<double>& pdf_to_eye,
                          const poly<std::int32_t>& strategies) {
  const Window window(arguments.pair, arguments.pair_sizes, arguments.world.light_vertices);
  const poly<double> sum = squared(density) * sum_from(vertex.inverse_pdf, vertex.connects_before, pdf_to_eye,
                                                       vertex.distance_squared, window.sum(strategies - 1));
  return cn::select(strategies > 0, sum, poly<double>(0.0));
}

/// A direction with its length.
struct Span {
  Direction3 direction;  ///< of unit length
  poly<double> length;
};
Span span_of(const Direction3& whole) {
  const poly<double> length = cn::sqrt(cn::max(dot(whole, whole), poly<double>(kNotZero)));
  return {whole * (1.0 / length), length};
}

/// Whether light paths begin at a light that has triangles.
mask emits(const PolyPointer<LightEmissionRecord>& emission) {
  return largest_channel(emission.get(&LightEmissionRecord::radiance)) > 0.0;
}

/// Light path to lens.
void connect_to_lens(const ConnectArguments& arguments, const PathVertex& near, Connection& connection) {
  const Lens& lens = arguments.world.lens;
  const SeenPoint seen = see_point(lens, near.position);
  const Span to_lens = span_of(seen.to_lens);
  const Scattering scattering =
      scatter_between(config_of(arguments), near, to_lens.direction, near.to_previous);
  const poly<double> one = 1.0;
  const poly<double> distance_squared = lens.is_orthographic ? one : to_lens.length * to_lens.length;
  const poly<double> density = camera_ray_pdf(lens, to_lens.direction * -1.0) / distance_squared;
  const poly<double> weight = weight_of(
      light_side_sum(near, density * (1.0 / lens.pixels()), scattering.pdf_to_light), poly<double>(0.0));
  const poly<double> scale =
      weight * density * (1.0 / lens.pixels()) * cosine_ratio(near, to_lens.direction, near.to_previous);
  connection.direction = seen.to_lens;
  connection.contribution = near.throughput * scattering.value * scale *
                            let_through(arguments.features.lobes, near, to_lens.direction, to_lens.length);
  connection.target_face = kNoFace;
  connection.searched_face = kNoFace;
  connection.target = seen.pixel;
}

/// Eye path to a point of a light.
void connect_to_light(const ConnectArguments& arguments, const PathVertex& near, Connection& connection) {
  const BsdfConfig config = config_of(arguments);
  const mask both_sides = passes_light(config.lobes, near.material);
  const Direction3& to_previous = near.to_previous;
  const Direction3 normal = cn::select(dot(near.normal, to_previous) > 0.0, near.normal, near.normal * -1.0);
  SampledLight light = sample_light_from(arguments, near.position, normal, both_sides);
  if (arguments.world.has_silent_lights) {
    const mask is_silent = (arguments.light.get(&LightRecord::face) >= 0) & !emits(arguments.emission);
    light.emission_density.assign_all_lanes(cn::select(is_silent, poly<double>(0.0), light.emission_density));
  }
  const Scattering scattering = scatter_between(config, near, to_previous, light.to_light);
  const poly<double> light_side = squared(scattering.pdf_to_light * light.hit_ratio);
  const poly<double> eye_side = eye_side_sum(arguments, near, light.emission_density, scattering.pdf_to_eye,
                                             poly<std::int32_t>(arguments.world.light_vertices));
  const Rgb throughput = near.throughput * light.colour * (light.scale * weight_of(light_side, eye_side));
  connection.direction = light.whole;
  connection.contribution = throughput * scattering.value;
  connection.target_face = arguments.light.get(&LightRecord::face);
  connection.searched_face = arguments.features.coverage
                                 ? poly<std::int32_t>(kNoFace)  // what is passed does not end the search
                                 : cn::max(connection.target_face, poly<std::int32_t>(kNoFace));
  if (arguments.is_in_layers)
    connection.target_light = light_number(arguments.light_place.read(), arguments.lights);
}

/// Eye path to a vertex of the light path.
void connect_to_vertex(const ConnectArguments& arguments, const PathVertex& near,
                       const poly<std::int32_t>& index, Connection& connection) {
  const BsdfConfig config = config_of(arguments);
  const PathVertex far = load_vertex(arguments.pair_sizes, config.lobes, arguments.far_vertex);
  const Direction3 whole = far.position - near.position;
  const Span to_light = span_of(whole);
  const Direction3 to_eye = to_light.direction * -1.0;
  const Scattering here = scatter_between(config, near, near.to_previous, to_light.direction);
  const Scattering there = scatter_between(config, far, to_eye, far.to_previous);
  const poly<double> inverse_square = 1.0 / (to_light.length * to_light.length);
  const poly<double> light_side = light_side_sum(far, here.pdf_to_light * inverse_square, there.pdf_to_light);
  const poly<double> eye_side = eye_side_sum(arguments, near, there.pdf_to_eye * inverse_square,
                                             here.pdf_to_eye, (arguments.world.light_vertices - 1) - index);
  const poly<double> scale =
      inverse_square * weight_of(light_side, eye_side) * cosine_ratio(far, to_eye, far.to_previous);
  connection.direction = whole;
  connection.contribution = near.throughput * here.value * far.throughput * there.value * scale *
                            let_through(config.lobes, far, to_eye, to_light.length);
  connection.target_face = far.face;
  connection.target_light = kNoLight;
  connection.searched_face = kNoFace;
}

void write_connection(const ConnectArguments& arguments, const PathVertex& near,
                      const Connection& connection) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  pair.set(&PairRecord::contribution, connection.contribution);
  pair.set(&PairRecord::target_face, connection.target_face);
  pair.set(&PairRecord::target_light, connection.target_light);
  pair.set(&PairRecord::target, connection.target);
  arguments.ray.set(&RayRecord::origin, near.position);
  arguments.ray.set(&RayRecord::direction, connection.direction);
  arguments.ray.set(&RayRecord::left_face, near.face);
  arguments.ray.set(&RayRecord::light_face, connection.searched_face);
}

/// Evaluates the connections. @return where one brings something, or is all that the slot can do
mask connect_vertices(const ConnectArguments& arguments, const poly<std::int32_t>& ray) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const mask to_lens = is_ray(ray, PairRay::lens);
  const mask to_light = is_ray(ray, PairRay::light_sample);
  const mask to_vertex = is_ray(ray, PairRay::light_vertex);
  const poly<double> none = 0.0;
  const poly<std::int32_t> no_face = kNoFace;
  Connection connection{{none, none, none},           {none, none, none}, no_face, no_face, no_face,
                        pair.get(&PairRecord::target)};
  const PathVertex near = load_vertex(arguments.pair_sizes, arguments.features.lobes, arguments.near_vertex);
  cn::poly_if_any(to_lens, [&] { connect_to_lens(arguments, near, connection); });
  cn::poly_if_any(to_light, [&] { connect_to_light(arguments, near, connection); });
  cn::poly_if_any(to_vertex,
                  [&] { connect_to_vertex(arguments, near, pair.get(&PairRecord::target), connection); });
  write_connection(arguments, near, connection);
  const mask brings_nothing = !(largest_channel(connection.contribution) > 0.0);
  const mask culled = to_light & brings_nothing & (pair.get(&PairRecord::goes_on) != 0);
  cn::keep(culled, *arguments.is_culled);
  return (to_lens | to_light | to_vertex) & !culled;
}

/// What is left of a connection's ray behind a surface that let it through.
void go_on_behind(const ConnectArguments& arguments) {
  const PolyPointer<PassingRecord> passing = passing_of(arguments.pair, arguments.pair_sizes);
  arguments.ray.set(&RayRecord::origin, passing.get(&PassingRecord::origin));
  arguments.ray.set(&RayRecord::direction, passing.get(&PassingRecord::direction));
  arguments.ray.set(&RayRecord::left_face, passing.get(&PassingRecord::face));
  arguments.ray.set(&RayRecord::light_face, poly<std::int32_t>(kNoFace));
}

void begin_light_path(const ConnectArguments& arguments) {
  const LightStart start = start_at_light(arguments);
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const poly<double> zero = 0.0;
  const poly<double> one = 1.0;
  pair.set(&PairRecord::position, start.position);
  pair.set(&PairRecord::direction, start.direction);
  pair.set(&PairRecord::throughput, start.throughput);
  pair.set(&PairRecord::absorption, Rgb{zero, zero, zero});
  pair.set(&PairRecord::pdf, start.pdf);
  pair.set(&PairRecord::face, cn::max(start.face, poly<std::int32_t>(kNoFace)));
  pair.set(&PairRecord::target_face, start.face);
  pair.set(&PairRecord::is_parallel, start.is_parallel);
  pair.set(&PairRecord::depth, poly<std::int32_t>(0));
  pair.set(&PairRecord::light_vertices, poly<std::int32_t>(0));
  pair.set(&PairRecord::light_sum, zero);
  pair.set(&PairRecord::inverse_pdf, one);  // so that the first sum is start.hit_sum
  pair.set(&PairRecord::connects_before, start.hit_sum);
  pair.set(&PairRecord::connects, one);
  pair.set(&PairRecord::reverse_pdf, zero);
  pair.set(&PairRecord::distance_squared, one);
}

void begin_eye_path(const ConnectArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const Lens& lens = arguments.world.lens;
  const CameraRay ray = generate_camera_ray(*arguments.camera, arguments.sampler, arguments.seed,
                                            {pair.get(&PairRecord::pixel), pair.get(&PairRecord::sample)});
  const poly<double> zero = 0.0;
  const poly<double> one = 1.0;
  pair.set(&PairRecord::position, ray.origin);
  pair.set(&PairRecord::direction, ray.direction);
  pair.set(&PairRecord::throughput, Rgb{one, one, one});
  pair.set(&PairRecord::radiance, Rgb{zero, zero, zero});
  pair.set(&PairRecord::pdf, camera_ray_pdf(lens, ray.direction));
  pair.set(&PairRecord::face, poly<std::int32_t>(kNoFace));
  pair.set(&PairRecord::is_parallel, poly<std::int32_t>(lens.is_orthographic ? 1 : 0));
  pair.set(&PairRecord::depth, poly<std::int32_t>(0));
  pair.set(&PairRecord::inverse_pdf, zero);
  pair.set(&PairRecord::connects_before, zero);
  pair.set(&PairRecord::connects, poly<double>(lens.pixels() * lens.pixels()));
  pair.set(&PairRecord::reverse_pdf, zero);
  pair.set(&PairRecord::distance_squared, one);
  Window(pair, arguments.pair_sizes, arguments.world.light_vertices).clear();
}

/// The light paths that begin. Where a light has none, the eye path begins at once.
mask begin_paths(const ConnectArguments& arguments, const poly<std::int32_t>& ray) {
  mask starts_light = is_ray(ray, PairRay::light_start);
  mask starts_eye = is_ray(ray, PairRay::eye_start);
  if (arguments.world.has_silent_lights) {
    const mask is_silent =
        starts_light & (arguments.light.get(&LightRecord::face) >= 0) & !emits(arguments.emission);
    starts_light = starts_light & !is_silent;
    starts_eye = starts_eye | is_silent;
  }
  cn::poly_if_any(starts_light, [&] { begin_light_path(arguments); });
  cn::poly_if_any(starts_eye, [&] { begin_eye_path(arguments); });
  if (arguments.features.coverage)
    cn::poly_if_any(starts_light | starts_eye, [&] { forget_passing(arguments.pair, arguments.pair_sizes); });
  return starts_light;
}

/// @return where the ray is that of a connection
mask connect_or_go_on(const ConnectArguments& arguments, const poly<std::int32_t>& ray) {
  const mask to_lens = is_ray(ray, PairRay::lens);
  const mask to_vertex = is_ray(ray, PairRay::light_vertex);
  const mask wants = to_lens | to_vertex | is_ray(ray, PairRay::light_sample);
  const mask is_behind = wants & has_passed(arguments.pair, arguments.pair_sizes);
  poly<std::int32_t> connects = 0;
  cn::poly_if_any(wants & !is_behind, [&] {
    connects = cn::select(connect_vertices(arguments, ray), poly<std::int32_t>(1), poly<std::int32_t>(0));
  });
  cn::keep(to_lens, *arguments.to_lens);
  cn::keep(to_vertex, *arguments.to_vertex);
  if (!arguments.features.coverage) return connects != 0;
  cn::poly_if_any(is_behind, [&] {
    go_on_behind(arguments);
    connects = 1;
  });
  return connects != 0;
}

void connect(const ConnectArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const poly<std::int32_t> ray = pair.get(&PairRecord::ray);
  const mask starts_light = begin_paths(arguments, ray);
  const mask is_connection = connect_or_go_on(arguments, ray);
  cn::keep(is_connection, *arguments.connects);
  const mask of_light = starts_light | is_ray(ray, PairRay::light_segment);
  cn::keep(of_light, *arguments.of_light);
  cn::poly_if(!is_connection, [&] {
    const poly<std::int32_t> light = static_cast<std::int32_t>(PairRay::light_segment);
    const poly<std::int32_t> eye = static_cast<std::int32_t>(PairRay::eye_segment);
    pair.set(&PairRecord::ray, cn::select(of_light, light, eye));
    arguments.ray.set(&RayRecord::origin, pair.get(&PairRecord::position));
    arguments.ray.set(&RayRecord::direction, pair.get(&PairRecord::direction));
    arguments.ray.set(&RayRecord::left_face, pair.get(&PairRecord::face));
    arguments.ray.set(&RayRecord::light_face, poly<std::int32_t>(kNoFace));
  });
}

}  // namespace

inline namespace CN_LEVEL {

cn::Kernel<ConnectArguments> connect_kernel() {
  return cn::kernel<ConnectArguments, connect>("connect");
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
