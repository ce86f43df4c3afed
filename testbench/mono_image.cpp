#include "testbench/mono_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "testbench/error.hpp"

namespace testbench {
namespace {

using path_tracer::CameraRecord;
using path_tracer::LightRecord;
using path_tracer::LightShape;
using path_tracer::SurfaceRecord;
using path_tracer::TriangleRecord;

cn::vec3<double> to_record(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

CameraRecord camera_record(const Camera& camera, const FilmSize& film) {
  const glm::dvec3 right = glm::cross(camera.direction, camera.up);
  const double pixel_size = 2.0 * std::tan(0.5 * camera.vertical_field_of_view_radians) / film.height;
  CameraRecord record;
  record.position = to_record(camera.position);
  record.right = to_record(right * pixel_size);
  record.down = to_record(-camera.up * pixel_size);
  record.corner = to_record(camera.direction - right * (0.5 * film.width * pixel_size) +
                            camera.up * (0.5 * film.height * pixel_size));
  record.width = film.width;
  record.height = film.height;
  return record;
}

TriangleRecord triangle_record(const Triangle& triangle, std::int32_t face) {
  return path_tracer::triangle_record(to_record(triangle.vertex[0]),
                                      to_record(triangle.vertex[1] - triangle.vertex[0]),
                                      to_record(triangle.vertex[2] - triangle.vertex[0]), face);
}

SurfaceRecord surface_record(const Triangle& triangle, const Material& material, std::int32_t face) {
  SurfaceRecord record;
  record.normal = to_record(glm::normalize(area_normal(triangle)));
  record.reflectance = to_record(material.reflectance);
  record.emission = to_record(material.emission);
  record.face = face;
  return record;
}

struct Lights {
  std::vector<LightRecord> records;
  std::vector<double> cdf;
};

/// Part of the scene that is sampled as one light.
struct Emitter {
  glm::dvec3 vertex;
  glm::dvec3 edge1;
  glm::dvec3 edge2;
  LightShape shape;
  std::int32_t material;
  std::int32_t face;
};

double area(const Emitter& emitter) {
  const double parallelogram = glm::length(glm::cross(emitter.edge1, emitter.edge2));
  return emitter.shape == LightShape::triangle ? 0.5 * parallelogram : parallelogram;
}

/// What a light sends out in all, up to a common factor; lights are chosen in proportion to it.
double power(const Emitter& emitter, const Scene& scene) {
  const glm::dvec3& emission = scene.materials[std::size_t(emitter.material)].emission;
  return area(emitter) * (emission.x + emission.y + emission.z);
}

/// The rectangle that two triangles of one face and material make, if they do: within rounding of a right
/// angle, 2^-40.
std::optional<Emitter> join(const Emitter& a, const Emitter& b) {
  constexpr double kTolerance = 0x1p-40;
  if (a.face != b.face || a.material != b.material) return {};
  const glm::dvec3 corners_a[3] = {a.vertex, a.vertex + a.edge1, a.vertex + a.edge2};
  const glm::dvec3 corners_b[3] = {b.vertex, b.vertex + b.edge1, b.vertex + b.edge2};
  for (int i = 0; i < 3; ++i) {
    // The right angle at a corner of one, its opposite at a corner of the other.
    Emitter joined = a;
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
        is_corner_of_b(joined.vertex + joined.edge1 + joined.edge2))
      return joined;
  }
  return {};
}

std::vector<Emitter> find_emitters(const Scene& scene, const std::vector<std::int32_t>& faces) {
  std::vector<Emitter> emitters;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& triangle = scene.triangles[i];
    const Emitter emitter{triangle.vertex[0],
                          triangle.vertex[1] - triangle.vertex[0],
                          triangle.vertex[2] - triangle.vertex[0],
                          LightShape::triangle,
                          triangle.material,
                          faces[i]};
    if (power(emitter, scene) > 0) emitters.push_back(emitter);
  }
  return emitters;
}

/// Puts rectangles in the place of their halves, where the scene lists one after the other.
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
  for (const Emitter& emitter : emitters) total_power += power(emitter, scene);
  if (!(total_power > 0))
    throw InputError(scene.name + ": no triangle emits light; a material with Ke above 0 is needed");

  Lights lights;
  double power_so_far = 0;
  for (const Emitter& emitter : emitters) {
    const double pdf = power(emitter, scene) / total_power / area(emitter);
    LightRecord record;
    record.vertex = to_record(emitter.vertex);
    record.edge1 = to_record(emitter.edge1);
    record.edge2 = to_record(emitter.edge2);
    record.normal = to_record(glm::normalize(glm::cross(emitter.edge1, emitter.edge2)));
    record.inverse_pdf = 1.0 / pdf;
    record.face = emitter.face;
    record.shape = static_cast<std::int32_t>(emitter.shape);
    lights.records.push_back(record);
    power_so_far += power(emitter, scene);
    lights.cdf.push_back(power_so_far / total_power);
  }
  return lights;
}

template <class Record>
void put(MonoImage& image, cn::MonoPointer<Record> to, const Record* records, std::size_t count) {
  std::memcpy(image.bytes.data() + to.address, records, count * sizeof(Record));
}

using Point = std::array<double, 3>;
using Edge = std::pair<Point, Point>;

Edge make_edge(const glm::dvec3& a, const glm::dvec3& b) {
  const Point p{a.x, a.y, a.z};
  const Point q{b.x, b.y, b.z};
  return p < q ? Edge{p, q} : Edge{q, p};
}

/// Within rounding of the plane through `triangle`: 2^-40 of the distances involved.
bool lies_in_plane(const Triangle& triangle, const Triangle& other) {
  constexpr double kTolerance = 0x1p-40;
  const glm::dvec3 normal = glm::normalize(area_normal(triangle));
  return std::all_of(std::begin(other.vertex), std::end(other.vertex), [&](const glm::dvec3& vertex) {
    const glm::dvec3 offset = vertex - triangle.vertex[0];
    return std::abs(glm::dot(offset, normal)) <= kTolerance * glm::length(offset);
  });
}

}  // namespace

glm::dvec3 area_normal(const Triangle& triangle) {
  return glm::cross(triangle.vertex[1] - triangle.vertex[0], triangle.vertex[2] - triangle.vertex[0]);
}

std::vector<std::int32_t> number_faces(const std::vector<Triangle>& triangles) {
  std::map<Edge, std::vector<std::size_t>> by_edge;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      by_edge[make_edge(triangles[i].vertex[k], triangles[i].vertex[(k + 1) % 3])].push_back(i);

  std::vector<std::int32_t> faces(triangles.size(), path_tracer::kNoFace);
  std::int32_t next_face = 0;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (faces[seed] != path_tracer::kNoFace) continue;
    faces[seed] = next_face;
    std::vector<std::size_t> open{seed};
    while (!open.empty()) {
      const Triangle& current = triangles[open.back()];
      open.pop_back();
      for (int k = 0; k < 3; ++k) {
        for (const std::size_t neighbour :
             by_edge[make_edge(current.vertex[k], current.vertex[(k + 1) % 3])]) {
          if (faces[neighbour] != path_tracer::kNoFace ||
              !lies_in_plane(triangles[seed], triangles[neighbour]))
            continue;
          faces[neighbour] = next_face;
          open.push_back(neighbour);
        }
      }
    }
    ++next_face;
  }
  return faces;
}

MonoImage make_mono_image(const Scene& scene, int num_pes, const path_tracer::ProgramConfig& config) {
  const std::vector<std::int32_t> faces = number_faces(scene.triangles);
  const Lights lights = make_lights(scene, faces, config.light_sampling);
  std::vector<TriangleRecord> triangles;
  std::vector<SurfaceRecord> surfaces;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& triangle = scene.triangles[i];
    triangles.push_back(triangle_record(triangle, faces[i]));
    surfaces.push_back(surface_record(triangle, scene.materials[std::size_t(triangle.material)], faces[i]));
  }
  const CameraRecord camera = camera_record(scene.camera, scene.film);

  MonoImage image;
  image.layout = path_tracer::make_layout(static_cast<int>(triangles.size()),
                                          static_cast<int>(lights.records.size()), num_pes, config);
  image.bytes.resize(image.layout.scene_bytes);
  put(image, image.layout.camera, &camera, 1);
  put(image, image.layout.triangles, triangles.data(), triangles.size());
  put(image, image.layout.surfaces, surfaces.data(), surfaces.size());
  put(image, image.layout.lights, lights.records.data(), lights.records.size());
  put(image, image.layout.light_cdf, lights.cdf.data(), lights.cdf.size());
  return image;
}

}  // namespace testbench
