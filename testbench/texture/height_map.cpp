#include "testbench/texture/height_map.hpp"

#include <algorithm>
#include <cmath>

#include "testbench/texture/sample.hpp"

namespace testbench {
namespace {

class Heights {
 public:
  Heights(const Image& image, const HeightMap& map) : image_(image), map_(map) {}

  /// In texels. @param x, y also beyond the image's edge
  double at(int x, int y) const {
    const int column = wrapped_index(x, image_.width, map_.wrap_u);
    const int row = wrapped_index(y, image_.height, map_.wrap_v);
    const std::size_t texel = std::size_t(row) * std::size_t(image_.width) + std::size_t(column);
    const std::uint8_t* const codes = &image_.texels[texel * std::size_t(image_.channels)];
    return map_.white_texels * (codes[map_.channel] / 255.0);
  }

  /// y grows upwards, rows downwards.
  glm::dvec3 normal_at(int x, int y) const {
    const glm::dvec3 normal(0.5 * (at(x - 1, y) - at(x + 1, y)), 0.5 * (at(x, y + 1) - at(x, y - 1)), 1.0);
    // Divided first, so that the square of a steep slope does not overflow.
    return glm::normalize(normal / std::max({std::abs(normal.x), std::abs(normal.y), 1.0}));
  }

 private:
  const Image& image_;
  const HeightMap& map_;
};

}  // namespace

Image normals_of_heights(const Image& heights, const HeightMap& map) {
  const Heights field(heights, map);
  Image normals{heights.width, heights.height, 3, {}};
  normals.texels.reserve(3 * std::size_t(heights.width) * std::size_t(heights.height));
  for (int y = 0; y < heights.height; ++y) {
    for (int x = 0; x < heights.width; ++x) {
      const glm::dvec3 normal = field.normal_at(x, y);
      for (int axis = 0; axis < 3; ++axis)
        normals.texels.push_back(static_cast<std::uint8_t>(std::lround(127.5 * (normal[axis] + 1.0))));
    }
  }
  return normals;
}

}  // namespace testbench
