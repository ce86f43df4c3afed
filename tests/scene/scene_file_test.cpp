#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <string>
#include <vector>

#include "testbench/files/input_file.hpp"
#include "testbench/scene_file/scene_file.hpp"
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

/// Two files that meet in a plane, as they are often exported: a ceiling, and a lamp let into it.
TEST_F(SceneFileTest, puts_a_lamp_before_the_ceiling_in_whose_plane_it_lies) {
  write("ceiling.mtl", "newmtl ceiling\nKd 0.5 0.5 0.5\n");
  write("ceiling.obj", "mtllib ceiling.mtl\nv 3 -1 -1\nv -1 3 -1\nv -1 -1 3\nusemtl ceiling\nf 1 2 3\n");
  const Scene scene = load(std::string(kCamera) + "[[mesh]]\nfile = \"ceiling.obj\"\n" + kMesh);
  ASSERT_EQ(scene.triangles.size(), 2U);
  EXPECT_EQ(scene.coincident_triangles, 2U);
  EXPECT_EQ(scene.triangles[0].vertex[0], glm::dvec3(1, 0, 0));
  EXPECT_EQ(scene.triangles[1].vertex[0], glm::dvec3(3, -1, -1));
  ASSERT_EQ(scene.notes.lines().size(), 1U);
  EXPECT_NE(scene.notes.lines()[0].find("lights first"), std::string::npos);
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
  expect_error(good + "camera = \"front\"\n", {"scene.toml:7", "mesh.camera", "glTF"});
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

// It was refused. A renderer that shows a mesh alone under a light of its own should show the same mesh when
// its camera is set.
TEST_F(SceneFileTest, a_scene_without_light_gets_one) {
  write("a.mtl", "newmtl lamp\nKd 0.5 0.5 0.5\n");
  const Scene scene = load(std::string(kCamera) + kMesh);
  ASSERT_EQ(scene.triangles.size(), 3U);
  EXPECT_GT(scene.materials.at(std::size_t(scene.triangles[2].material)).emission.x, 0.0);
  ASSERT_EQ(scene.notes.lines().size(), 1U);
  EXPECT_NE(scene.notes.lines()[0].find("scene.toml: no triangle emits, so a square light"),
            std::string::npos);
}

TEST_F(SceneFileTest, a_mesh_that_a_transform_flattens_is_refused) {
  expect_error(std::string(kCamera) + kMesh + "scale = 1e-300\ntranslate = [1, 1, 1]\n",
               {"scene.toml", "mesh", "no triangle with an area"});
}

TEST_F(SceneFileTest, a_camera_is_not_too_far_from_a_mesh_or_too_large_for_it) {
  const std::string tiny = kMesh + std::string("scale = 1e-90\n");
  EXPECT_NO_THROW(
      load("[camera]\nposition = [0, 0, -9e9]\ndirection = [0, 0, 1]\nvertical_fov_degrees = 40\n" + tiny));
  for (const std::string camera : {"position = [0, 9e11, 0]\nvertical_fov_degrees = 40\n",
                                   "position = [0, 0, 0]\northographic_height = 9e11\n"})
    expect_error("[camera]\ndirection = [0, 0, 1]\n" + camera + tiny,
                 {"scene.toml", "camera", "too large", "1e100 times"});
}

TEST_F(SceneFileTest, an_orthographic_camera_has_a_height) {
  const std::string aimed = "[camera]\nposition = [1, 2, 3]\ndirection = [0, 0, -2]\n";
  const Scene scene = load(aimed + "orthographic_height = 2.5\n" + kMesh);
  EXPECT_EQ(scene.camera.orthographic_height, 2.5);
  EXPECT_EQ(scene.camera.position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(scene.camera.direction, glm::dvec3(0, 0, -1));
  EXPECT_FALSE(load(aimed + "vertical_fov_degrees = 40\n" + kMesh).camera.orthographic_height);
  for (const std::string bad : {"0", "-1", "nan", "inf", "1e100", "\"2\"", "[2]"})
    expect_error(aimed + "orthographic_height = " + bad + "\n" + kMesh,
                 {"scene.toml:4", "camera.orthographic_height", "found ", "greater than 0"});
  for (const std::string other : {"vertical_fov_degrees = 40", "focal_length = 1", "film_height = 1"})
    expect_error(aimed + "orthographic_height = 2\n" + other + "\n" + kMesh,
                 {"scene.toml:1", "camera", other.substr(0, other.find(' ')), "orthographic_height"});
  expect_error(aimed + kMesh, {"neither form", "or orthographic_height"});
}

TEST_F(SceneFileTest, refuses_broken_or_missing_files) {
  expect_error("[camera\n", {"scene.toml:1", "TOML"});
  expect_error("a = 1\na = 2\n", {"scene.toml:2", "TOML"});
  expect_error("a = \"\xff\xfe\"\n", {"scene.toml", "TOML"});
  expect_error_of(directory_ / "gone", {"gone"});
  expect_error_of(write("a.stl", ""), {"a.stl", ".toml"});
  std::filesystem::remove(directory_ / "scene.toml");
  expect_error_of(directory_, {"scene.toml"});
}

TEST_F(SceneFileTest, a_byte_order_mark_before_the_file_is_skipped) {
  EXPECT_EQ(load("\xef\xbb\xbf" + std::string(kCamera) + kMesh).triangles.size(), 1U);
}

TEST_F(SceneFileTest, a_material_is_for_faces_that_have_none) {
  write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("bare.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
        "z\nelement face "
        "1\nproperty list uchar int vertex_index\nend_header\n0 0 1\n1 0 1\n0 1 1\n3 0 1 2\n");
  const Scene scene =
      load(std::string(kCamera) +
           "[[mesh]]\nfile = \"bare.obj\"\nmaterial = {reflectance = [0.1, 0.2, 1], emission = [5, 0, "
           "1e30]}\n[[mesh]]\nfile = \"bare.ply\"\nmaterial.emission = [1, 1, 1]\n[[mesh]]\nfile = "
           "\"a.obj\"\nmaterial.emission = [9, 9, 9]\n");
  ASSERT_EQ(scene.materials.size(), 3U);
  EXPECT_EQ(scene.materials[0].reflectance, glm::dvec3(0.1, 0.2, 1.0));
  EXPECT_EQ(scene.materials[0].emission, glm::dvec3(5, 0, 1e30));
  EXPECT_EQ(scene.materials[1].reflectance, glm::dvec3(0));
  EXPECT_EQ(scene.materials[2].emission, glm::dvec3(1));
  EXPECT_TRUE(scene.notes.lines().empty());
  const std::string mesh = std::string(kCamera) + "[[mesh]]\nfile = \"bare.obj\"\n";
  expect_error(mesh + "material = 3\n", {"scene.toml:7", "mesh.material", "a table"});
  expect_error(mesh + "material = {colour = 3}\n", {"mesh.material.colour", "reflectance, emission"});
  expect_error(mesh + "material.reflectance = [0, 0, 1.5]\n", {"mesh.material.reflectance", "1.5", "0 to 1"});
  expect_error(mesh + "material.emission = [-1, 0, 0]\n", {"mesh.material.emission", "-1", "1e30"});
}

TEST_F(SceneFileTest, a_scene_of_the_default_material_without_light_gets_one) {
  write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Scene scene = load(std::string(kCamera) + "[[mesh]]\nfile = \"bare.obj\"\n");
  EXPECT_EQ(scene.triangles.size(), 3U);
  ASSERT_EQ(scene.notes.lines().size(), 2U);
  EXPECT_NE(scene.notes.lines()[1].find("square light"), std::string::npos);
}

TEST_F(SceneFileTest, a_mesh_file_alone_is_framed_and_lit) {
  const std::string file = "s 0\nv -30 10 4\nv 10 10 4\nv 10 90 -5\nv -30 90 -5\nf 1 2 3 4\n";
  for (const char* name : {"m.obj", "M.OBJ"}) {
    const Scene scene = load_scene(write(name, file));
    EXPECT_EQ(scene.name.size(), 1U);
    EXPECT_EQ(scene.film.width, 480);
    ASSERT_EQ(scene.triangles.size(), 4U);
    ASSERT_EQ(scene.notes.lines().size(), 3U);
    const testbench::Camera& camera = scene.camera;
    EXPECT_NEAR(glm::length(camera.direction), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(camera.direction, camera.up), 0.0, 1e-12);
    const double half = 0.5 * camera.vertical_field_of_view_radians;
    for (int t = 0; t < 2; ++t) {
      for (const glm::dvec3& v : scene.triangles[std::size_t(t)].vertex)
        EXPECT_GT(glm::dot(glm::normalize(v - camera.position), camera.direction), std::cos(half));
    }
    const glm::dvec3 centre(-10, 50, -0.5);
    for (int t = 2; t < 4; ++t) {
      const auto& light = scene.triangles[std::size_t(t)];
      EXPECT_GT(scene.materials[std::size_t(light.material)].emission.x, 0.0);
      const glm::dvec3 normal =
          glm::cross(light.vertex[1] - light.vertex[0], light.vertex[2] - light.vertex[0]);
      EXPECT_GT(glm::dot(centre - light.vertex[0], normal), 0.0);  // faces the mesh
      EXPECT_LT(glm::dot(light.vertex[0] - camera.position, camera.direction), 0.0) << "seen by the camera";
    }
  }
}

TEST_F(SceneFileTest, a_mesh_file_that_emits_gets_no_light) {
  EXPECT_EQ(load_scene(directory_ / "a.obj").triangles.size(), 1U);
}

TEST_F(SceneFileTest, suffixes_count_in_any_case) {
  std::filesystem::rename(directory_ / "a.obj", directory_ / "A.Obj");
  EXPECT_EQ(load(std::string(kCamera) + "[[mesh]]\nfile = \"A.Obj\"\n").triangles.size(), 1U);
  std::filesystem::rename(directory_ / "scene.toml", directory_ / "OTHER.TOML");
  EXPECT_EQ(load_scene(directory_ / "OTHER.TOML").triangles.size(), 1U);
}

TEST_F(SceneFileTest, reads_no_file_outside_its_folder_unless_allowed) {
  std::filesystem::create_directories(directory_ / "in/below");
  std::filesystem::create_symlink(directory_ / "a.obj", directory_ / "in/link.obj");
  for (const std::string& file :
       {std::string("../a.obj"), std::string("below/../../a.obj"), std::string("link.obj"),
        (directory_ / "a.obj").string(), std::string("/dev/zero")}) {
    const auto toml = write("in/scene.toml", std::string(kCamera) + "[[mesh]]\nfile = \"" + file + "\"\n");
    expect_error_of(toml, {"scene.toml:6: mesh.file", "outside", "--allow-outside"});
    if (file != "/dev/zero") {
      EXPECT_EQ(load_scene(toml, true).triangles.at(0).vertex[0], glm::dvec3(1, 0, 0));
    } else {
      test_support::expect_input_error([&] { load_scene(toml, true); }, {"/dev/zero", "a regular file"});
    }
  }
  std::filesystem::rename(directory_ / "a.obj", directory_ / "in/below/a.obj");
  std::filesystem::rename(directory_ / "a.mtl", directory_ / "in/a.mtl");
  write("in/below/a.obj", "mtllib ../a.mtl\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl lamp\nf 1 2 3\n");
  const auto toml = write("in/scene.toml", std::string(kCamera) + "[[mesh]]\nfile = \"below/a.obj\"\n");
  EXPECT_EQ(load_scene(toml).materials.at(0).name, "lamp");  // ../a.mtl is below the scene's folder
}

// A light that is listed twice would be sampled twice and hit once.
TEST_F(SceneFileTest, a_triangle_that_repeats_another_is_left_out) {
  write("a.mtl", "newmtl lamp\nKe 1 1 1\nnewmtl wall\nKd 0.5 0.5 0.5\n");
  const std::string vertices = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 -0 0\nv 0 0 5\n";
  write("a.obj",
        vertices +
            "usemtl wall\nf 3 1 2\nf 1 2 5\nusemtl lamp\nf 1 2 3\nf 2 3 4\nf 3 2 1\nusemtl wall\nf 2 3 1\n");
  const Scene scene = load(std::string(kCamera) + kMesh + kMesh);
  // Three are left: the lamp and its back, which come first because they coincide, and the wall up to vertex
  // 5.
  ASSERT_EQ(scene.triangles.size(), 3U);
  EXPECT_EQ(scene.materials.at(std::size_t(scene.triangles[0].material)).name, "lamp");
  EXPECT_EQ(scene.triangles[0].vertex[0], glm::dvec3(0, 0, 0));
  EXPECT_EQ(scene.triangles[1].vertex[0], glm::dvec3(0, 1, 0));
  EXPECT_EQ(scene.triangles[2].vertex[2], glm::dvec3(0, 0, 5));
  ASSERT_EQ(scene.notes.lines().size(), 2U);
  EXPECT_EQ(scene.notes.lines()[0], (directory_ / "scene.toml").string() +
                                        ": a triangle that repeats another one is left out, 9 times");
}

TEST(Scenes, TheClosedCornellBoxHoldsCopiesOfTheOpenOne) {
  const std::filesystem::path scenes = CSX600_SCENES_DIR;
  for (const char* file : {"cornell_box.obj", "cornell_box.mtl"})
    EXPECT_EQ(testbench::read_input_file(scenes / "cornell_box" / file, ""),
              testbench::read_input_file(scenes / "cornell_box_closed" / file, ""));
}

}  // namespace scene_file_test
