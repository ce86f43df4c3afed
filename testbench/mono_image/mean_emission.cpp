#include "testbench/mono_image/mean_emission.hpp"

#include <map>

#include "testbench/texture/sample.hpp"

namespace testbench {
namespace {

glm::dvec3 mean_of_texels(const Texture& texture) {
  glm::dvec3 sum(0.0);
  for (int y = 0; y < texture.image.height; ++y)
    for (int x = 0; x < texture.image.width; ++x) sum += glm::dvec3(texel_at(texture, x, y));
  return sum / (double(texture.image.width) * texture.image.height);
}

/// The mean over points of a grid in the triangle.
glm::dvec3 mean_at_points(const Texture& texture, const TextureReference& reference,
                          const CornerCoordinates& corner) {
  constexpr int kPerEdge = 8;
  glm::dvec3 sum(0.0);
  int points = 0;
  for (int i = 0; i < kPerEdge; ++i) {
    for (int j = 0; i + j < kPerEdge; ++j) {
      const double u = (i + 1.0 / 3.0) / kPerEdge;
      const double v = (j + 1.0 / 3.0) / kPerEdge;
      sum += glm::dvec3(sample_texture(
          texture, reference, corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0])));
      ++points;
    }
  }
  return sum / double(points);
}

}  // namespace

MeanEmission::MeanEmission(const Scene& scene) : scene_(scene) {
  std::map<std::int32_t, glm::dvec3> of_texture;
  for (const Material& material : scene.materials) {
    of_material_.push_back(material.emission);
    const std::int32_t texture = material.textures.emission.texture;
    if (texture == kNoTexture) continue;
    const auto [mean, is_new] = of_texture.emplace(texture, 0.0);
    if (is_new) mean->second = mean_of_texels(scene.textures[std::size_t(texture)]);
    of_material_.back() *= mean->second;
  }
}

glm::dvec3 MeanEmission::of_triangle(std::size_t index) const {
  constexpr double kShareOfMaterial = 1.0 / 16.0;
  const std::int32_t number = scene_.triangles[index].material;
  const Material& material = scene_.materials[std::size_t(number)];
  const TextureReference& reference = material.textures.emission;
  if (!reference) return material.emission;
  const auto& coordinates = scene_.corners.coordinates[std::size_t(reference.coordinate_set)];
  const CornerCoordinates corner = coordinates.empty() ? CornerCoordinates{} : coordinates[index];
  const Texture& texture = scene_.textures[std::size_t(reference.texture)];
  const glm::dvec3 here = material.emission * mean_at_points(texture, reference, corner);
  return glm::mix(here, of_material(number), kShareOfMaterial);
}

}  // namespace testbench
