// Height maps as normal textures, against normals of planes.

#include "testbench/texture/height_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace height_map_test {

using testbench::HeightMap;
using testbench::Image;
using testbench::normals_of_heights;
using testbench::TextureWrap;

/// Grey codes that rise by `right` from texel to texel and by `down` from row to row.
Image slope(int right, int down) {
  Image image{5, 4, 1, {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.texels.push_back(static_cast<std::uint8_t>(100 + right * x + down * y));
  return image;
}

std::array<int, 3> texel(const Image& normals, int x, int y) {
  const std::size_t first = 3 * (std::size_t(y) * std::size_t(normals.width) + std::size_t(x));
  return {normals.texels[first], normals.texels[first + 1], normals.texels[first + 2]};
}

/// Code of a component of a unit vector.
int code_of(double component) {
  return int(std::lround(127.5 * (component + 1.0)));
}

/// Five codes a texel at 51 texels for white are a slope of one. What rises to the right leans to the left,
/// what rises downwards leans upwards.
TEST(HeightMaps, SlopesAreNormalsOfPlanes) {
  const int low = code_of(-std::sqrt(0.5));
  const int high = code_of(std::sqrt(0.5));
  const int flat = code_of(0.0);
  using Normal = std::array<int, 3>;
  EXPECT_EQ(texel(normals_of_heights(slope(5, 0), {0, 51.0}), 2, 1), (Normal{low, flat, high}));
  EXPECT_EQ(texel(normals_of_heights(slope(0, 5), {0, 51.0}), 2, 1), (Normal{flat, high, high}));
  EXPECT_EQ(texel(normals_of_heights(slope(5, 0), {0, -51.0}), 2, 1), (Normal{high, flat, high}));
  const double third = std::sqrt(1.0 / 3.0);
  EXPECT_EQ(texel(normals_of_heights(slope(5, -5), {0, 51.0}), 2, 1),
            (Normal{code_of(-third), code_of(-third), code_of(third)}));
  EXPECT_EQ(texel(normals_of_heights(slope(5, 0), {0, 25.5}), 2, 1),
            (Normal{code_of(-0.5 / std::sqrt(1.25)), flat, code_of(1.0 / std::sqrt(1.25))}));
  EXPECT_EQ(texel(normals_of_heights(slope(5, 5), {0, 0.0}), 2, 1), (Normal{flat, flat, 255}));
}

/// Beyond an edge stands what the wrap says: the other edge, or the same texel again.
TEST(HeightMaps, EdgesAreWrapped) {
  HeightMap map{0, 51.0};
  EXPECT_EQ(texel(normals_of_heights(slope(5, 0), map), 0, 1)[0],
            code_of(1.5 / std::sqrt(1.5 * 1.5 + 1.0)));  // from 20 codes above to 5 above
  map.wrap_u = map.wrap_v = TextureWrap::clamp_to_edge;
  EXPECT_EQ(texel(normals_of_heights(slope(5, 0), map), 0, 1)[0], code_of(-0.5 / std::sqrt(1.25)));
  EXPECT_EQ(texel(normals_of_heights(slope(0, 5), map), 0, 3)[1], code_of(0.5 / std::sqrt(1.25)));
}

TEST(HeightMaps, CliffsLeanAllTheWay) {
  EXPECT_EQ(texel(normals_of_heights(slope(5, 0), {0, 1e308}), 2, 1),
            (std::array<int, 3>{0, code_of(0.0), code_of(0.0)}));
}

TEST(HeightMaps, TakeTheirChannel) {
  Image image = slope(0, 0);
  image.channels = 2;  // grey and alpha, row by row
  image.texels.assign(40, 0);
  for (std::size_t i = 0; i < 20; ++i) image.texels[2 * i + 1] = static_cast<std::uint8_t>(5 * (i % 5));
  EXPECT_EQ(texel(normals_of_heights(image, {1, 51.0}), 2, 1)[0], code_of(-std::sqrt(0.5)));
  EXPECT_EQ(texel(normals_of_heights(image, {0, 51.0}), 2, 1)[0], code_of(0.0));
}

}  // namespace height_map_test
