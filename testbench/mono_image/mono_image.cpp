#include "testbench/mono_image/mono_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "firmware/path_tracer/materials/absorption.hpp"
#include "testbench/bvh/tree_image.hpp"
#include "testbench/mono_image/barycentric.hpp"
#include "testbench/mono_image/coverage.hpp"
#include "testbench/mono_image/faces.hpp"
#include "testbench/mono_image/material_records.hpp"
#include "testbench/mono_image/mean_emission.hpp"
#include "testbench/mono_image/scene_features.hpp"
#include "testbench/mono_image/scene_layers.hpp"
#include "testbench/mono_image/shading_kinds.hpp"
#include "testbench/mono_image/tangents.hpp"
#include "testbench/mono_image/texture_images.hpp"
#include "testbench/scene/film_ray.hpp"
#include "testbench/scene/normalise.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using path_tracer::CameraRecord;
using path_tracer::LightRecord;
using path_tracer::LightShape;
using path_tracer::SurfaceRecord;

cn::vec3<double> to_record(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

CameraRecord camera_record(const Camera& camera, const FilmSize& film) {
  const FilmPlane plane = film_plane(camera, film);
  CameraRecord record;
  record.is_orthographic = camera.orthographic_height.has_value();
  record.position = to_record(record.is_orthographic ? plane.corner : camera.position);
  record.direction = to_record(record.is_orthographic ? camera.direction : plane.corner);
  record.right = to_record(plane.right);
  record.down = to_record(plane.down);
  record.width = film.width;
  record.height = film.height;
  return record;
}

/// The box in which the firmware may find hits of the triangle (padded_box(), triangle_record.hpp).
Box padded_box(const path_tracer::TriangleShape& shape, double reach) {
  const path_tracer::PaddedBox<double> box =
      path_tracer::padded_box(shape.vertex, shape.edge1, shape.edge2, reach);
  return {{box.lower.x, box.lower.y, box.lower.z}, {box.upper.x, box.upper.y, box.upper.z}};
}

/// A bound for the distance between any two points of camera and triangles, where all rays start.
double reach_of(const Scene& scene) {
  Box all;
  for (const int x : {0, scene.film.width})
    for (const int y : {0, scene.film.height}) all.include(film_ray(scene, x, y).origin);
  for (const Triangle& triangle : scene.triangles) all.include(bounds_of(triangle));
  constexpr double kRoom = 1.125;  // for paddings and rounding
  return kRoom * glm::length(all.upper - all.lower);
}

/// Triangles, faces and planes as the image's parts need them.
struct Triangles {
  const Scene& scene;
  const CoincidentTriangles coincident{find_coincident_triangles(scene.triangles)};
  const std::vector<std::int32_t> faces{number_faces(scene.triangles, coincident)};
  const SceneLayers layers{scene.triangles, coincident, faces};

  explicit Triangles(const Scene& of) : scene(of) {}
  std::size_t count() const { return scene.triangles.size(); }
};

SurfaceRecord surface_record(const Triangle& triangle, const Material& material, std::int32_t face,
                             std::int32_t light) {
  SurfaceRecord record;
  record.normal = to_record(glm::normalize(area_normal(triangle)));
  record.reflectance =
      to_record(shows_transmission_colour(material) ? material.transmission_colour : material.reflectance);
  record.emission = to_record(material.emission);
  record.face = face;
  record.light = light;
  return record;
}

struct Lights {
  std::vector<LightRecord> records;
  std::vector<double> cdf;
  std::vector<std::vector<std::size_t>> triangles;  ///< of each light
};

/// Part of the scene that is sampled as one light.
struct Emitter {
  glm::dvec3 vertex;
  glm::dvec3 edge1;
  glm::dvec3 edge2;
  LightShape shape;
  glm::dvec3 emission;  ///< mean radiance, estimated
  std::int32_t material;
  std::int32_t face;
  std::vector<std::size_t> triangles;
};

double area(const Emitter& emitter) {
  const double parallelogram = glm::length(glm::cross(emitter.edge1, emitter.edge2));
  return emitter.shape == LightShape::triangle ? 0.5 * parallelogram : parallelogram;
}

/// The radiant power of a light, up to a common factor. Lights are chosen in proportion to it.
double power(const Emitter& emitter) {
  const glm::dvec3& emission = emitter.emission;
  return area(emitter) * (emission.x + emission.y + emission.z);
}

/// The rectangle that two triangles of one face and material form; std::nullopt if they form none. The
/// tolerance for rounding is 2^-40.
std::optional<Emitter> join(const Emitter& a, const Emitter& b) {
  constexpr double kTolerance = 0x1p-40;
  if (a.face != b.face || a.material != b.material) return {};
  const glm::dvec3 corners_a[3] = {a.vertex, a.vertex + a.edge1, a.vertex + a.edge2};
  const glm::dvec3 corners_b[3] = {b.vertex, b.vertex + b.edge1, b.vertex + b.edge2};
  for (int i = 0; i < 3; ++i) {
    // The right angle lies at a corner of `a`, the opposite corner is one of `b`.
    Emitter joined = a;
    joined.emission = 0.5 * (a.emission + b.emission);
    joined.vertex = corners_a[i];
    joined.edge1 = corners_a[(i + 1) % 3] - joined.vertex;
    joined.edge2 = corners_a[(i + 2) % 3] - joined.vertex;
    joined.shape = LightShape::rectangle;
    const double size = glm::length(joined.edge1) * glm::length(joined.edge2);
    if (std::abs(glm::dot(joined.edge1, joined.edge2)) > kTolerance * size) continue;
    const auto is_corner_of_b = [&](const glm::dvec3& point) {
      return std::any_of(std::begin(corners_b), std::end(corners_b), [&](const glm::dvec3& corner) {
        return glm::length(corner - point) <= kTolerance * std::sqrt(size);
      });
    };
    if (is_corner_of_b(joined.vertex + joined.edge1) && is_corner_of_b(joined.vertex + joined.edge2) &&
        is_corner_of_b(joined.vertex + joined.edge1 + joined.edge2)) {
      joined.triangles.insert(joined.triangles.end(), b.triangles.begin(), b.triangles.end());
      return joined;
    }
  }
  return {};
}

std::vector<Emitter> find_emitters(const Scene& scene, const std::vector<std::int32_t>& faces) {
  const MeanEmission emission(scene);
  std::vector<Emitter> emitters;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& triangle = scene.triangles[i];
    const Emitter emitter{triangle.vertex[0],
                          triangle.vertex[1] - triangle.vertex[0],
                          triangle.vertex[2] - triangle.vertex[0],
                          LightShape::triangle,
                          emission.of_triangle(i),
                          triangle.material,
                          faces[i],
                          {i}};
    if (power(emitter) > 0) emitters.push_back(emitter);
  }
  return emitters;
}

/// Replaces two triangles that follow each other by the rectangle that they form.
std::vector<Emitter> join_rectangles(const std::vector<Emitter>& triangles) {
  std::vector<Emitter> emitters;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::optional<Emitter> joined;
    if (i + 1 < triangles.size()) joined = join(triangles[i], triangles[i + 1]);
    emitters.push_back(joined.value_or(triangles[i]));
    if (joined) ++i;
  }
  return emitters;
}

Lights make_lights(const Scene& scene, const std::vector<std::int32_t>& faces,
                   path_tracer::LightSampling sampling) {
  std::vector<Emitter> emitters = find_emitters(scene, faces);
  if (sampling == path_tracer::LightSampling::solid_angle) emitters = join_rectangles(emitters);
  double total_power = 0;
  for (const Emitter& emitter : emitters) total_power += power(emitter);
  if (!(total_power > 0) && scene.environment.is_lit()) return {};
  if (!(total_power > 0))
    throw InputError(scene.name + ": no triangle emits light; a material with Ke above 0 is needed");

  Lights lights;
  double power_so_far = 0;
  for (const Emitter& emitter : emitters) {
    const double pdf = power(emitter) / total_power / area(emitter);
    LightRecord record;
    record.vertex = to_record(emitter.vertex);
    record.edge1 = to_record(emitter.edge1);
    record.edge2 = to_record(emitter.edge2);
    record.normal = to_record(glm::normalize(glm::cross(emitter.edge1, emitter.edge2)));
    record.inverse_pdf = 1.0 / pdf;
    record.face = emitter.face;
    record.shape = static_cast<std::int32_t>(emitter.shape);
    lights.records.push_back(record);
    lights.triangles.push_back(emitter.triangles);
    power_so_far += power(emitter);
    lights.cdf.push_back(power_so_far / total_power);
  }
  return lights;
}

template <class Record>
void put(MonoImage& image, cn::MonoPointer<Record> to, const Record* records, std::size_t count) {
  std::memcpy(image.bytes.data() + to.address, records, count * sizeof(Record));
}

TreeImage make_tree(const Triangles& triangles, double reach, const path_tracer::ProgramConfig& config) {
  const double unit = path_tracer::to_node_unit(config.tree.layout.format, reach);
  std::vector<Box> boxes;
  boxes.reserve(triangles.count());
  for (std::size_t i = 0; i < triangles.count(); ++i) {
    const Box box = padded_box(triangles.layers.shape_of(triangles.scene.triangles[i], i), reach);
    boxes.push_back({box.lower * unit, box.upper * unit});
  }
  return make_tree_image(boxes, config.tree);
}

/// The indices of the scene's triangles in the order of mono memory: leaf by leaf with a tree, else as in the
/// scene.
std::vector<std::size_t> triangles_in_order(const Scene& scene, const TreeImage& tree,
                                            const path_tracer::ProgramConfig& config) {
  std::vector<std::size_t> order(scene.triangles.size());
  if (config.uses_tree()) {
    std::transform(tree.triangles.begin(), tree.triangles.end(), order.begin(),
                   [](std::int32_t triangle) { return std::size_t(triangle); });
  } else {
    std::iota(order.begin(), order.end(), std::size_t{0});
  }
  return order;
}

void put_at(MonoImage& image, const path_tracer::LayeredTriangleRecord& record, std::size_t place) {
  if (image.layout.layers.any) {
    put(image, cn::MonoPointer<path_tracer::LayeredTriangleRecord>{image.layout.triangles.address} + place,
        &record, 1);
  } else {
    put(image, image.layout.triangles + place, &record.triangle, 1);
  }
}

void put_triangle(MonoImage& image, const Triangles& triangles, std::size_t triangle, std::size_t place) {
  put_at(image,
         triangles.layers.record_of(
             triangles.scene.triangles[triangle],
             {triangles.faces[triangle], static_cast<std::int32_t>(triangle), image.layout.reach}),
         place);
}

/// Whether all triangles of a light share one plane. Then none of its face is nearer than another along any
/// ray, as far as they share the plane, and the light's own triangles are enough for a run.
bool shares_plane(const SceneLayers& layers, const std::vector<std::size_t>& of_light) {
  return layers.plane_of(of_light[0]) != kNoPlane &&
         std::all_of(of_light.begin(), of_light.end(),
                     [&](std::size_t i) { return layers.plane_of(i) == layers.plane_of(of_light[0]); });
}

/// Writes, behind the triangles, a run of records for each light: all triangles of the light's face, or of
/// the light itself where they share a plane. A shadow ray that hits one of them can stop at any nearer hit.
/// If there are too many triangles, the run holds records that no ray hits. Shadow rays to that light then
/// seem to miss it and search for the nearest hit as segments do.
void put_light_runs(MonoImage& image, const Triangles& all, const Lights& lights) {
  const std::vector<std::int32_t>& faces = all.faces;
  std::unordered_map<std::int32_t, std::vector<std::size_t>> of_face;
  for (const LightRecord& light : lights.records) of_face[light.face];
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto found = of_face.find(faces[i]);
    if (found != of_face.end() && found->second.size() <= path_tracer::kLightRun) found->second.push_back(i);
  }
  std::size_t place = all.count();
  for (std::size_t light = 0; light < lights.records.size(); ++light) {
    const std::vector<std::size_t>& own = lights.triangles[light];
    const std::vector<std::size_t>& triangles =
        shares_plane(all.layers, own) ? own : of_face[lights.records[light].face];
    const std::size_t in_run = triangles.size() <= path_tracer::kLightRun ? triangles.size() : 0;
    for (std::size_t i = 0; i < path_tracer::kLightRun; ++i, ++place) {
      if (i < in_run) {
        put_triangle(image, all, triangles[i], place);
      } else {
        put_at(image, {}, place);
      }
    }
  }
}

/// Writes a record of a surface's tail (records/tails.hpp), if the scene's surfaces have it.
template <class Tail>
void put_tail(MonoImage& image, std::size_t triangle, int place, const Tail& tail) {
  if (place == path_tracer::RecordSizes::kNone) return;
  const std::uint64_t surface = triangle * std::uint64_t(image.layout.sizes.surface);
  std::memcpy(image.bytes.data() + image.layout.surfaces.address + surface + std::uint64_t(place), &tail,
              sizeof(tail));
}

/// The normal at the corners as an affine function of the position.
path_tracer::NormalRecord normal_record(const Scene& scene, std::size_t index) {
  const Triangle& triangle = scene.triangles[index];
  const CornerNormals corners =
      scene.corners.normals.empty() ? CornerNormals{} : scene.corners.normals[index];
  path_tracer::NormalRecord record;
  const bool is_flat = corners[0] == glm::dvec3(0.0);
  if (is_flat) {
    record.at_origin = to_record(glm::normalize(area_normal(triangle)));
    return record;
  }
  const Barycentric barycentric(triangle);
  const glm::dmat3 slope = glm::outerProduct(corners[1] - corners[0], barycentric.to_u) +
                           glm::outerProduct(corners[2] - corners[0], barycentric.to_v);
  record.at_origin = to_record(corners[0] - slope * triangle.vertex[0]);
  record.along_x = to_record(slope[0]);
  record.along_y = to_record(slope[1]);
  record.along_z = to_record(slope[2]);
  return record;
}

void put_material(MonoImage& image, std::size_t triangle, const Material& material) {
  const path_tracer::RecordSizes& sizes = image.layout.sizes;
  put_tail(image, triangle, sizes.coverage, coverage_record(material));
  put_tail(image, triangle, sizes.material, material_record(material));
  put_tail(image, triangle, sizes.varnish_tint, varnish_tint_record(material));
  put_tail(image, triangle, sizes.transmission_tint, transmission_tint_record(material));
  path_tracer::AbsorptionRecord absorption;
  if (!material.is_thin)
    absorption.coefficient = path_tracer::absorption_coefficient(to_record(material.attenuation_colour),
                                                                 material.attenuation_distance);
  put_tail(image, triangle, sizes.absorption, absorption);
  put_tail(image, triangle, sizes.coat,
           path_tracer::CoatRecord{material.clearcoat, material.clearcoat_roughness});
  put_tail(image, triangle, sizes.sheen,
           path_tracer::SheenRecord{to_record(material.sheen_colour), material.sheen_roughness});
}

void put_textures(MonoImage& image, const TextureImages& textures, std::size_t triangles) {
  const path_tracer::TextureSlots& slots = image.layout.features.textures;
  if (!slots.any()) return;
  const cn::MonoAddress first = image.layout.textures.address;
  textures.write(image.bytes.data() + first);
  for (int slot = 0; slot < path_tracer::kTextureSlots; ++slot)
    for (std::size_t i = 0; slots.looks_up(path_tracer::TextureSlot(slot)) && i < triangles; ++i)
      put_tail(image, i, image.layout.sizes.texture[slot],
               textures.record_of(i, path_tracer::TextureSlot(slot), first));
}

void put_surfaces(MonoImage& image, const Triangles& triangles, const Lights& lights) {
  const path_tracer::RecordSizes& sizes = image.layout.sizes;
  const bool has_normals = image.layout.features.normals;
  std::vector<std::int32_t> light_of(triangles.count(), path_tracer::kNoLight);
  for (std::size_t light = 0; light < lights.triangles.size(); ++light)
    for (const std::size_t triangle : lights.triangles[light])
      light_of[triangle] = static_cast<std::int32_t>(light);
  for (std::size_t i = 0; i < triangles.count(); ++i) {
    const Triangle& triangle = triangles.scene.triangles[i];
    const Material& material = triangles.scene.materials[std::size_t(triangle.material)];
    const SurfaceRecord record = surface_record(triangle, material, triangles.faces[i], light_of[i]);
    const std::uint64_t place = i * std::uint64_t(sizes.surface);
    std::memcpy(image.bytes.data() + image.layout.surfaces.address + place, &record, sizeof(record));
    put_material(image, i, material);
    if (has_normals) put_tail(image, i, sizes.normal, normal_record(triangles.scene, i));
    put_tail(image, i, sizes.tangent, tangent_record(triangles.scene, i));
    path_tracer::AimRecord aim{std::numeric_limits<double>::infinity()};
    if (light_of[i] != path_tracer::kNoLight)
      aim.inverse_pdf = lights.records[std::size_t(light_of[i])].inverse_pdf;
    put_tail(image, i, sizes.aim, aim);
  }
}

/// The kind of each triangle's material, where hits wait in bins of their kind.
void put_shading_kinds(MonoImage& image, const Scene& scene, path_tracer::Shading shading) {
  if (image.layout.sizes.shading_kind == path_tracer::RecordSizes::kNone) return;
  const std::vector<std::int32_t> kinds = shading_kinds(scene, shading);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    put_tail(image, i, image.layout.sizes.shading_kind,
             path_tracer::ShadingKindRecord{kinds[std::size_t(scene.triangles[i].material)]});
}

}  // namespace

MonoImage make_mono_image(const Scene& scene, int num_pes, const path_tracer::ProgramConfig& options) {
  const path_tracer::ProgramConfig config = built_for(scene, options);
  const Triangles triangles(scene);
  const Lights lights = make_lights(scene, triangles.faces, config.light_sampling);
  const double reach = reach_of(scene);
  TreeImage tree;
  if (config.uses_tree()) tree = make_tree(triangles, reach, config);

  const TextureImages textures(scene, config.features.textures);

  path_tracer::SceneCounts counts;
  counts.triangles = static_cast<int>(scene.triangles.size());
  counts.lights = static_cast<int>(lights.records.size());
  counts.tree_slots = static_cast<int>(tree.slots);
  counts.texture_bytes = textures.bytes();
  counts.has_layers = triangles.layers.layers().any;
  MonoImage image;
  image.layout = path_tracer::make_layout(counts, num_pes, config);
  image.layout.reach = reach;
  if (config.features.environment) image.layout.environment = to_record(scene.environment.constant);
  image.layout.layers = triangles.layers.layers();
  image.bytes.resize(image.layout.scene_bytes);
  const CameraRecord camera = camera_record(scene.camera, scene.film);
  put(image, image.layout.camera, &camera, 1);
  const std::vector<std::size_t> order = triangles_in_order(scene, tree, config);
  for (std::size_t place = 0; place < order.size(); ++place)
    put_triangle(image, triangles, order[place], place);
  if (config.uses_tree()) put_light_runs(image, triangles, lights);
  put_surfaces(image, triangles, lights);
  put_textures(image, textures, triangles.count());
  put_shading_kinds(image, scene, config.shading);
  put(image, image.layout.lights, lights.records.data(), lights.records.size());
  put(image, image.layout.light_cdf, lights.cdf.data(), lights.cdf.size());
  if (config.uses_tree())
    std::memcpy(image.bytes.data() + image.layout.nodes.address, tree.nodes.data(), tree.nodes.size());
  return image;
}

MonoImage make_normal_mono_image(const Scene& scene, int num_pes, const path_tracer::ProgramConfig& config) {
  return make_mono_image(normalised(scene), num_pes, config);
}

}  // namespace testbench
