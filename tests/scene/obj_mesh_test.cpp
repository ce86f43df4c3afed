#include <gtest/gtest.h>

#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "testbench/scene/obj_mesh.hpp"
#include "testbench/system/error.hpp"
#include "tests/scene/mesh_area.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace obj_mesh_test {

using test_support::total_area;
using testbench::load_obj_mesh;
using testbench::Mesh;

constexpr const char* kMaterials = "newmtl grey\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0.25 0.5 1\nKe 4 5 6\n";
constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class ObjMeshTest : public test_support::DirectoryFixture {
 protected:
  ObjMeshTest() { write("m.mtl", kMaterials); }

  Mesh load(const std::string& obj) { return load_obj_mesh(write("mesh.obj", "mtllib m.mtl\n" + obj)); }

  void expect_error(const std::string& obj, const std::vector<std::string>& parts) {
    expect_error_of([&] { load(obj); }, parts);
  }
  void expect_material_error(const std::string& mtl, const std::vector<std::string>& parts) {
    write("m.mtl", mtl);
    expect_error(std::string(kSquare) + "usemtl grey\nf 1 2 3\n", parts);
  }
  /// The mesh has one note; it begins and ends with the words.
  void expect_note(const Mesh& mesh, const std::string& words) {
    ASSERT_EQ(mesh.notes.lines().size(), 1U);
    EXPECT_EQ(mesh.notes.lines()[0], directory_.string() + "/" + words);
  }
  template <class Call>
  void expect_error_of(Call call, std::vector<std::string> parts) {
    parts.emplace_back("allowed: ");
    test_support::expect_input_error(call, parts);
  }
};

TEST_F(ObjMeshTest, reads_numbers_to_the_last_bit) {
  write("m.mtl",
        "newmtl grey\nKd 0.1000000000000000055 0.73775306844182487 +1e-3\nKe 17.198711539995688 0 1E2\n");
  const Mesh mesh = load(
      "v 549.6000000001 0.1 -0.30000000000000004\nv 123456789.12345678 1e-300 .5\nv 4.35 "
      "2.2250738585072014e-308 "
      "1.7976931348623157e8\nusemtl grey\nf 1 2 3\n");
  ASSERT_EQ(mesh.triangles.size(), 1U);
  const auto& v = mesh.triangles[0].vertex;
  EXPECT_EQ(v[0], glm::dvec3(549.6000000001, 0.1, -0.30000000000000004));
  EXPECT_EQ(v[1], glm::dvec3(123456789.12345678, 1e-300, 0.5));
  EXPECT_EQ(v[2], glm::dvec3(4.35, 2.2250738585072014e-308, 1.7976931348623157e8));
  EXPECT_EQ(mesh.materials[0].reflectance, glm::dvec3(0.1, 0.73775306844182487, 1e-3));
  EXPECT_EQ(mesh.materials[0].emission, glm::dvec3(17.198711539995688, 0.0, 100.0));
}

TEST_F(ObjMeshTest, keeps_the_materials_in_use_only) {
  write("m.mtl", std::string("newmtl unused\nKd 1 1 1\n") + kMaterials);
  const Mesh mesh = load(std::string(kSquare) + "usemtl lamp\nf 1 2 3\nusemtl grey\nf 1 3 4\n");
  ASSERT_EQ(mesh.materials.size(), 2U);
  EXPECT_EQ(mesh.materials[0].name, "grey");
  EXPECT_EQ(mesh.materials[1].name, "lamp");
  EXPECT_EQ(mesh.materials[1].reflectance, glm::dvec3(0.25, 0.5, 1.0));
  EXPECT_EQ(mesh.materials[1].emission, glm::dvec3(4.0, 5.0, 6.0));
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.triangles[0].material, 1);
  EXPECT_EQ(mesh.triangles[1].material, 0);
}

TEST_F(ObjMeshTest, reads_crlf_comments_groups_and_relative_indices) {
  const Mesh mesh = load(
      "# a comment\r\no thing\r\nv 0 0 0\r\n  v 1 0 0\r\nv\t0 1 0 1.0\r\nusemtl grey\r\ng part\r\nf -3/1/1 "
      "-2// -1\r\nvt 0 "
      "0\r\nvn 0 0 1\r\n");
  ASSERT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.triangles[0].vertex[1], glm::dvec3(1, 0, 0));
  EXPECT_EQ(mesh.triangles[0].vertex[2], glm::dvec3(0, 1, 0));
}

TEST_F(ObjMeshTest, drops_and_counts_triangles_without_area) {
  const Mesh mesh = load(
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 0.1 0.1 0.1\nv 0.2 0.2 0.2\nv 0.3 0.3 0.3\nusemtl grey\nf 1 2 "
      "3\nf 1 1 4\nf "
      "5 6 7\nf 1 2 4\n");
  EXPECT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.degenerate_triangles, 3U);
}

TEST_F(ObjMeshTest, keeps_small_and_thin_triangles) {
  const Mesh mesh =
      load("v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nv 1 0 0\nv 0 1e-9 0\nusemtl grey\nf 1 2 3\nf 1 4 5\n");
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.degenerate_triangles, 0U);
}

TEST_F(ObjMeshTest, refuses_bad_vertices) {
  const std::string rest = "v 1 0 0\nv 0 1 0\nusemtl grey\nf 1 2 3\n";
  for (const std::string bad : {"nan 0 0", "0 inf 0", "0 0 -inf", "0 0", "a b c", "1e400 0 0", "1e101 0 0",
                                "1,5 0 0", "0x10 0 0", ""}) {
    SCOPED_TRACE(bad);
    expect_error("v " + bad + "\n" + rest, {"mesh.obj:2", "vertex 1", "found '" + bad + "'"});
  }
}

TEST_F(ObjMeshTest, refuses_bad_indices) {
  const std::string square = std::string(kSquare) + "usemtl grey\n";
  for (const std::string bad : {"5",
                                "2000000000",
                                "0",
                                "-5",
                                "-9",
                                "4294967297",
                                "18446744073709551617",
                                "99999999999999999999999",
                                "3.7",
                                "1x",
                                "x",
                                "0x3",
                                "1e0",
                                "+",
                                "+3",
                                "-",
                                "3/1/1/1",
                                "3/x",
                                "3/1/x",
                                "3/1.5",
                                "3/-",
                                "3//1/",
                                "/3",
                                "3\\1"}) {
    SCOPED_TRACE(bad);
    expect_error(square + "f 1 2 " + bad + "\n",
                 {"mesh.obj:7: face: found '" + bad + "'", "1 to 4, or -1 to -4"});
  }
  expect_error(square + "f 1 2\n", {"mesh.obj:7", "2 corners", "3 corners or more"});
  expect_error("f -1 -2 -3\n" + square, {"mesh.obj:2: face: found '-1'; allowed: vertex 1 to 4, as"});
  EXPECT_EQ(load("f 1 2 3\n" + square).triangles.size(), 1U);
  expect_error("usemtl grey\nf 1 2 3\n", {"mesh.obj:3", "no vertex"});
}

TEST_F(ObjMeshTest, reads_each_form_of_a_corner_without_the_normals_and_coordinates_it_names) {
  for (const char* face :
       {"f 1 2 3", "f 1/ 2/ 3/", "f 1// 2// 3//", "f 1/7 2/8 3/9", "f 1//7 2//8 3//9", "f 1/7/8 2/-3/4 3/0/0",
        "f 1/7/ 2/8/ 3", "f 1 2 3 # 4", "f 1 2 3 #4", "f\t1 2\t3 ", "f -4 -3 -2", "f 1 2 \\\n3",
        "f 1 2\\\n 3", "f 1 2\\\n3", "f \\\n1\\\n \\\r\n2 3"}) {
    SCOPED_TRACE(face);
    for (const char* line_end : {"\n", "\r\n", "\r", ""}) {
      const Mesh mesh = load(std::string(kSquare) + "usemtl grey\n" + face + line_end);
      ASSERT_EQ(mesh.triangles.size(), 1U);
      EXPECT_EQ(mesh.triangles[0].vertex[0], glm::dvec3(0, 0, 0));
      EXPECT_EQ(mesh.triangles[0].vertex[1], glm::dvec3(1, 0, 0));
      EXPECT_EQ(mesh.triangles[0].vertex[2], glm::dvec3(1, 1, 0));
    }
  }
}

TEST_F(ObjMeshTest, continues_lines_but_not_comments) {
  const Mesh mesh = load(
      "# from C:\\models\\\nv 0 0 \\\n0\nv 1 0 0\nv 1 \\\r\n 1 0\nv 0 1 0 # at D:\\\nusemtl \\\n  grey\nf 1 "
      "2 3\\\n 4\nf 1 2 4\n");
  EXPECT_EQ(mesh.triangles.size(), 3U);
  expect_error("v 0 \\\n\\\n0 x\n", {"mesh.obj:2: vertex 1"});  // a continued line is named by its first
}

TEST_F(ObjMeshTest, relative_indices_count_from_the_last_vertex_before_the_face) {
  const Mesh mesh = load("v 9 9 9\nv 0 0 0\nv 2 0 0\nv 0 2 0\nusemtl grey\nf -3 -2 -1\nv 5 5 5\n");
  EXPECT_EQ(mesh.triangles.at(0).vertex[0], glm::dvec3(0));
  EXPECT_EQ(mesh.triangles[0].vertex[2], glm::dvec3(0, 2, 0));
}

TEST_F(ObjMeshTest, skips_byte_order_marks) {
  const std::string mark = "\xef\xbb\xbf";
  write("m.mtl", mark + kMaterials);
  const Mesh mesh = load_obj_mesh(
      write("mesh.obj", mark + "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib m.mtl\nusemtl grey\nf 1 2 3\n"));
  EXPECT_EQ(mesh.triangles.at(0).vertex[2], glm::dvec3(0, 1, 0));
  EXPECT_EQ(mesh.materials.at(0).name, "grey");
  EXPECT_TRUE(mesh.notes.lines().empty());
  for (const char* utf_16 : {"\xff\xfe", "\xfe\xff"})
    expect_error_of([&] { load_obj_mesh(write("wide.obj", utf_16 + std::string("v 0"))); },
                    {"wide.obj:1", "UTF-16"});
}

TEST_F(ObjMeshTest, numbers_behind_a_vertex_are_its_weight_or_its_colour) {
  const std::string rest = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const std::string bad :
       {"0 0 0 nan", "0 0 0 inf", "0 0 0 x", "0 0 0 1 2", "0 0 0 1 1 inf", "0 0 0 1 1 1 1 1"})
    expect_error("v " + bad + "\n" + rest, {"mesh.obj:2: vertex 1: found '" + bad + "'"});
  for (const std::string good : {"0 0 0", "0 0 0 2", "0 0 0 # x", "0 0 0 .1 .2 .3", "0 0 0 .1 .2 .3 1"})
    EXPECT_EQ(load("v " + good + "\n" + rest).triangles.size(), 1U) << good;
}

TEST_F(ObjMeshTest, a_face_without_a_material_has_the_average_colour_of_its_vertices) {
  const std::string vertices = "v 0 0 0 0 0 0.25\nv 1 0 0 0.5 0 0.25\nv 0 1 0 1 0 0.25\n";
  const Mesh mesh = load(vertices + "v 1 1 0\nv 2 2 0 1 1 2\nf 1 2 3\nf 1 2 4\nf 1 3 5\nf 3 1 2\n");
  ASSERT_EQ(mesh.triangles.size(), 4U);
  const auto reflectance = [&](std::size_t i) {
    return mesh.materials.at(std::size_t(mesh.triangles.at(i).material)).reflectance;
  };
  EXPECT_EQ(reflectance(0), glm::dvec3(0.5, 0.0, 0.25));
  EXPECT_EQ(mesh.triangles[3].material, mesh.triangles[0].material);
  EXPECT_EQ(reflectance(1), glm::dvec3(0.8));  // vertex 4 has no colour
  EXPECT_EQ(reflectance(2), glm::dvec3(2.0 / 3, 1.0 / 3, 2.5 / 3));
  const Mesh with_material = load(vertices + "usemtl lamp\nf 1 2 3\n");
  EXPECT_EQ(with_material.materials.at(0).name, "lamp");
  expect_note(with_material, "mesh.obj:6: vertex colours of a face with a material are left out");
  const Mesh too_large = load("v 0 0 0 255 0 0\nv 1 0 0 255 0 0\nv 0 1 0 255 0 0\nf 1 2 3\n");
  EXPECT_EQ(too_large.materials.at(0).reflectance, glm::dvec3(0.8));
  EXPECT_EQ(too_large.notes.lines().at(0),
            directory_.string() + "/mesh.obj:5: vertex colours outside 0 to 1 are left out");
}

TEST_F(ObjMeshTest, points_lines_and_curves_are_counted_in_notes) {
  const Mesh mesh =
      load(std::string(kSquare) + "usemtl grey\np 1 2\nl 1 2\nf 1 2 3\nl 3 4\ns off\ncurv 0 1 1 2\n");
  const std::string file = directory_.string() + "/mesh.obj:";
  EXPECT_EQ(mesh.notes.lines(), (std::vector<std::string>{
                                    file + "7: a point is left out", file + "8: a line is left out, 2 times",
                                    file + "12: a free-form curve or surface is left out"}));
}

TEST_F(ObjMeshTest, a_line_that_it_does_not_know_is_noted_and_what_changes_no_triangle_is_not) {
  const Mesh mesh =
      load(std::string(kSquare) +
           "usemtl grey\ng a\no b\ns 1\nlod 2\nvp 1 2\n# V\n\nV 1 0 0\ncall part.obj\nF 1 2 3\nf 1 2 3\n");
  EXPECT_EQ(mesh.notes.lines(),
            std::vector<std::string>{directory_.string() +
                                     "/mesh.obj:14: V: an unknown keyword of OBJ is left out, 3 times"});
  EXPECT_EQ(mesh.triangles.size(), 1U);
}

TEST_F(ObjMeshTest, the_older_word_for_a_face_is_read) {
  EXPECT_EQ(load(std::string(kSquare) + "usemtl grey\nfo 1 2 3 4\nf 1 2 3\n").triangles.size(), 3U);
}

TEST_F(ObjMeshTest, a_comment_needs_no_blank_behind_a_number) {
  const Mesh mesh = load("v 0 0 0# a\nv 1 0 0.5#\nv 0 1 0\nf 1 2 3#4 5\n");
  ASSERT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.triangles[0].vertex[1], glm::dvec3(1.0, 0.0, 0.5));
}

TEST_F(ObjMeshTest, faces_without_a_known_material_have_the_default_one_and_are_counted) {
  const std::string note =
      ": a face has the default material of reflectance 0.8 (material of [[mesh]] sets another), 2 times";
  const Mesh none = load(std::string(kSquare) + "f 1 2 3\nf 1 3 4\n");
  EXPECT_EQ(none.materials.at(0).reflectance, glm::dvec3(0.8));
  EXPECT_EQ(none.materials[0].emission, glm::dvec3(0.0));
  expect_note(none, "mesh.obj:6: no material" + note);
  const Mesh unknown =
      load(std::string(kSquare) + "usemtl blue\nf 1 2 3\nusemtl grey\nf 1 2 4\nusemtl\nf 1 3 4\n");
  EXPECT_EQ(unknown.materials.size(), 2U);
  expect_note(unknown, "mesh.obj:7: no material 'blue'" + note);
}

TEST_F(ObjMeshTest, a_material_of_the_options_takes_the_place_of_the_default_one) {
  const testbench::MeshOptions options{testbench::FileReach(directory_),
                                       testbench::Material{"own", glm::dvec3(0.1), glm::dvec3(3)}};
  const Mesh mesh = load_obj_mesh(
      write("mesh.obj", "mtllib m.mtl\n" + std::string(kSquare) + "f 1 2 3\nusemtl grey\nf 1 3 4\n"),
      options);
  ASSERT_EQ(mesh.materials.size(), 2U);
  EXPECT_EQ(mesh.materials[0].name, "grey");
  EXPECT_EQ(mesh.materials[1].emission, glm::dvec3(3));
  EXPECT_EQ(mesh.triangles[0].material, 1);
  EXPECT_TRUE(mesh.notes.lines().empty());
}

TEST_F(ObjMeshTest, names_may_hold_blanks_and_comments_may_follow_them) {
  write("m.mtl",
        "newmtl dark wood\nKd 0.1 0.1 0.1\nnewmtl Material #25\nKd 0.2 0.2 0.2\nnewmtl pine # light\nKd 0.3 "
        "0.3 0.3\n");
  const auto reflectance = [&](const std::string& use) {
    return load(std::string(kSquare) + "usemtl " + use + "\nf 1 2 3\n").materials.at(0).reflectance.x;
  };
  EXPECT_EQ(reflectance("dark wood"), 0.1);
  EXPECT_EQ(reflectance("  dark wood \t# old"), 0.1);
  EXPECT_EQ(reflectance("Material #25"), 0.2);
  EXPECT_EQ(reflectance("pine"), 0.3);
  EXPECT_EQ(reflectance("dark"), 0.8);
}

TEST_F(ObjMeshTest, reads_every_mtl_file_that_is_named) {
  std::filesystem::create_directory(directory_ / "sub dir");
  write("a.mtl", "newmtl a\nKd 0.1 0.1 0.1\n");
  write("two words.mtl", "newmtl b\nKd 0.2 0.2 0.2\n");
  write("sub dir/c.mtl", "newmtl c\nKd 0.3 0.3 0.3\n");
  const std::string faces =
      std::string(kSquare) + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 2 3 4\n";
  const Mesh mesh = load_obj_mesh(write(
      "mesh.obj",
      faces + "mtllib m.mtl a.mtl\nmtllib a.mtl # again\nmtllib two words.mtl\nmtllib .\\sub dir\\c.mtl\n"));
  EXPECT_EQ(mesh.materials.size(), 3U);
  EXPECT_TRUE(mesh.notes.lines().empty());
  const Mesh missing = load_obj_mesh(
      write("mesh.obj", "mtllib gone.mtl a.mtl away.mtl\n" + std::string(kSquare) + "usemtl a\nf 1 2 3\n"));
  expect_note(missing, "mesh.obj:1: gone.mtl: an MTL file is missing, 2 times");
}

TEST_F(ObjMeshTest, reads_no_file_outside_its_folder) {
  std::filesystem::create_directory(directory_ / "in");
  const std::string rest = "\n" + std::string(kSquare) + "f 1 2 3\n";
  std::filesystem::create_symlink(directory_ / "m.mtl", directory_ / "in/link.mtl");
  ASSERT_EQ(mkfifo((directory_ / "in/pipe.mtl").c_str(), 0600), 0);
  for (const std::string& name :
       {std::string("../m.mtl"), std::string("link.mtl"), (directory_ / "m.mtl").string(),
        std::string("..\\m.mtl"), std::string("/dev/zero")})
    expect_error_of([&] { load_obj_mesh(write("in/mesh.obj", "mtllib " + name + rest)); },
                    {"mesh.obj:1: mtllib", "outside", "--allow-outside"});
  expect_error_of([&] { load_obj_mesh(write("in/mesh.obj", "mtllib pipe.mtl" + rest)); },
                  {"mesh.obj:1", "pipe.mtl", "a regular file"});
  const testbench::MeshOptions options{testbench::FileReach(directory_ / "in", true), std::nullopt};
  EXPECT_EQ(load_obj_mesh(write("in/mesh.obj", "mtllib ../m.mtl\nusemtl lamp" + rest), options)
                .materials.at(0)
                .name,
            "lamp");
}

TEST_F(ObjMeshTest, mtl_keywords_count_in_any_case) {
  write("m.mtl", "NEWMTL grey\nkd 0.1 0.2 0.3\nkE 1 2 3\n");
  const Mesh mesh = load(std::string(kSquare) + "usemtl grey\nf 1 2 3\n");
  EXPECT_EQ(mesh.materials.at(0).reflectance, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(mesh.materials[0].emission, glm::dvec3(1, 2, 3));
}

TEST_F(ObjMeshTest, a_material_without_kd_has_the_default_reflectance_unless_it_emits) {
  write("m.mtl", "newmtl grey\nKa 1 1 1\nillum 2\nnewmtl lamp\nKe 1 1 1\n");
  const Mesh mesh = load(std::string(kSquare) + "usemtl grey\nf 1 2 3\nusemtl lamp\nf 1 3 4\n");
  EXPECT_EQ(mesh.materials.at(0).reflectance, glm::dvec3(0.8));
  EXPECT_EQ(mesh.materials.at(1).reflectance, glm::dvec3(0.0));
  expect_note(mesh, "m.mtl:1: a material without Kd has the default reflectance of 0.8");
}

TEST_F(ObjMeshTest, what_materials_in_use_leave_out_is_one_note_a_kind) {
  write("m.mtl",
        "newmtl grey\nKd 0.5 0.5 0.5\nKs 0 0 0\nNs 10\nd 1.0\nTr 0\nTf 1 1 1\n"
        "newmtl glass\nKd 0.5 0.5 0.5\nd 0.5\nTr 0.5\nKs 1 1 1\nmap_Kd a b.png\nbump c.png\nshine 3\nglow\n"
        "newmtl unused\nd 0.1\nmap_Kd gone.png\n");
  const std::string file = directory_.string() + "/m.mtl:";
  EXPECT_TRUE(load(std::string(kSquare) + "usemtl grey\nf 1 2 3\n").notes.lines().empty());
  const Mesh mesh = load(std::string(kSquare) + "usemtl glass\nf 1 2 3\n");
  EXPECT_EQ(mesh.materials.at(0).reflectance, glm::dvec3(0.5));
  EXPECT_EQ(mesh.notes.lines(),
            (std::vector<std::string>{file + "15: shine: an unknown keyword of MTL is left out, 2 times",
                                      file + "13: map_Kd: a b.png: a texture is missing, 2 times"}));
}

TEST_F(ObjMeshTest, refuses_bad_colours) {
  expect_material_error("newmtl grey\nKd 0.5 1.5 0.5\n",
                        {"m.mtl:2", "'grey'", "Kd", "0.5 1.5 0.5", "0 to 1"});
  expect_material_error("newmtl grey\nKd -0.1 0 0\n", {"'grey'", "-0.1"});
  expect_material_error("newmtl grey\nKd nan 0 0\n", {"'grey'", "nan"});
  expect_material_error("newmtl grey\nKd 0.5\n", {"'grey'", "'0.5'", "3 numbers"});
  expect_material_error("newmtl grey\nKd spectral file.rfl\n", {"'grey'", "spectral"});
  expect_material_error("newmtl grey\nKe 0 -1 0\n", {"'grey'", "Ke", "-1"});
  expect_material_error("newmtl grey\nKe inf 0 0\n", {"'grey'", "Ke", "inf"});
  expect_material_error("newmtl grey\nKe 0 0 1e31\n", {"'grey'", "Ke", "1e30"});
  expect_material_error("newmtl grey\nnewmtl grey\n", {"m.mtl:2", "grey", "once"});
  expect_material_error("Kd 1 1 1\nnewmtl grey\n", {"m.mtl:1", "newmtl"});
}

TEST_F(ObjMeshTest, refuses_unreadable_or_empty_files) {
  expect_error_of([&] { load_obj_mesh(directory_ / "none.obj"); }, {"none.obj", "cannot be read"});
  expect_error_of([&] { load_obj_mesh(directory_); }, {"cannot be read"});
  expect_error_of([&] { load_obj_mesh(write("empty.obj", "")); }, {"empty.obj", "no triangle"});
  expect_error_of([&] { load_obj_mesh(write("text.obj", "not a mesh at all\n")); },
                  {"text.obj", "no triangle"});
  expect_error("v 0 0 0\nv 1 0 0\nv 2 0 0\nusemtl grey\nf 1 2 3\n", {"no triangle", "1 without area"});
}

/// A grid of n x n quads over the unit square.
std::string grid(int n) {
  std::string obj;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      obj += "v " + std::to_string(static_cast<double>(x) / n) + " " +
             std::to_string(static_cast<double>(y) / n) + " 0\n";
    }
  }
  obj += "usemtl grey\n";
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const int corner = y * (n + 1) + x + 1;
      for (const int index : {0, 1, n + 2, n + 1})
        obj += (index == 0 ? "f " : " ") + std::to_string(corner + index);
      obj += "\n";
    }
  }
  return obj;
}

TEST_F(ObjMeshTest, loads_a_thousand_triangles) {
  const Mesh mesh = load(grid(25));
  EXPECT_EQ(mesh.triangles.size(), 1250U);
  EXPECT_NEAR(total_area(mesh), 1.0, 1e-12);
}

TEST_F(ObjMeshTest, loads_a_million_triangles_quickly) {
  const std::string obj = grid(708);
  const auto begin = std::chrono::steady_clock::now();
  const Mesh mesh = load(obj);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(mesh.triangles.size() + mesh.degenerate_triangles, 2U * 708U * 708U);
  EXPECT_EQ(mesh.degenerate_triangles, 0U);
  EXPECT_NEAR(total_area(mesh), 1.0, 1e-9);
  RecordProperty("load_seconds", std::to_string(seconds.count()));
  EXPECT_LT(seconds.count(),
            60.0);  // takes about 1 s; quadratic behaviour would take hours
}

}  // namespace obj_mesh_test
