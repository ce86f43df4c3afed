#include "testbench/mono_image/mono_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/constants.hpp>
#include <numeric>
#include <unordered_map>

#include "firmware/path_tracer/materials/absorption.hpp"
#include "testbench/bvh/tree_image.hpp"
#include "testbench/mono_image/barycentric.hpp"
#include "testbench/mono_image/constant_textures.hpp"
#include "testbench/mono_image/coverage.hpp"
#include "testbench/mono_image/faces.hpp"
#include "testbench/mono_image/material_records.hpp"
#include "testbench/mono_image/scene_features.hpp"
#include "testbench/mono_image/scene_layers.hpp"
#include "testbench/mono_image/shading_kinds.hpp"
#include "testbench/mono_image/tangents.hpp"
#include "testbench/mono_image/texture_images.hpp"
#include "testbench/mono_image/to_record.hpp"
#include "testbench/scene/film_ray.hpp"
#include "testbench/scene/normalise.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using path_tracer::CameraRecord;
using path_tracer::LightRecord;
using path_tracer::SurfaceRecord;

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

/// A sphere around the scene's triangles.
struct Surround {
  glm::dvec3 centre;
  double radius;
};
Surround surround_of(const Scene& scene) {
  Box all;
  for (const Triangle& triangle : scene.triangles) all.include(bounds_of(triangle));
  constexpr double kRoom = 1.0 + 0x1p-20;  // for rounding
  return {0.5 * (all.lower + all.upper), kRoom * 0.5 * glm::length(all.upper - all.lower)};
}

/// A bound for the distance between any two points where rays start: camera and triangles, and where light
/// paths begin.
double reach_of(const Scene& scene, bool has_light_paths) {
  Box all;
  if (has_light_paths) {
    for (const Light& light : scene.lights)
      if (light.kind == LightKind::point || light.kind == LightKind::spot) all.include(light.position);
    const Surround surround = surround_of(scene);
    const glm::dvec3 disk(std::sqrt(2.0) * surround.radius);  // its edge, where light from far away begins
    all.include(surround.centre - disk);
    all.include(surround.centre + disk);
  }
  for (const int x : {0, scene.film.width})
    for (const int y : {0, scene.film.height}) all.include(film_ray(scene, x, y).origin);
  for (const Triangle& triangle : scene.triangles) all.include(bounds_of(triangle));
  constexpr double kRoom = 1.125;  // for paddings and rounding
  return kRoom * glm::length(all.upper - all.lower);
}

/// Triangles, faces and planes as the image's parts need them.
struct Triangles {
  const Scene& scene;
  const CoincidentTriangles coincident{find_coincident_triangles(scene)};
  const std::vector<std::int32_t> faces{number_faces(scene.triangles, coincident)};
  const SceneLayers layers{scene, coincident, faces};

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

template <class Record>
void put(MonoImage& image, cn::MonoPointer<Record> to, const Record* records, std::size_t count) {
  if (count > 0) std::memcpy(image.bytes.data() + to.address, records, count * sizeof(Record));
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
/// If there are too many triangles or none, the run holds records that no ray hits. Shadow rays to that light
/// then seem to miss it and search for the nearest hit as segments do.
void put_light_runs(MonoImage& image, const Triangles& all, const Lights& lights) {
  const std::vector<std::int32_t>& faces = all.faces;
  std::unordered_map<std::int32_t, std::vector<std::size_t>> of_face;
  for (const LightRecord& light : lights.records)
    if (light.face >= 0) of_face[light.face];
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto found = of_face.find(faces[i]);
    if (found != of_face.end() && found->second.size() <= path_tracer::kLightRun) found->second.push_back(i);
  }
  std::size_t place = all.count();
  for (std::size_t light = 0; light < lights.records.size(); ++light) {
    const std::vector<std::size_t>& own = lights.triangles[light];
    const std::vector<std::size_t>& triangles =
        own.empty() || shares_plane(all.layers, own) ? own : of_face[lights.records[light].face];
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

/// The record that put_tail() wrote; a new one if the scene's surfaces have none.
template <class Tail>
Tail get_tail(const MonoImage& image, std::size_t triangle, int place) {
  Tail tail;
  if (place == path_tracer::RecordSizes::kNone) return tail;
  const std::uint64_t surface = triangle * std::uint64_t(image.layout.sizes.surface);
  std::memcpy(&tail, image.bytes.data() + image.layout.surfaces.address + surface + std::uint64_t(place),
              sizeof(tail));
  return tail;
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

void put_surfaces(MonoImage& image, const Triangles& triangles, const std::vector<Material>& materials,
                  const Lights& lights) {
  const path_tracer::RecordSizes& sizes = image.layout.sizes;
  const bool has_normals = image.layout.features.normals;
  std::vector<std::int32_t> light_of(triangles.count(), path_tracer::kNoLight);
  for (std::size_t light = 0; light < lights.triangles.size(); ++light)
    for (const std::size_t triangle : lights.triangles[light])
      light_of[triangle] = static_cast<std::int32_t>(light);
  for (std::size_t i = 0; i < triangles.count(); ++i) {
    const Triangle& triangle = triangles.scene.triangles[i];
    const Material& material = materials[std::size_t(triangle.material)];
    const SurfaceRecord record = surface_record(triangle, material, triangles.faces[i], light_of[i]);
    const std::uint64_t place = i * std::uint64_t(sizes.surface);
    std::memcpy(image.bytes.data() + image.layout.surfaces.address + place, &record, sizeof(record));
    put_material(image, i, material);
    if (has_normals) put_tail(image, i, sizes.normal, normal_record(triangles.scene, i));
    put_tail(image, i, sizes.tangent, tangent_record(triangles.scene, i));
    put_tail(image, i, sizes.tangent_slope, tangent_slope_record(triangles.scene, i));
    path_tracer::AimRecord aim{std::numeric_limits<double>::infinity()};
    if (light_of[i] != path_tracer::kNoLight)
      aim.inverse_pdf = lights.records[std::size_t(light_of[i])].inverse_pdf;
    put_tail(image, i, sizes.aim, aim);
  }
}

/// The kind of each triangle's material, where hits wait in bins of their kind.
void put_shading_kinds(MonoImage& image, const Scene& scene, const std::vector<Material>& materials,
                       path_tracer::Shading shading) {
  if (image.layout.sizes.shading_kind == path_tracer::RecordSizes::kNone) return;
  const std::vector<std::int32_t> kinds = shading_kinds(scene, materials, shading);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    put_tail(image, i, image.layout.sizes.shading_kind,
             path_tracer::ShadingKindRecord{kinds[std::size_t(scene.triangles[i].material)]});
}

/// Whether light paths begin at the triangle, if it emits: where they leave it, nothing looks up textures.
/// Other lights are found by hits and by connections to their points, whose weights know that
/// (begins_light_paths() of the firmware).
bool may_begin_light_paths(const MonoImage& image, std::size_t triangle) {
  const path_tracer::RecordSizes& sizes = image.layout.sizes;
  for (const auto slot : {path_tracer::TextureSlot::emission, path_tracer::TextureSlot::alpha})
    if (get_tail<path_tracer::TextureRecord>(image, triangle, sizes.texture[int(slot)]).footprints != 0)
      return false;
  return get_tail<path_tracer::CoverageRecord>(image, triangle, sizes.coverage).alpha == 1.0;
}

/// The density by which connections find the disk of a sun; 0 of one that emits nothing.
double pdf_of_sun(const path_tracer::SunRecord& sun, const Lights& lights) {
  constexpr double kSameAngle = 1e-9;
  const auto is_of_sun = [&](const path_tracer::LightRecord& light) {
    return light.shape == static_cast<std::int32_t>(path_tracer::LightShape::distant) &&
           std::abs(light.edge2.x - (1.0 - sun.cosine)) <= kSameAngle * light.edge2.x + 1e-15 &&
           light.normal.x == sun.direction.x && light.normal.y == sun.direction.y &&
           light.normal.z == sun.direction.z;
  };
  const auto light = std::find_if(lights.records.begin(), lights.records.end(), is_of_sun);
  if (light == lights.records.end()) return 0;
  return 1.0 / (2.0 * glm::pi<double>() * light->edge2.x * light->inverse_pdf);
}

/// What light paths need of the scene besides its lights; once surfaces are written.
void put_light_paths(MonoImage& image, const Triangles& triangles, const std::vector<Material>& materials,
                     const Lights& lights) {
  const Surround surround = surround_of(triangles.scene);
  image.layout.centre = to_record(surround.centre);
  image.layout.radius = surround.radius;
  for (std::size_t light = 0; light < lights.records.size(); ++light) {
    const std::vector<std::size_t>& of_light = lights.triangles[light];
    if (of_light.empty()) continue;
    const bool begins = std::all_of(of_light.begin(), of_light.end(), [&](std::size_t triangle) {
      return may_begin_light_paths(image, triangle);
    });
    const std::int32_t material = triangles.scene.triangles[of_light.front()].material;
    path_tracer::LightEmissionRecord emission;
    if (begins) emission.radiance = to_record(materials[std::size_t(material)].emission);
    put(image, image.layout.light_emission + light, &emission, 1);
    image.layout.has_silent_lights = image.layout.has_silent_lights || !begins;
  }
  std::vector<double> sun_pdfs;
  for (const path_tracer::SunRecord& sun : lights.suns) sun_pdfs.push_back(pdf_of_sun(sun, lights));
  put(image, image.layout.sun_pdfs, sun_pdfs.data(), sun_pdfs.size());
}

/// Texels of the environment's image, and suns.
void put_outside(MonoImage& image, const Environment& environment, const Lights& lights) {
  put(image, image.layout.suns, lights.suns.data(), lights.suns.size());
  if (lights.environment_texels.empty()) return;
  path_tracer::EnvironmentImage& of_layout = image.layout.environment_image;
  of_layout.x_axis = to_record(environment.rotation[0]);
  of_layout.y_axis = to_record(environment.rotation[1]);
  of_layout.z_axis = to_record(environment.rotation[2]);
  of_layout.width = environment.image->width;
  of_layout.height = environment.image->height;
  put(image, cn::MonoPointer<path_tracer::EnvironmentTexel>{of_layout.texels},
      lights.environment_texels.data(), lights.environment_texels.size());
}

}  // namespace

MonoImage make_mono_image(const Scene& scene, int num_pes, const path_tracer::ProgramConfig& options,
                          const LightSurvey* survey) {
  const ShownMaterials shown = shown_materials(scene, options);
  path_tracer::ProgramConfig config = options;
  config.features = features_of(scene, shown.materials, options);
  const Triangles triangles(scene);
  const Lights lights = make_lights(scene, triangles.faces, config.light_sampling, survey);
  const double reach = reach_of(scene, config.is_bidirectional());
  TreeImage tree;
  if (config.uses_tree()) tree = make_tree(triangles, reach, config);

  const TextureImages textures(scene, shown.materials, config.features.textures);

  path_tracer::SceneCounts counts;
  counts.triangles = static_cast<int>(scene.triangles.size());
  counts.lights = static_cast<int>(lights.records.size());
  counts.light_classes = static_cast<int>(lights.classes.size());
  counts.tree_slots = static_cast<int>(tree.slots);
  counts.texture_bytes = textures.bytes();
  counts.environment_texels = lights.environment_texels.size();
  counts.suns = static_cast<int>(lights.suns.size());
  counts.has_layers = triangles.layers.layers().any;
  MonoImage image;
  image.textures = shown.textures;
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
  put_surfaces(image, triangles, shown.materials, lights);
  put_textures(image, textures, triangles.count());
  put_shading_kinds(image, scene, shown.materials, config.shading);
  put(image, image.layout.lights, lights.records.data(), lights.records.size());
  if (config.resamples_lights())
    put(image, image.layout.light_candidates, lights.candidates.data(), lights.candidates.size());
  put(image, image.layout.light_cdf, lights.cdf.data(), lights.cdf.size());
  put_outside(image, scene.environment, lights);
  if (config.is_bidirectional()) put_light_paths(image, triangles, shown.materials, lights);
  put(image, image.layout.light_classes, lights.classes.data(), lights.classes.size());
  if (config.uses_tree())
    std::memcpy(image.bytes.data() + image.layout.nodes.address, tree.nodes.data(), tree.nodes.size());
  return image;
}

MonoImage make_normal_mono_image(const Scene& scene, int num_pes, const path_tracer::ProgramConfig& config,
                                 const LightSurvey* survey) {
  return make_mono_image(normalised(scene), num_pes, config, survey);
}

LightSurvey make_normal_light_survey(const Scene& scene, path_tracer::LightSampling sampling) {
  const Scene normal = normalised(scene);
  const CoincidentTriangles coincident = find_coincident_triangles(normal);
  return survey_lights(normal, number_faces(normal.triangles, coincident), sampling);
}

}  // namespace testbench
