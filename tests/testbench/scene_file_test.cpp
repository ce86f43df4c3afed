#include <gtest/gtest.h>

#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <string>
#include <vector>

#include "testbench/scene/scene_file.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace scene_file_test {

using testbench::load_scene;
using testbench::Scene;

constexpr const char* kCamera =
    "[camera]\nposition = [0, 0, -5]\ndirection = [0, 0, 2]\nvertical_fov_degrees = 40\n";
constexpr const char* kMesh = "[[mesh]]\nfile = \"a.obj\"\n";

class SceneFileTest : public test_support::DirectoryFixture {
 protected:
  SceneFileTest() {
    write("a.mtl", "newmtl lamp\nKd 0.5 0.5 0.5\nKe 1 1 1\n");
    write("a.obj", "mtllib a.mtl\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl lamp\nf 1 2 3\n");
  }

  Scene load(const std::string& toml) { return load_scene(write("scene.toml", toml)); }

  void expect_error(const std::string& toml, const std::vector<std::string>& parts) {
    write("scene.toml", toml);
    expect_error_of(directory_, parts);
  }
  static void expect_error_of(const std::filesystem::path& path, std::vector<std::string> parts) {
    parts.emplace_back("allowed: ");
    test_support::expect_input_error([&] { load_scene(path); }, parts);
  }
};

void expect_near(const glm::dvec3& a, const glm::dvec3& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-14);
}

TEST_F(SceneFileTest, loads_a_file_or_its_directory) {
  const Scene scene = load(std::string(kCamera) + "[film]\nwidth = 64\nheight = 32\n" + kMesh);
  EXPECT_EQ(scene.name, directory_.filename().string());
  EXPECT_EQ(scene.film.width, 64);
  EXPECT_EQ(scene.film.height, 32);
  EXPECT_EQ(scene.camera.position, glm::dvec3(0, 0, -5));
  EXPECT_EQ(scene.camera.direction, glm::dvec3(0, 0, 1));
  EXPECT_EQ(scene.camera.up, glm::dvec3(0, 1, 0));
  EXPECT_DOUBLE_EQ(scene.camera.vertical_field_of_view_radians, 40.0 * glm::pi<double>() / 180.0);
  ASSERT_EQ(scene.triangles.size(), 1U);
  EXPECT_EQ(scene.triangles[0].vertex[2], glm::dvec3(0, 0, 1));
  EXPECT_EQ(load_scene(directory_).triangles.size(), 1U);
  std::filesystem::rename(directory_ / "scene.toml", directory_ / "other.toml");
  EXPECT_EQ(load_scene(directory_ / "other.toml").name, "other");
}

TEST_F(SceneFileTest, film_defaults_to_480_by_480) {
  EXPECT_EQ(load(std::string(kCamera) + kMesh).film.width, 480);
  const Scene scene = load(std::string(kCamera) + "[film]\nheight = 16384\n" + kMesh);
  EXPECT_EQ(scene.film.width, 480);
  EXPECT_EQ(scene.film.height, 16384);
}

TEST_F(SceneFileTest, camera_is_orthonormal_from_either_form) {
  const Scene looking =
      load(std::string("[camera]\nposition = [1, 2, 3]\nlook_at = [4, 6, 3]\nup = [0, 0.5, 9]\n") +
           "focal_length = 2\nfilm_height = 4\n" + kMesh);
  expect_near(looking.camera.direction, {0.6, 0.8, 0.0});
  expect_near(looking.camera.up, glm::normalize(glm::dvec3(0, 0.5, 9) - 0.4 * glm::dvec3(0.6, 0.8, 0)));
  EXPECT_NEAR(glm::dot(looking.camera.up, looking.camera.direction), 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(looking.camera.vertical_field_of_view_radians, glm::half_pi<double>());
  const Scene huge = load(std::string("[camera]\nposition = [0, 0, 0]\ndirection = [3e99, 4e99, 0]\nup = [0, "
                                      "0, 1e-99]\nvertical_fov_degrees = "
                                      "1\n") +
                          kMesh);
  expect_near(huge.camera.direction, {0.6, 0.8, 0.0});
  expect_near(huge.camera.up, {0, 0, 1});
}

// (1, 0, 0) is scaled by 2, rotated about x, then about y (90 degrees: +x to -z), then about z (90 degrees:
// +x to +y), then translated.
TEST_F(SceneFileTest, transforms_scale_then_rotate_then_translate) {
  const Scene scene = load(std::string(kCamera) + kMesh + kMesh +
                           "scale = 2\nrotate_degrees = [90, 90, 90]\ntranslate = [10, 20, 30]\n");
  ASSERT_EQ(scene.triangles.size(), 2U);
  EXPECT_EQ(scene.materials.size(), 2U);
  EXPECT_EQ(scene.triangles[0].vertex[0], glm::dvec3(1, 0, 0));
  EXPECT_EQ(scene.triangles[1].material, 1);
  expect_near(scene.triangles[1].vertex[0], {10, 20, 28});  // x -> x -> -z -> -z
  expect_near(scene.triangles[1].vertex[1], {10, 22, 30});  // y -> z -> x -> y
  expect_near(scene.triangles[1].vertex[2], {12, 20, 30});  // z -> -y -> -y -> x
}

TEST_F(SceneFileTest, counts_degenerate_triangles) {
  write("a.obj", "mtllib a.mtl\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl lamp\nf 1 2 3\nf 1 1 2\n");
  EXPECT_EQ(load(std::string(kCamera) + kMesh).degenerate_triangles, 1U);
}

TEST_F(SceneFileTest, refuses_unknown_keys) {
  const std::string good = std::string(kCamera) + kMesh;
  expect_error("colour = 1\n" + good, {"scene.toml:1", "colour", "camera, film, mesh"});
  expect_error(std::string(kCamera) + "zoom = 2\n" + kMesh,
               {"scene.toml:5", "camera.zoom", "look_at", "film_height"});
  expect_error(good + "rotate = 2\n",
               {"scene.toml:7", "mesh.rotate", "file, scale, rotate_degrees, translate"});
  expect_error(good + "[film]\nwidht = 2\n", {"scene.toml:8", "film.widht", "width, height"});
}

TEST_F(SceneFileTest, refuses_missing_parts) {
  expect_error(kMesh, {"scene.toml", "camera"});
  expect_error("camera = 3\n" + std::string(kMesh), {"camera"});
  expect_error(kCamera, {"scene.toml", "mesh", "found none"});
  expect_error(std::string("mesh = 3\n") + kCamera, {"mesh"});
  expect_error(std::string("mesh = []\n") + kCamera, {"mesh"});
  expect_error(std::string(kCamera) + "[mesh]\nfile = \"a.obj\"\n", {"mesh", "[[mesh]]"});
  expect_error(std::string(kCamera) + "[[mesh]]\nscale = 1\n", {"mesh.file", "required"});
  expect_error(std::string(kCamera) + "[[mesh]]\nfile = 3\n", {"mesh.file", "found 3"});
  expect_error(std::string(kCamera) + "[[mesh]]\nfile = \"none.obj\"\n", {"none.obj"});
  expect_error(std::string("[camera]\ndirection = [0, 0, 1]\nvertical_fov_degrees = 40\n") + kMesh,
               {"scene.toml:1", "camera.position", "required"});
}

TEST_F(SceneFileTest, refuses_both_or_neither_form) {
  const std::string start = "[camera]\nposition = [0, 0, 0]\n";
  expect_error(start + "vertical_fov_degrees = 40\n" + kMesh, {"look_at", "direction", "neither"});
  expect_error(start + "direction = [0, 0, 1]\nlook_at = [0, 0, 1]\nvertical_fov_degrees = 40\n" + kMesh,
               {"look_at and direction"});
  const std::string aimed = start + "direction = [0, 0, 1]\n";
  expect_error(aimed + kMesh, {"vertical_fov_degrees", "focal_length, film_height"});
  expect_error(aimed + "focal_length = 1\n" + kMesh, {"found focal_length"});
  expect_error(aimed + "focal_length = 1\nfilm_height = 1\nvertical_fov_degrees = 4\n" + kMesh,
               {"found vertical_fov_degrees and focal_length and film_height"});
}

TEST_F(SceneFileTest, refuses_bad_values) {
  const auto camera = [](const std::string& direction, const std::string& rest) {
    return "[camera]\nposition = [0, 0, 0]\ndirection = " + direction + "\n" + rest + "\n" + kMesh;
  };
  const std::string fov = "vertical_fov_degrees = ";
  for (const std::string bad : {"0", "180", "-1", "nan", "inf", "\"40\"", "[40]", "true"}) {
    SCOPED_TRACE(bad);
    expect_error(camera("[0, 0, 1]", fov + bad), {"scene.toml:4", "camera.vertical_fov_degrees", "found "});
  }
  for (const std::string bad :
       {"[0, 0]", "[0, 0, 1, 2]", "3", "[0, \"a\", 1]", "[0, nan, 1]", "[0, inf, 1]", "[1e101, 0, 0]"}) {
    SCOPED_TRACE(bad);
    expect_error(camera(bad, fov + "40"), {"scene.toml:3", "camera.direction", "three finite numbers"});
  }
  expect_error(camera("[0, 0, 0]", fov + "40"), {"scene.toml:3", "camera.direction", "other than zero"});
  expect_error(camera("[0, 3, 0]", fov + "40"), {"camera.up", "parallel"});
  expect_error(camera("[0, 0, 1]", fov + "40\nup = [0, 0, -2]"), {"scene.toml:5", "camera.up", "parallel"});
  expect_error(camera("[0, 0, 1]", fov + "40\nup = [0, 0, 0]"), {"camera.up", "zero"});
  expect_error(camera("[0, 0, 1]", "focal_length = 0\nfilm_height = 1"),
               {"camera.focal_length", "greater than 0"});
  expect_error(
      "[camera]\nposition = [1, 2, 3]\nlook_at = [1, 2, 3]\nvertical_fov_degrees = 40\n" + std::string(kMesh),
      {"scene.toml:3", "camera.look_at", "camera.position"});
}

TEST_F(SceneFileTest, refuses_bad_film_and_mesh_values) {
  for (const std::string bad : {"0", "16385", "-5", "2.0", "\"a\""}) {
    SCOPED_TRACE(bad);
    expect_error(std::string(kCamera) + "[film]\nwidth = " + bad + "\n" + kMesh,
                 {"film.width", "1 to 16384"});
  }
  const std::string mesh = std::string(kCamera) + kMesh;
  expect_error(mesh + "scale = 0\n", {"scene.toml:7", "mesh.scale", "greater than 0"});
  expect_error(mesh + "scale = -2\n", {"mesh.scale", "found -2"});
  expect_error(mesh + "translate = [1, 2]\n", {"mesh.translate", "three finite numbers"});
  expect_error(mesh + "rotate_degrees = 5\n", {"mesh.rotate_degrees"});
  expect_error(mesh + "scale = 1e99\ntranslate = [1e100, 0, 0]\n", {"mesh.scale", "1e100"});
}

TEST_F(SceneFileTest, refuses_a_scene_without_light) {
  write("a.mtl", "newmtl lamp\nKd 0.5 0.5 0.5\n");
  expect_error(std::string(kCamera) + kMesh, {"scene.toml", "no light", "Ke"});
}

TEST_F(SceneFileTest, refuses_broken_or_missing_files) {
  expect_error("[camera\n", {"scene.toml:1", "TOML"});
  expect_error("a = 1\na = 2\n", {"scene.toml:2", "TOML"});
  expect_error("a = \"\xff\xfe\"\n", {"scene.toml", "TOML"});
  expect_error_of(directory_ / "gone", {"gone"});
  expect_error_of(directory_ / "a.obj", {"a.obj", ".toml"});
  std::filesystem::remove(directory_ / "scene.toml");
  expect_error_of(directory_, {"scene.toml"});
}

}  // namespace scene_file_test
