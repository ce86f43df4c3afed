#include "testbench/scene_file/generated_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "testbench/bvh/bvh.hpp"
#include "testbench/scene/mesh.hpp"
#include "testbench/scene_file/save_scene.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace generated_scene_test {

using testbench::generate_scene;
using testbench::GeneratedScene;
using testbench::Scene;
using testbench::Triangle;

class GeneratedScenes : public testing::TestWithParam<GeneratedScene> {};

/// A ball has 12 k^2 triangles.
TEST_P(GeneratedScenes, HaveAboutAsManyTrianglesAsAskedFor) {
  for (const int asked : {1000, 10000, 100000}) {
    const double found = double(generate_scene(GetParam(), asked).triangles.size());
    EXPECT_NEAR(found / asked, 1.0, 0.3) << asked;
  }
}

TEST_P(GeneratedScenes, HoldNoTriangleWithoutArea) {
  for (const Triangle& triangle : generate_scene(GetParam(), 20000).triangles)
    ASSERT_FALSE(testbench::is_degenerate(triangle));
}

TEST_P(GeneratedScenes, ComeBackFromTheirFilesToTheLastBit) {
  const test_support::TemporaryDirectory directory;
  const Scene scene = generate_scene(GetParam(), 1000);
  save_scene(scene, directory.path());
  const Scene loaded = testbench::load_scene(directory.path());
  ASSERT_EQ(loaded.triangles.size(), scene.triangles.size());
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (int vertex = 0; vertex < 3; ++vertex)
      ASSERT_EQ(loaded.triangles[i].vertex[vertex], scene.triangles[i].vertex[vertex]) << i;
    const auto& material = scene.materials[std::size_t(scene.triangles[i].material)];
    const auto& loaded_material = loaded.materials[std::size_t(loaded.triangles[i].material)];
    EXPECT_EQ(loaded_material.reflectance, material.reflectance);
    EXPECT_EQ(loaded_material.emission, material.emission);
  }
  EXPECT_EQ(loaded.camera.position, scene.camera.position);
  EXPECT_NEAR(loaded.camera.vertical_field_of_view_radians, scene.camera.vertical_field_of_view_radians,
              1e-15);
}

INSTANTIATE_TEST_SUITE_P(Kinds, GeneratedScenes, testing::ValuesIn(testbench::kGeneratedScenes),
                         [](const auto& suite) { return name_of(suite.param); });

/// Fronts face outwards, so six times the signed volumes of tetrahedra from any point add up to that of a
/// ball.
double volume(const Scene& scene) {
  double sum = 0.0;
  for (const Triangle& t : scene.triangles)
    if (scene.materials[std::size_t(t.material)].name == "object")
      sum += glm::dot(t.vertex[0], glm::cross(t.vertex[1], t.vertex[2]));
  return sum / 6.0;
}

TEST(GeneratedScene, BallsAreClosedAndTheirFrontsLookOutwards) {
  // One ball of radius 0.2 * 556, with too few triangles for nine more balls.
  const double radius = 0.2 * 556.0;
  const double ball = 4.0 / 3.0 * std::acos(-1.0) * radius * radius * radius;
  EXPECT_NEAR(volume(generate_scene(GeneratedScene::sphere_flake, 1900)) / ball, 1.0, 0.01);
}

TEST(GeneratedScene, TheStadiumIsAHundredThousandTimesLargerThanItsBlob) {
  const Scene scene = generate_scene(GeneratedScene::stadium, 10000);
  testbench::Box all;
  testbench::Box object;
  for (const Triangle& t : scene.triangles) {
    all.include(bounds_of(t));
    if (scene.materials[std::size_t(t.material)].name == "object") object.include(bounds_of(t));
  }
  EXPECT_NEAR((all.upper.x - all.lower.x) / (object.upper.x - object.lower.x), 1e5, 0.3e5);
}

TEST(GeneratedScene, AnOrthographicCameraComesBackFromItsFile) {
  const test_support::TemporaryDirectory directory;
  Scene scene = generate_scene(GeneratedScene::blob, 200);
  scene.camera.orthographic_height = 612.3;
  save_scene(scene, directory.path());
  EXPECT_EQ(testbench::load_scene(directory.path()).camera.orthographic_height, 612.3);
}

TEST(GeneratedScene, NumbersOutOfRangeAreNamed) {
  EXPECT_THROW(generate_scene(GeneratedScene::blob, 99), testbench::InputError);
  EXPECT_THROW(generate_scene(GeneratedScene::blob, 10000001), testbench::InputError);
}

}  // namespace generated_scene_test
