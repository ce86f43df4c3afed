#include "testbench/mono_image/tangents.hpp"

#include "testbench/mono_image/texture_images.hpp"
#include "testbench/texture/sample.hpp"

namespace testbench {

path_tracer::TangentRecord tangent_record(const Scene& scene, std::size_t triangle) {
  path_tracer::TangentRecord record;
  const Triangle& of = scene.triangles[triangle];
  const Material& material = scene.materials[std::size_t(of.material)];
  const TextureReference& reference = shown_texture(material, path_tracer::TextureSlot::normal);
  if (!reference) return record;
  const auto& coordinates = scene.corners.coordinates[std::size_t(reference.coordinate_set)];
  if (coordinates.empty()) return record;
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
  if (!(area < 0.0 || area > 0.0) || tangent == glm::dvec3(0.0)) return record;
  record.tangent = {tangent.x, tangent.y, tangent.z};
  record.x_scale = material.normal_scale;
  record.y_scale = area < 0.0 ? material.normal_scale : -material.normal_scale;
  return record;
}

}  // namespace testbench
