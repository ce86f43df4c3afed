// GCC 12 does not see, where SRAM accesses are observed, that a loop writes a vector of the samplers whole
// (bits.hpp).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/kernels/resident_kernels.hpp"

#include "firmware/cn/language/indexed.hpp"
#include "firmware/cn/language/shortcut.hpp"
#include "firmware/path_tracer/kernels/camera_rays.hpp"
#include "firmware/path_tracer/kernels/places.hpp"
#include "firmware/path_tracer/kernels/search_by_vectors.hpp"
#include "firmware/path_tracer/materials/bsdf.hpp"
#include "firmware/path_tracer/sampling/light_sampling.hpp"
#include "firmware/path_tracer/sampling/sampler.hpp"

namespace path_tracer {
namespace {

PolyPointer<ResidentRay> ray_of_path(const ResidentSearchArguments& arguments, int path) {
  return PolyPointer<ResidentRay>(arguments.rays.span().offset_bytes + path * int{sizeof(ResidentPath)});
}

RayOperands operands_of(const PolyPointer<ResidentRay>& ray) {
  return {ray.get(&ResidentRay::origin), ray.get(&ResidentRay::direction), ray.get(&ResidentRay::left_face)};
}

void write_nearest(const PolyPointer<ResidentRay>& ray, const Nearest& nearest) {
  ray.set(&ResidentRay::distance, nearest.distance);
  ray.set(&ResidentRay::determinant, nearest.determinant);
  ray.set(&ResidentRay::number, nearest.number);
}

/// One ray, as the ray stage searches for it.
void search_one(const ResidentSearchArguments& arguments) {
  const PolyPointer<ResidentRay> ray = ray_of_path(arguments, 0);
  Nearest nearest;
  cn::poly_if(cn::recall((*arguments.wanted)[0]), [&] {
    search(operands_of(ray), arguments.reach, MonoTriangles{arguments.triangles, arguments.triangle_count},
           nearest);
  });
  write_nearest(ray, nearest);
}

/// As search_by() does: exactly where two hits were too close, or where rounding may have moved the nearest.
void search_exactly_where_needed(const ResidentSearchArguments& arguments, const mask& tied, int path) {
  const PolyPointer<ResidentRay> ray = ray_of_path(arguments, path);
  const RayOperands operands = operands_of(ray);
  const mask wanted = cn::recall((*arguments.wanted)[std::size_t(path)]);
  const mask hit = ray.get(&ResidentRay::number) >= 0;
  const mask uncertain = wanted & hit & !is_certain(ray.get(&ResidentRay::determinant), operands);
  cn::poly_if_any(tied | uncertain, [&] {
    Nearest nearest;
    search_exactly(operands, arguments.reach, MonoTriangles{arguments.triangles, arguments.triangle_count},
                   nearest);
    write_nearest(ray, nearest);
  });
}

void search_four(const ResidentSearchArguments& arguments) {
  const RayVectors rays(arguments.rays, arguments.vectors);
  mask4 wanted;
  for (int i = 0; i < 4; ++i) {
    wanted[std::size_t(i)] = cn::recall((*arguments.wanted)[std::size_t(i)]);
    write_nearest(rays.ray(i), {});
  }
  const mask4 tied =
      search_by_vectors(rays, MonoTriangles{arguments.triangles, arguments.triangle_count}, wanted);
  for (int i = 0; i < 4; ++i) search_exactly_where_needed(arguments, tied[std::size_t(i)], i);
}

/// A record of an array that lies in every PE's SRAM, of another index in each PE.
template <class Record>
cn::IndexedRecord record_at(const PolyPointer<Record>& first, const poly<std::int32_t>& index) {
  return cn::IndexedRecord(index * std::int32_t{sizeof(Record)} + first.span().offset_bytes);
}

template <class Record>
vec3<poly<double>> load(const cn::IndexedRecord& record, vec3<double> Record::*field) {
  const int offset_bytes = PolyPointer<Record>(0).field(field).offset_bytes;
  return {record.load<double>(offset_bytes), record.load<double>(offset_bytes + 8),
          record.load<double>(offset_bytes + 16)};
}

/// What shading needs of a surface.
struct ResidentSurface {
  cn::IndexedRecord record;
  poly<std::int32_t> face;

  ResidentSurface(const PolyPointer<SurfaceRecord>& surfaces, const mask& hit,
                  const poly<std::int32_t>& number)
      : record(record_at(surfaces, cn::select(hit, number, poly<std::int32_t>(0)))) {
    static_assert(offsetof(SurfaceRecord, face) % 8 == 0);
    const poly<std::uint64_t> word = record.load<std::uint64_t>(offsetof(SurfaceRecord, face));
    face.assign_all_lanes(cn::reinterpret_word<std::int32_t>(cn::low_word(word)));
  }
};

/// Puts a result behind those that the enabled PEs have.
void list_result(const ResidentShadeArguments& arguments, const Rgb& radiance,
                 const poly<std::int32_t>& pixel, const poly<std::int32_t>& sample) {
  const poly<std::int32_t> count = arguments.result_count.read();
  const poly<std::int32_t> at =
      count * std::int32_t{sizeof(RadianceRecord)} + arguments.results.span().offset_bytes;
  static_assert(offsetof(RadianceRecord, radiance) == 0 && offsetof(RadianceRecord, pixel) == 24 &&
                offsetof(RadianceRecord, sample) == 28);
  cn::store_at(at, cn::reinterpret<std::uint64_t>(radiance.x));
  cn::store_at(at + 8, cn::reinterpret<std::uint64_t>(radiance.y));
  cn::store_at(at + 16, cn::reinterpret<std::uint64_t>(radiance.z));
  cn::store_at(at + 24, cn::join_words({cn::reinterpret_word<std::uint32_t>(sample),
                                        cn::reinterpret_word<std::uint32_t>(pixel)}));
  arguments.result_count.write(count + 1);
}

/// Adds what the shadow ray of the last vertex brings, to the path or, if it ended, to its result.
void add_direct_light(const ResidentShadeArguments& arguments, const PolyPointer<ResidentPath>& path,
                      int place) {
  const mask ended = cn::recall((*arguments.ended)[std::size_t(place)]);
  Rgb radiance =
      cn::select(ended, path.get(&ResidentPath::ended_radiance), path.get(&ResidentPath::radiance));
  if (arguments.casts_shadow_rays) {
    const poly<std::int32_t> number = path.part(&ResidentPath::shadow).get(&ResidentRay::number);
    const mask hit = cn::recall((*arguments.casts)[std::size_t(place)]) & (number >= 0);
    const ResidentSurface surface(arguments.surfaces, hit, number);
    const mask sees = hit & (surface.face == path.get(&ResidentPath::light_face));
    cn::poly_if(sees, [&] {
      const Rgb sum =
          radiance + load(surface.record, &SurfaceRecord::emission) * path.get(&ResidentPath::lighting);
      radiance = sum;
    });
  }
  cn::poly_if(
      ended,
      [&] {
        list_result(arguments, radiance, path.get(&ResidentPath::ended_pixel),
                    path.get(&ResidentPath::ended_sample));
      },
      [&] { path.set(&ResidentPath::radiance, radiance); });
}

/// A vertex of a path, as its next segment and its shadow ray need it.
struct ResidentVertex {
  Point3 position;
  Direction3 normal;  ///< on the side that the ray arrived from
  Rgb reflectance;
  poly<std::int32_t> face;
  Rgb throughput;  ///< up to the vertex
};

/// Aims a shadow ray from the vertex, as kernel `scatter` does.
/// @return where there is one
mask aim(const ResidentShadeArguments& arguments, const PolyPointer<ResidentPath>& path,
         const ResidentVertex& vertex, const mask& wants_light) {
  const LightNumbers numbers =
      light_numbers(arguments.sampler, arguments.seed, path.get(&ResidentPath::pixel),
                    path.get(&ResidentPath::sample), path.get(&ResidentPath::depth), arguments.light_table);
  const cn::IndexedRecord light = record_at(arguments.lights, numbers.light);
  const LightSurface surface{load(light, &LightRecord::vertex), load(light, &LightRecord::edge1),
                             load(light, &LightRecord::edge2), load(light, &LightRecord::normal)};
  static_assert(offsetof(LightRecord, face) % 8 == 0 &&
                offsetof(LightRecord, shape) == offsetof(LightRecord, face) + 4);
  const poly<std::uint64_t> face_and_shape = light.load<std::uint64_t>(offsetof(LightRecord, face));
  const LightSample sample = sample_light(
      arguments.light_sampling, surface, cn::reinterpret_word<std::int32_t>(cn::high_word(face_and_shape)),
      vertex.position, vertex.normal, numbers.position.u, numbers.position.v);
  const mask facing = sample.weight > 0.0;
  const poly<double> scale = cn::select(facing, sample.weight, poly<double>(0.0)) *
                             light.load<double>(offsetof(LightRecord, inverse_pdf)) * (1.0 / kPi);
  const PolyPointer<ResidentRay> shadow = path.part(&ResidentPath::shadow);
  shadow.set(&ResidentRay::origin, vertex.position);
  shadow.set(&ResidentRay::direction, sample.to_light);
  shadow.set(&ResidentRay::left_face, vertex.face);
  path.set(&ResidentPath::light_face, cn::reinterpret_word<std::int32_t>(cn::low_word(face_and_shape)));
  path.set(&ResidentPath::lighting, vertex.throughput * (vertex.reflectance * scale));
  return arguments.cull_shadow_rays ? wants_light & facing : wants_light;
}

/// Keeps what a path has gathered until its last shadow ray is over.
void end_path(const PolyPointer<ResidentPath>& path, const Rgb& radiance) {
  path.set(&ResidentPath::ended_radiance, radiance);
  path.set(&ResidentPath::ended_pixel, path.get(&ResidentPath::pixel));
  path.set(&ResidentPath::ended_sample, path.get(&ResidentPath::sample));
}

/// Continues the path at the vertex, or ends it by Russian roulette, as kernel `scatter` does.
/// @return where it ended
mask continue_or_end(const ResidentShadeArguments& arguments, const PolyPointer<ResidentPath>& path,
                     const ResidentVertex& vertex, const mask& reflects) {
  const poly<std::int32_t> depth = path.get(&ResidentPath::depth);
  const ScatterNumbers random =
      scatter_numbers(arguments.sampler, arguments.seed, path.get(&ResidentPath::pixel),
                      path.get(&ResidentPath::sample), depth);
  const mask safe = depth < arguments.roulette_start;
  const poly<double> survival =
      cn::select(safe, poly<double>(1.0),
                 cn::min(largest_channel(vertex.reflectance), poly<double>(arguments.max_survival)));
  const mask goes_on = reflects & (random.roulette < survival);
  const poly<double> inverse_survival = 1.0 / cn::select(goes_on, survival, poly<double>(1.0));
  const PolyPointer<ResidentRay> segment = path.part(&ResidentPath::segment);
  segment.set(&ResidentRay::origin, vertex.position);
  segment.set(&ResidentRay::direction, sample_cosine(vertex.normal, random.direction.u, random.direction.v));
  segment.set(&ResidentRay::left_face, vertex.face);
  path.set(&ResidentPath::throughput, vertex.throughput * (vertex.reflectance * inverse_survival));
  path.set(&ResidentPath::depth, depth + 1);
  return !goes_on;
}

/// Shades what the segment hit.
void shade_vertex(const ResidentShadeArguments& arguments, const PolyPointer<ResidentPath>& path, int place) {
  const PolyPointer<ResidentRay> segment = path.part(&ResidentPath::segment);
  const poly<std::int32_t> number = segment.get(&ResidentRay::number);
  const poly<double> determinant = segment.get(&ResidentRay::determinant);
  const mask hit = number >= 0;
  const mask front = determinant > 0.0;
  const ResidentSurface surface(arguments.surfaces, hit, number);
  const Direction3 normal = load(surface.record, &SurfaceRecord::normal);
  const poly<double> distance = segment.get(&ResidentRay::distance) / cn::abs(determinant);
  const ResidentVertex vertex{
      segment.get(&ResidentRay::origin) + segment.get(&ResidentRay::direction) * distance,
      cn::select(front, normal, normal * -1.0), load(surface.record, &SurfaceRecord::reflectance),
      surface.face, path.get(&ResidentPath::throughput)};

  const poly<std::int32_t> depth = path.get(&ResidentPath::depth);
  const mask emits = hit & front & (arguments.casts_shadow_rays ? depth == 0 : depth >= 0);
  Rgb radiance = path.get(&ResidentPath::radiance);
  cn::poly_if_any(emits, [&] {
    const Rgb sum = radiance + vertex.throughput * load(surface.record, &SurfaceRecord::emission);
    radiance = sum;
  });

  const mask reflects = hit & (largest_channel(vertex.reflectance) > 0.0);
  cn::without_charging([&] { cn::keep(reflects, (*arguments.reflecting)[std::size_t(place)]); });
  if (arguments.casts_shadow_rays)
    cn::keep(aim(arguments, path, vertex, reflects), (*arguments.casts)[std::size_t(place)]);
  const mask ends = continue_or_end(arguments, path, vertex, reflects);
  cn::keep(ends, (*arguments.ended)[std::size_t(place)]);
  path.set(&ResidentPath::radiance, radiance);
  cn::poly_if(ends, [&] { end_path(path, radiance); });
}

void shade_paths(const ResidentShadeArguments& arguments) {
  for (int place = 0; place < arguments.path_count; ++place) {
    const PolyPointer<ResidentPath> path = arguments.paths[place];
    const mask live = cn::recall((*arguments.live)[std::size_t(place)]);
    add_direct_light(arguments, path, place);
    const mask none(cn::mask_from_bits(0));
    cn::without_charging([&] {
      cn::keep(none, (*arguments.casts)[std::size_t(place)]);
      cn::keep(none, (*arguments.ended)[std::size_t(place)]);
      cn::keep(none, (*arguments.reflecting)[std::size_t(place)]);
    });
    cn::poly_if(live, [&] { shade_vertex(arguments, path, place); });
  }
  cn::keep(arguments.result_count.read() > kResidentResults - arguments.path_count, *arguments.nearly_full);
}

void begin_path(const ResidentStartArguments& arguments, const PolyPointer<ResidentPath>& path,
                const poly<std::int32_t>& number) {
  const CameraSample at = camera_sample(*arguments.camera, arguments.camera_rays, number);
  const CameraRay ray = generate_camera_ray(*arguments.camera, arguments.sampler, arguments.seed, at);
  const PolyPointer<ResidentRay> segment = path.part(&ResidentPath::segment);
  segment.set(&ResidentRay::origin, ray.origin);
  segment.set(&ResidentRay::direction, ray.direction);
  segment.set(&ResidentRay::left_face, poly<std::int32_t>(kNoFace));
  const poly<double> zero = 0.0;
  const poly<double> one = 1.0;
  path.set(&ResidentPath::throughput, Rgb{one, one, one});
  path.set(&ResidentPath::radiance, Rgb{zero, zero, zero});
  path.set(&ResidentPath::pixel, at.pixel);
  path.set(&ResidentPath::sample, at.sample);
  path.set(&ResidentPath::depth, poly<std::int32_t>(0));
}

void start_paths(const ResidentStartArguments& arguments) {
  poly<std::int32_t> number = arguments.number.read();
  for (int place = 0; place < arguments.path_count; ++place) {
    const mask ended = cn::recall((*arguments.ended)[std::size_t(place)]);
    const mask starts = ended & (number < arguments.remaining);
    cn::poly_if_any(starts, [&] { begin_path(arguments, arguments.paths[place], number); });
    cn::keep(starts, (*arguments.started)[std::size_t(place)]);
    cn::poly_if(ended, [&] { number = number + 1; });
  }
}

void clear_results(const ClearResultsArguments& arguments) {
  for (int i = 0; i < kResidentResults; ++i)
    arguments.results[i].set(&RadianceRecord::pixel, poly<std::int32_t>(-1));
  arguments.result_count.write(poly<std::int32_t>(0));
}

}  // namespace

inline namespace CN_LEVEL {

const ResidentKernels& resident_kernel_table() {
  static constexpr ResidentKernels table{
      cn::kernel<ResidentSearchArguments, search_one>("resident_search"),
      cn::kernel<ResidentSearchArguments, search_four>("resident_search_by_vectors"),
      cn::kernel<ResidentShadeArguments, shade_paths>("resident_shade"),
      cn::kernel<ResidentStartArguments, start_paths>("resident_start"),
      cn::kernel<ClearResultsArguments, clear_results>("clear_results"),
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
