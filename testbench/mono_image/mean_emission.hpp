#pragma once

#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// How bright surfaces are on average, to choose lights by.
class MeanEmission {
 public:
  explicit MeanEmission(const Scene& scene);

  /// Mean radiance of a material over its texture. 0 only where no texel emits.
  const glm::dvec3& of_material(std::int32_t material) const { return of_material_[std::size_t(material)]; }
  /// An estimate for a triangle of the scene, 0 only where of_material() is: a light that a few texels make
  /// is not missed. Without a texture it is exact.
  glm::dvec3 of_triangle(std::size_t index) const;

 private:
  const Scene& scene_;
  std::vector<glm::dvec3> of_material_;
};

}  // namespace testbench
