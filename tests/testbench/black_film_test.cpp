// What is said of a film that is all black.

#include "testbench/film/black_film.hpp"

#include <gtest/gtest.h>

namespace black_film_test {

using testbench::Scene;
using testbench::Triangle;

constexpr std::int32_t kGrey = 0;
constexpr std::int32_t kLight = 1;

/// A triangle that fills the view of a camera at the origin, `z` before it; its front faces the camera.
Triangle wall(double z, std::int32_t material) {
  return {{{-100, -100, z}, {0, 200, z}, {100, -100, z}}, material};
}

Triangle turned(Triangle triangle) {
  std::swap(triangle.vertex[1], triangle.vertex[2]);
  return triangle;
}

/// The camera looks along +z.
Scene scene_of(std::vector<Triangle> triangles) {
  Scene scene;
  scene.camera.vertical_field_of_view_radians = 0.5;
  scene.film = {8, 8};
  scene.materials = {{"grey", glm::dvec3(0.5), glm::dvec3(0.0)}, {"light", glm::dvec3(0.5), glm::dvec3(1.0)}};
  scene.triangles = std::move(triangles);
  return scene;
}

void expect_reason(const Scene& scene, const std::string& part) {
  const std::string reason = testbench::why_black(scene, true);
  EXPECT_NE(reason.find(part), std::string::npos) << reason;
}

/// Without shadow rays, nothing finds a point; a surface that emits is found by hits.
TEST(BlackFilm, OfPathsThatFindNoLightWithoutAreaSaysSo) {
  Scene scene = scene_of({wall(5, kGrey)});
  scene.lights.emplace_back();
  const std::string part = "program segments casts no shadow rays";
  EXPECT_NE(testbench::why_black(scene, false).find(part), std::string::npos);
  EXPECT_EQ(testbench::why_black(scene, true).find(part), std::string::npos);
  scene.triangles.push_back(wall(9, kLight));
  EXPECT_EQ(testbench::why_black(scene, false).find(part), std::string::npos);
}

TEST(BlackFilm, SaysWhatTheCameraSees) {
  expect_reason(scene_of({wall(-5, kGrey), wall(-6, kLight)}), "no surface");
  expect_reason(scene_of({wall(5, kGrey), turned(wall(9, kLight))}), "every light faces away");
  // Light from behind the camera falls on the back sides that it sees.
  expect_reason(scene_of({turned(wall(5, kGrey)), turned(wall(-5, kLight))}), "inside an object");
  expect_reason(scene_of({wall(5, kGrey), turned(wall(-5, kLight))}), "no path has met a light");
  Scene dark = scene_of({wall(5, kGrey), turned(wall(-5, kLight))});
  dark.materials[kGrey].reflectance = glm::dvec3(0.0);
  expect_reason(dark, "reflect no light");
}

TEST(BlackFilm, IsBlackUntilAPixelIsNot) {
  testbench::Film film({3, 2}, 1.0);
  EXPECT_TRUE(testbench::is_black(film));
  film.add(2, glm::dvec3(0.0));
  EXPECT_TRUE(testbench::is_black(film));
  film.add(5, {0.0, 0.0, 1e-9});
  EXPECT_FALSE(testbench::is_black(film));
}

TEST(BlackFilm, MayBeDimmerThanAnImageFileCanSay) {
  testbench::Film film({3, 2}, 0x1p-130);
  EXPECT_FALSE(testbench::is_below_single_precision(film)) << "black";
  film.add(2, {0.0, 1e-39, 0.0});
  EXPECT_TRUE(testbench::is_below_single_precision(film));
  film.add(3, {0.0, 0.0, 2e-38});
  EXPECT_FALSE(testbench::is_below_single_precision(film));
}

}  // namespace black_film_test
