#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "testbench/texture/sample.hpp"

namespace texture_sample_test {

using testbench::sample_texture;
using testbench::TexelEncoding;
using testbench::Texture;
using testbench::TextureFilter;
using testbench::TextureReference;
using testbench::TextureWrap;
using testbench::wrapped_index;

/// A row of grey texels.
Texture row_of(const std::vector<std::uint8_t>& greys, TexelEncoding encoding = TexelEncoding::linear) {
  return {"row", encoding, {static_cast<int>(greys.size()), 1, 1, greys}};
}

TextureReference reference_of(TextureFilter filter, TextureWrap wrap) {
  TextureReference reference;
  reference.texture = 0;
  reference.filter = filter;
  reference.wrap_u = reference.wrap_v = wrap;
  return reference;
}

void expect_pattern(TextureWrap wrap, const std::vector<int>& from_minus_4) {
  for (std::size_t i = 0; i < from_minus_4.size(); ++i)
    EXPECT_EQ(wrapped_index(double(i) - 4.0, 3, wrap), from_minus_4[i]) << double(i) - 4.0;
}

TEST(TextureSample, WrapsAsGltfSays) {
  expect_pattern(TextureWrap::repeat, {2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0});
  expect_pattern(TextureWrap::mirrored_repeat, {2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0});
  expect_pattern(TextureWrap::clamp_to_edge, {0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2});
}

TEST(TextureSample, WrapsCoordinatesOfAnySize) {
  const Texture texture = row_of({10, 20, 30});
  for (const TextureWrap wrap :
       {TextureWrap::repeat, TextureWrap::mirrored_repeat, TextureWrap::clamp_to_edge})
    for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::linear})
      for (const double u : {1e18, -1e18, 1e300, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN(), -0.0, 0x1p-1074}) {
        const double value = sample_texture(texture, reference_of(filter, wrap), {u, u}).x;
        EXPECT_GE(value, 10.0 / 255.0);
        EXPECT_LE(value, 30.0 / 255.0);
      }
}

/// The upper left corner of the image is (0, 0), centres of texels lie at halves.
TEST(TextureSample, FindsTexelsFromTheUpperLeft) {
  const Texture texture{
      "", TexelEncoding::linear, {2, 2, 3, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}}};
  for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::linear}) {
    const TextureReference reference = reference_of(filter, TextureWrap::repeat);
    EXPECT_EQ(sample_texture(texture, reference, {0.25, 0.25}), glm::dvec4(1, 0, 0, 1));
    EXPECT_EQ(sample_texture(texture, reference, {0.75, 0.25}), glm::dvec4(0, 1, 0, 1));
    EXPECT_EQ(sample_texture(texture, reference, {0.25, 0.75}), glm::dvec4(0, 0, 1, 1));
    EXPECT_EQ(sample_texture(texture, reference, {0.75, 0.75}), glm::dvec4(1, 1, 1, 1));
  }
}

/// At the edge, a linear filter takes half of the texel that each way of wrapping puts beyond it.
TEST(TextureSample, FiltersBeyondTheEdgeByTheWrap) {
  const Texture texture = row_of({0, 51, 255});
  const auto at_left_edge = [&](TextureWrap wrap) {
    return sample_texture(texture, reference_of(TextureFilter::linear, wrap), {0.0, 0.5}).x;
  };
  EXPECT_DOUBLE_EQ(at_left_edge(TextureWrap::repeat), 0.5);
  EXPECT_DOUBLE_EQ(at_left_edge(TextureWrap::mirrored_repeat), 0.0);
  EXPECT_DOUBLE_EQ(at_left_edge(TextureWrap::clamp_to_edge), 0.0);
  const TextureReference repeat = reference_of(TextureFilter::linear, TextureWrap::repeat);
  EXPECT_DOUBLE_EQ(sample_texture(texture, repeat, {0.25, 0.5}).x, 0.25 * 0.2);
  EXPECT_DOUBLE_EQ(sample_texture(texture, repeat, {1.25, -7.5}).x, 0.25 * 0.2);
}

TEST(TextureSample, DecodesSrgbBeforeItFilters) {
  EXPECT_EQ(testbench::linear_of_srgb(0), 0.0);
  EXPECT_EQ(testbench::linear_of_srgb(255), 1.0);
  EXPECT_NEAR(testbench::linear_of_srgb(10), 10.0 / 255.0 / 12.92, 1e-17);  // below 0.04045
  EXPECT_NEAR(testbench::linear_of_srgb(188), 0.502886458033, 1e-12);
  const Texture texture = row_of({0, 255}, TexelEncoding::srgb);
  const TextureReference reference = reference_of(TextureFilter::linear, TextureWrap::clamp_to_edge);
  EXPECT_DOUBLE_EQ(sample_texture(texture, reference, {0.5, 0.5}).x, 0.5);
  const Texture with_alpha{"", TexelEncoding::srgb, {1, 1, 2, {188, 188}}};
  EXPECT_DOUBLE_EQ(sample_texture(with_alpha, reference, {0.5, 0.5}).a, 188.0 / 255.0);
}

/// The example of the extension's specification: the lower left quadrant of the image, turned by 90 degrees.
TEST(TextureSample, TransformsAsTheExtensionsExample) {
  testbench::TextureTransform transform;
  transform.offset = {0.0, 1.0};
  transform.rotation_radians = glm::half_pi<double>();
  transform.scale = {0.5, 0.5};
  for (const double u : {0.0, 0.3, 1.0})
    for (const double v : {0.0, 0.6, 1.0}) {
      const glm::dvec2 place = testbench::transformed(transform, {u, v});
      EXPECT_NEAR(place.x, 0.5 * v, 1e-15);
      EXPECT_NEAR(place.y, 1.0 - 0.5 * u, 1e-15);
    }
}

TEST(TextureSample, ScalesBeforeItRotatesAndMoves) {
  testbench::TextureTransform transform;
  transform.offset = {10.0, 20.0};
  transform.rotation_radians = glm::half_pi<double>();
  transform.scale = {2.0, 3.0};
  const glm::dvec2 place = testbench::transformed(transform, {1.0, 0.0});
  EXPECT_NEAR(place.x, 10.0, 1e-14);
  EXPECT_NEAR(place.y, 18.0, 1e-14);
}

}  // namespace texture_sample_test
