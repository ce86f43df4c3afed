#include "testbench/mono_image/tangents.hpp"

#include <algorithm>

#include "testbench/mono_image/barycentric.hpp"
#include "testbench/mono_image/texture_images.hpp"
#include "testbench/mono_image/to_record.hpp"
#include "testbench/texture/sample.hpp"

namespace testbench {
namespace {

const TextureReference& normal_texture(const Scene& scene, std::size_t triangle) {
  return shown_texture(scene.materials[std::size_t(scene.triangles[triangle].material)],
                       path_tracer::TextureSlot::normal);
}

/// The tangents that a file gives for the triangle's normal texture; null if there are none. They describe
/// the texture coordinates as they are: where a texture's transform turns or mirrors them, others are needed.
const CornerTangents* given_tangents(const Scene& scene, std::size_t triangle) {
  const TextureReference& reference = normal_texture(scene, triangle);
  if (!reference || scene.corners.tangents.empty()) return nullptr;
  const TextureTransform& transform = reference.transform;
  const bool is_upright =
      transform.rotation_radians == 0.0 && transform.scale.x > 0.0 && transform.scale.y > 0.0;
  const CornerTangents& tangents = scene.corners.tangents[triangle];
  return is_upright && tangents[0].w != 0.0 ? &tangents : nullptr;
}

bool vary(const CornerTangents& tangents) {
  constexpr double kLeast = 1e-9;
  return glm::length(tangents[1] - tangents[0]) > kLeast || glm::length(tangents[2] - tangents[0]) > kLeast;
}

/// The tangent as an affine function of the position: its slope along each axis.
glm::dmat3 slope_of(const CornerTangents& tangents, const Triangle& triangle) {
  const Barycentric barycentric(triangle);
  return glm::outerProduct(glm::dvec3(tangents[1] - tangents[0]), barycentric.to_u) +
         glm::outerProduct(glm::dvec3(tangents[2] - tangents[0]), barycentric.to_v);
}

}  // namespace

bool has_varying_tangents(const Scene& scene) {
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    if (const CornerTangents* const given = given_tangents(scene, i); given != nullptr && vary(*given))
      return true;
  return false;
}

path_tracer::TangentRecord tangent_record(const Scene& scene, std::size_t triangle) {
  path_tracer::TangentRecord record;
  const Triangle& of = scene.triangles[triangle];
  const Material& material = scene.materials[std::size_t(of.material)];
  const TextureReference& reference = normal_texture(scene, triangle);
  if (!reference) return record;
  record.x_scale = material.normal_scale;
  if (const CornerTangents* const given = given_tangents(scene, triangle)) {
    const glm::dvec3 first((*given)[0]);
    record.tangent = to_record(vary(*given) ? first - slope_of(*given, of) * of.vertex[0] : first);
    record.y_scale = (*given)[0].w * material.normal_scale;
    return record;
  }
  const auto& coordinates = scene.corners.coordinates[std::size_t(reference.coordinate_set)];
  if (coordinates.empty()) return {};
  CornerCoordinates corner = coordinates[triangle];
  for (glm::dvec2& place : corner) place = transformed(reference.transform, place);
  const glm::dvec2 along1 = corner[1] - corner[0];
  const glm::dvec2 along2 = corner[2] - corner[0];
  // Twice the triangle's area in the image, whose v runs downwards: negative where the front shows the image
  // as it is, positive where it shows it mirrored.
  const double area = along1.x * along2.y - along2.x * along1.y;
  const glm::dvec3 edge1 = of.vertex[1] - of.vertex[0];
  const glm::dvec3 edge2 = of.vertex[2] - of.vertex[0];
  const glm::dvec3 tangent = unit_or_zero((edge1 * along2.y - edge2 * along1.y) * (area < 0.0 ? -1.0 : 1.0));
  if (!(area < 0.0 || area > 0.0) || tangent == glm::dvec3(0.0)) return {};
  record.tangent = to_record(tangent);
  record.y_scale = area < 0.0 ? material.normal_scale : -material.normal_scale;
  return record;
}

path_tracer::TangentSlopeRecord tangent_slope_record(const Scene& scene, std::size_t triangle) {
  const CornerTangents* const given = given_tangents(scene, triangle);
  if (given == nullptr || !vary(*given)) return {};
  const glm::dmat3 slope = slope_of(*given, scene.triangles[triangle]);
  return {to_record(slope[0]), to_record(slope[1]), to_record(slope[2])};
}

}  // namespace testbench
