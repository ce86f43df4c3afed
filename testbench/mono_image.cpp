#include "testbench/mono_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "testbench/error.hpp"

namespace testbench {
namespace {

using path_tracer::CameraRecord;
using path_tracer::LightRecord;
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
  TriangleRecord record;
  record.vertex = to_record(triangle.vertex[0]);
  record.edge1 = to_record(triangle.vertex[1] - triangle.vertex[0]);
  record.edge2 = to_record(triangle.vertex[2] - triangle.vertex[0]);
  record.face = face;
  return record;
}

SurfaceRecord surface_record(const Triangle& triangle, const Material& material, std::int32_t face) {
  SurfaceRecord record;
  record.normal = to_record(glm::normalize(area_normal(triangle)));
  record.reflectance = to_record(material.reflectance);
  record.emission = to_record(material.emission);
  record.face = face;
  return record;
}

/// What a light sends out in all, up to a common factor; lights are chosen in proportion to it.
double light_power(const Triangle& triangle, const Material& material) {
  return glm::length(area_normal(triangle)) *
         (material.emission.x + material.emission.y + material.emission.z);
}

struct Lights {
  std::vector<LightRecord> records;
  std::vector<double> cdf;
};

Lights make_lights(const Scene& scene, const std::vector<std::int32_t>& faces) {
  double total_power = 0;
  for (const Triangle& triangle : scene.triangles)
    total_power += light_power(triangle, scene.materials[std::size_t(triangle.material)]);
  if (!(total_power > 0))
    throw InputError(scene.name + ": no triangle emits light; a material with Ke above 0 is needed");

  Lights lights;
  double power_so_far = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& triangle = scene.triangles[i];
    const Material& material = scene.materials[std::size_t(triangle.material)];
    const double power = light_power(triangle, material);
    if (!(power > 0)) continue;
    const glm::dvec3 twice_area = area_normal(triangle);
    const double pdf = power / total_power / (0.5 * glm::length(twice_area));
    LightRecord record;
    record.vertex = to_record(triangle.vertex[0]);
    record.edge1 = to_record(triangle.vertex[1] - triangle.vertex[0]);
    record.edge2 = to_record(triangle.vertex[2] - triangle.vertex[0]);
    record.normal_over_pdf = to_record(glm::normalize(twice_area) / pdf);
    record.face = faces[i];
    lights.records.push_back(record);
    power_so_far += power;
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
  const Lights lights = make_lights(scene, faces);
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
