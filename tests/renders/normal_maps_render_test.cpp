// Whole renders of normal maps, against surfaces that have the same normals at their corners.

#include <gtest/gtest.h>

#include <cmath>

#include "testbench/mono_image/scene_features.hpp"
#include "testbench/run/render.hpp"
#include "testbench/texture/sample.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"

namespace normal_maps_render_test {

using path_tracer::Program;
using testbench::Film;
using testbench::RenderOptions;
using testbench::Scene;

constexpr std::uint8_t kLeaning[] = {200, 160, 220};

glm::dvec3 decoded(const std::uint8_t (&texel)[3]) {
  return glm::normalize(glm::dvec3(texel[0], texel[1], texel[2]) * (2.0 / 255.0) - 1.0);
}

/// A leaning square that fills the view, of gloss over grey, with a normal map of one texel; a lamp to the
/// left above it. Its front shows the image upright, `right` to the right.
struct MappedSquare {
  glm::dvec3 right = glm::normalize(glm::dvec3(1.0, 0.1, 0.3));
  glm::dvec3 up = glm::normalize(glm::cross(glm::dvec3(-0.2, 0.1, 1.0), right));
  glm::dvec3 front = glm::cross(right, up);
  Scene scene;

  MappedSquare() {
    scene.name = "mapped square";
    scene.film = {8, 8};
    scene.camera.position = {0, 0, 9};
    scene.camera.direction = {0, 0, -1};
    scene.camera.orthographic_height = 2.0;
    scene.textures.push_back({"normals", testbench::TexelEncoding::linear, {1, 1, 3, {}}});
    testbench::Material square;
    square.reflectance = glm::dvec3(0.5);
    square.specular = 1.0;
    square.roughness = 0.6;
    square.textures.normal.texture = 0;
    testbench::Material lamp;
    lamp.emission = glm::dvec3(10.0);
    scene.materials = {square, lamp};
    show(kLeaning);
    test_support::add_textured_square(
        scene, {{-3.0 * (right + up), 3.0 * (right - up), 3.0 * (right + up), -3.0 * (right - up)}}, 0);
    test_support::add_textured_square(scene, {{{-6, 3, 9}, {-6, 5, 9}, {-4, 5, 9}, {-4, 3, 9}}}, 1);
  }

  void show(const std::uint8_t (&texel)[3]) { scene.textures[0].image.texels.assign(texel, texel + 3); }

  /// Turns the square's back to the camera, around its upward edge. The image stays on the front.
  void turn_round() {
    right *= -1.0;
    front *= -1.0;
    for (std::size_t i = 0; i < 2; ++i)
      for (glm::dvec3& vertex : scene.triangles[i].vertex)
        vertex = right * -glm::dot(vertex, right) + up * glm::dot(vertex, up);
  }

  /// The same square without the map, with normals at its corners. @param x, y, z in the image's directions
  Scene with_normals(const glm::dvec3& normal) const {
    Scene bare = scene;
    bare.materials[0].textures = {};
    const glm::dvec3 turned = right * normal.x + up * normal.y + front * normal.z;
    bare.corners.normals.assign(4, {});
    for (std::size_t i = 0; i < 2; ++i) bare.corners.normals[i] = {turned, turned, turned};
    return bare;
  }
};

Film film_of(const Scene& scene, Program program = Program::full) {
  return testbench::render_natively(scene, test_support::render_options(program, 16)).film;
}

/// All random numbers are the same, so that nothing but rounding makes a difference.
void expect_equal(const Film& a, const Film& b, double relative) {
  double sum = 0.0;
  for (int pixel = 0; pixel < a.pixel_count(); ++pixel) {
    EXPECT_NEAR(a.mean(pixel).x, b.mean(pixel).x, relative * b.mean(pixel).x) << pixel;
    sum += b.mean(pixel).x;
  }
  EXPECT_GT(sum, 0.0);
}

constexpr double kRounding = 1e-9;

TEST(NormalMaps, ALeaningMapIsALeaningNormal) {
  MappedSquare square;
  expect_equal(film_of(square.scene), film_of(square.with_normals(decoded(kLeaning))), kRounding);
  const Film flat = film_of(square.with_normals({0, 0, 1}));
  const double difference = std::abs(flat.mean(27).x / film_of(square.scene).mean(27).x - 1.0);
  EXPECT_GT(difference, 0.05);
}

TEST(NormalMaps, ABackIsTheFrontTurnedInsideOut) {
  MappedSquare square;
  square.turn_round();
  expect_equal(film_of(square.scene), film_of(square.with_normals(decoded(kLeaning))), kRounding);
}

/// x follows the image to the right and y upwards, however the image lies on the square.
TEST(NormalMaps, MirroredAndTurnedImagesTakeTheirNormalsAlong) {
  MappedSquare square;
  const glm::dvec3 n = decoded(kLeaning);
  testbench::TextureTransform& transform = square.scene.materials[0].textures.normal.transform;
  transform.scale = {-2.0, 1.0};
  expect_equal(film_of(square.scene), film_of(square.with_normals({-n.x, n.y, n.z})), kRounding);
  transform.scale = {1.0, -3.0};
  expect_equal(film_of(square.scene), film_of(square.with_normals({n.x, -n.y, n.z})), kRounding);
  transform.scale = {-1.0, -1.0};
  expect_equal(film_of(square.scene), film_of(square.with_normals({-n.x, -n.y, n.z})), kRounding);
  // Coordinates turn counter-clockwise (KHR_texture_transform), so u grows where -v of the square did.
  transform.scale = {1.0, 1.0};
  transform.rotation_radians = std::acos(0.0);
  const glm::dvec2 u_of_square =
      testbench::transformed(transform, {1, 0}) - testbench::transformed(transform, {0, 0});
  const glm::dvec2 v_of_square =
      testbench::transformed(transform, {0, 1}) - testbench::transformed(transform, {0, 0});
  const glm::dvec3 turned{u_of_square.x * n.x - u_of_square.y * n.y,
                          -v_of_square.x * n.x + v_of_square.y * n.y, n.z};
  expect_equal(film_of(square.scene), film_of(square.with_normals(turned)), kRounding);
}

TEST(NormalMaps, TheScaleMultipliesXAndY) {
  MappedSquare square;
  square.scene.materials[0].normal_scale = 0.25;
  const glm::dvec3 n = decoded(kLeaning) * glm::dvec3(0.25, 0.25, 1.0);
  expect_equal(film_of(square.scene), film_of(square.with_normals(glm::normalize(n))), kRounding);
}

/// No code of 8 bits is 0: a flat map leans by half a step in x and y.
TEST(NormalMaps, AFlatMapChangesNothing) {
  MappedSquare square;
  const Film flat = film_of(square.with_normals({0, 0, 1}));
  square.show({128, 128, 255});
  expect_equal(film_of(square.scene), flat, 0.02);
  square.scene.materials[0].normal_scale = 0.0;
  expect_equal(film_of(square.scene), flat, kRounding);
}

/// Without an area in the image there is no tangent, and nothing leans.
TEST(NormalMaps, CoordinatesWithoutAnAreaLeaveTheSurfaceFlat) {
  MappedSquare square;
  for (testbench::CornerCoordinates& corner : square.scene.corners.coordinates[0]) corner = {};
  expect_equal(film_of(square.scene), film_of(square.with_normals({0, 0, 1})), kRounding);
  square.scene.corners.coordinates[0].clear();
  expect_equal(film_of(square.scene), film_of(square.with_normals({0, 0, 1})), kRounding);
}

/// Tangents of a file go before those of texture coordinates: x along the tangent, y along normal x tangent,
/// on the side that the file says.
TEST(NormalMaps, TangentsOfTheFileTurnTheMap) {
  MappedSquare square;
  const glm::dvec3 n = decoded(kLeaning);
  const auto turn_to = [&](const glm::dvec3& tangent, double side) {
    const glm::dvec4 given(tangent, side);
    square.scene.corners.tangents.assign(4, {given, given, given});
    EXPECT_FALSE(testbench::features_of(square.scene, {}).tangents);
    return film_of(square.scene);
  };
  expect_equal(turn_to(square.right, 1.0), film_of(square.with_normals(n)), kRounding);
  expect_equal(turn_to(square.right, -1.0), film_of(square.with_normals({n.x, -n.y, n.z})), kRounding);
  expect_equal(turn_to(square.up, 1.0), film_of(square.with_normals({-n.y, n.x, n.z})), kRounding);
  expect_equal(turn_to(square.up, -1.0), film_of(square.with_normals({n.y, n.x, n.z})), kRounding);
  // They describe coordinates before the texture's transform. One that mirrors needs tangents of its own.
  square.scene.materials[0].textures.normal.transform.scale = {-1.0, 1.0};
  expect_equal(turn_to(square.up, 1.0), film_of(square.with_normals({-n.x, n.y, n.z})), kRounding);
}

/// Over the square, the tangent turns from the right to the right and upwards. Each pixel shows what the
/// tangent at its middle gives.
TEST(NormalMaps, TangentsThatVaryAreInterpolated) {
  MappedSquare square;
  const auto tangent_at = [&](const glm::dvec3& position) {
    return square.right + square.up * (0.25 * (glm::dot(position, square.right) + 3.0));
  };
  Scene scene = square.scene;
  scene.corners.tangents.resize(4);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t corner = 0; corner < 3; ++corner)
      scene.corners.tangents[i][corner] = glm::dvec4(tangent_at(scene.triangles[i].vertex[corner]), 1.0);
  EXPECT_TRUE(testbench::features_of(scene, {}).tangents);
  const Film varying = film_of(scene);
  double largest = 0.0;
  for (const int x : {0, 3, 7}) {
    // The camera sees the square along z, in a view of 2 x 2 around its middle.
    const double at_x = (x + 0.5) / 4.0 - 1.0;
    const double at_y = 1.0 - (3 + 0.5) / 4.0;
    const double at_z = -(square.front.x * at_x + square.front.y * at_y) / square.front.z;
    const glm::dvec4 here(tangent_at({at_x, at_y, at_z}), 1.0);
    square.scene.corners.tangents.assign(4, {here, here, here});
    const int pixel = 3 * 8 + x;
    const double expected = film_of(square.scene).mean(pixel).x;
    EXPECT_NEAR(varying.mean(pixel).x, expected, 0.005 * expected) << x;
    const double without = film_of(square.with_normals(decoded(kLeaning))).mean(pixel).x;
    largest = std::max(largest, std::abs(without / expected - 1.0));
  }
  EXPECT_GT(largest, 0.05);
}

/// The map is laid on the interpolated normal, not on the triangle's.
TEST(NormalMaps, TheMapLeansFromTheNormalsOfCorners) {
  MappedSquare square;
  const double angle = 0.4;
  Scene mapped = square.scene;
  mapped.corners.normals = square.with_normals({std::sin(angle), 0.0, std::cos(angle)}).corners.normals;
  const glm::dvec3 n = decoded(kLeaning);
  const glm::dvec3 leaning{std::cos(angle) * n.x + std::sin(angle) * n.z, n.y,
                           std::cos(angle) * n.z - std::sin(angle) * n.x};
  expect_equal(film_of(mapped), film_of(square.with_normals(leaning)), kRounding);
}

/// Bumps in a white furnace take light away, where directions end below the surface, and add none.
TEST(NormalMaps, BumpsAddNoLight) {
  for (const double metallic : {0.0, 1.0}) {
    MappedSquare square;
    square.scene.textures[0] = test_support::random_texture(8, 8, 3, testbench::TexelEncoding::linear);
    testbench::Material& white = square.scene.materials[0];
    white.reflectance = glm::dvec3(1.0);
    white.metallic = metallic;
    white.specular = metallic;
    square.scene.materials[1] = {};
    square.scene.triangles.resize(2);
    square.scene.corners.coordinates[0].resize(2);
    square.scene.environment.constant = glm::dvec3(1.0);
    RenderOptions options = test_support::render_options(Program::full, 512);
    options.program.sampler = path_tracer::Sampler::philox;
    const Film film = testbench::render_natively(square.scene, options).film;
    double mean = 0.0;
    double variance = 0.0;
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
      mean += film.mean(pixel).x / film.pixel_count();
      variance += film.variance_of_mean(pixel).x / (double(film.pixel_count()) * film.pixel_count());
    }
    EXPECT_LT(mean, 1.0 + 5 * std::sqrt(variance));
    EXPECT_GT(mean, 0.5);
  }
}

TEST(NormalMaps, ScenesWithoutThemDoNotPay) {
  MappedSquare square;
  EXPECT_TRUE(testbench::features_of(square.scene, {}).shading_normals());
  square.scene.materials[0].textures = {};
  EXPECT_FALSE(testbench::features_of(square.scene, {}).shading_normals());
}

}  // namespace normal_maps_render_test
