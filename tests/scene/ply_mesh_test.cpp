#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "testbench/scene/ply_mesh.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace ply_mesh_test {

using testbench::load_ply_mesh;
using testbench::Mesh;

/// The bytes of a number in the byte order of the file.
template <class Number>
std::string bytes_of(Number number, bool is_big_endian) {
  std::string bytes(sizeof(number), '\0');
  std::memcpy(bytes.data(), &number, sizeof(number));  // little-endian on every x86
  return is_big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

class PlyMeshTest : public test_support::DirectoryFixture {
 protected:
  Mesh load(const std::string& ply) {
    return load_ply_mesh(write("mesh.ply", ply), {testbench::FileReach(directory_), std::nullopt});
  }
  void expect_error(const std::string& ply, std::vector<std::string> parts) {
    SCOPED_TRACE(ply);
    parts.insert(parts.end(), {"mesh.ply", "allowed: "});
    test_support::expect_input_error([&] { load(ply); }, parts);
  }
};

std::string header(const std::string& format, const std::string& vertices, const std::string& more,
                   const std::string& line_end = "\n") {
  std::string text = "ply\nformat " + format + " 1.0\ncomment made by hand\n" + "element vertex " + vertices +
                     "\n" + more + "end_header\n";
  std::string result;
  for (const char c : text) result += c == '\n' ? line_end : std::string(1, c);
  return result;
}

constexpr const char* kXyz = "property float x\nproperty float y\nproperty float z\n";
constexpr const char* kFaces = "property list uchar int vertex_indices\n";
const std::string kSquare = header("ascii", "4", std::string(kXyz) + "element face 1\n" + kFaces);
constexpr const char* kCorners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

void expect_square(const Mesh& mesh) {
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.triangles[0].vertex[1], glm::dvec3(1, 0, 0));
  EXPECT_EQ(mesh.triangles[1].vertex[0], glm::dvec3(0, 0, 0));
  EXPECT_EQ(mesh.triangles[1].vertex[2], glm::dvec3(0, 1, 0));
}

TEST_F(PlyMeshTest, reads_ascii_with_any_line_ends) {
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    std::string text = kSquare + kCorners + "\n4 0 1 2 3 \n";
    std::string with_ends;
    for (const char c : text) with_ends += c == '\n' ? line_end : std::string(1, c);
    expect_square(load(with_ends));
    expect_square(load("\xef\xbb\xbf" + with_ends));
  }
}

TEST_F(PlyMeshTest, reads_ascii_numbers_to_the_last_bit) {
  const Mesh mesh = load(header("ascii", "3",
                                "property double x\nproperty double y\nproperty double z\nelement face 1\n" +
                                    std::string(kFaces)) +
                         "549.6000000001 .1 -0.30000000000000004\n1e-3 +2 0\n0 0 7\n3 0 1 2\n");
  EXPECT_EQ(mesh.triangles.at(0).vertex[0], glm::dvec3(549.6000000001, 0.1, -0.30000000000000004));
}

template <class Coordinate, class Length, class Index>
std::string binary(bool is_big_endian, const std::string& types, const std::string& line_end) {
  const std::string coordinate = sizeof(Coordinate) == 4 ? "float32" : "double";
  std::string text = header(is_big_endian ? "binary_big_endian" : "binary_little_endian", "4",
                            "property uint16 flags\nproperty " + coordinate + " x\nproperty " + coordinate +
                                " y\nproperty list char double weights\nproperty " + coordinate +
                                " z\nelement camera 1\nproperty int16 id\nelement face 1\nproperty list " +
                                types + " vertex_index\nproperty float quality\n",
                            line_end);
  for (const auto& v : {glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(1, 1, 0), glm::dvec3(0, 1, 0)}) {
    text += bytes_of(std::uint16_t(0x0d0a), is_big_endian);
    text += bytes_of(Coordinate(v.x), is_big_endian) + bytes_of(Coordinate(v.y), is_big_endian);
    text += bytes_of(std::int8_t(2), is_big_endian) + std::string(16, '\xff');
    text += bytes_of(Coordinate(v.z), is_big_endian);
  }
  text += "ab" + bytes_of(Length(4), is_big_endian);
  for (int i = 0; i < 4; ++i) text += bytes_of(Index(i), is_big_endian);
  return text + "abcd";
}

TEST_F(PlyMeshTest, reads_binary_of_both_byte_orders_and_any_types) {
  for (const bool is_big_endian : {false, true}) {
    for (const char* line_end : {"\n", "\r\n"}) {
      expect_square(load(binary<float, std::uint8_t, std::int32_t>(is_big_endian, "uchar int", line_end)));
      expect_square(load(binary<double, std::int32_t, std::uint32_t>(is_big_endian, "int32 uint", line_end)));
      expect_square(load(binary<float, std::uint16_t, std::int8_t>(is_big_endian, "ushort int8", line_end)));
      expect_square(load(binary<double, std::int8_t, std::uint16_t>(is_big_endian, "char uint16", line_end)));
      expect_square(load(binary<double, std::int16_t, std::uint8_t>(is_big_endian, "int16 uint8", line_end)));
      expect_square(
          load(binary<float, std::uint32_t, std::int16_t>(is_big_endian, "uint32 short", line_end)));
    }
  }
}

TEST_F(PlyMeshTest, refuses_binary_that_ends_too_early_at_every_length) {
  const std::string whole = binary<float, std::uint8_t, std::int32_t>(true, "uchar int", "\n");
  for (std::size_t length = 0; length < whole.size(); ++length) expect_error(whole.substr(0, length), {});
}

TEST_F(PlyMeshTest, faces_have_their_own_colour_or_the_average_of_their_vertices) {
  const Mesh of_vertices =
      load(header("ascii", "3",
                  std::string(kXyz) + "property uchar red\nproperty uchar green\nproperty uchar blue\n" +
                      "property uchar alpha\nelement face 1\n" + kFaces) +
           "0 0 0 255 0 51 9\n1 0 0 255 0 51 9\n0 1 0 255 255 51 9\n3 0 1 2\n");
  EXPECT_EQ(of_vertices.materials.at(0).reflectance.r, 1.0);
  EXPECT_DOUBLE_EQ(of_vertices.materials[0].reflectance.g, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(of_vertices.materials[0].reflectance.b, 0.2);
  EXPECT_TRUE(of_vertices.notes.lines().empty());
  const Mesh of_faces = load(header("ascii", "3",
                                    std::string(kXyz) + "element face 2\n" + kFaces +
                                        "property float red\nproperty float green\nproperty float blue\n") +
                             "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 .25 .5 1\n3 2 1 0 0 0 0\n");
  EXPECT_EQ(of_faces.materials.at(std::size_t(of_faces.triangles.at(0).material)).reflectance,
            glm::dvec3(0.25, 0.5, 1.0));
  EXPECT_EQ(of_faces.materials.at(std::size_t(of_faces.triangles.at(1).material)).reflectance,
            glm::dvec3(0.0));
}

TEST_F(PlyMeshTest, without_colours_has_the_default_material_and_says_so) {
  const Mesh mesh = load(kSquare + kCorners + "4 0 1 2 3\n");
  EXPECT_EQ(mesh.materials.at(0).reflectance, glm::dvec3(0.8));
  EXPECT_EQ(
      mesh.notes.lines(),
      std::vector<std::string>{directory_.string() +
                               "/mesh.ply:15: no colour: a face has the default material of reflectance 0.8 "
                               "(material of [[mesh]] sets another)"});
}

TEST_F(PlyMeshTest, refuses_bad_headers) {
  for (const char* text : {"", "plyx\n", "obj\n", "ply\n", "ply\nformat ascii 1.0\n"}) expect_error(text, {});
  expect_error("ply\nformat ascii 2.0\nend_header\n", {":2", "'ascii 2.0'", "version 1.0"});
  expect_error("ply\nelement vertex 0\nend_header\n", {"no format"});
  const std::string start = "ply\nformat ascii 1.0\n";
  for (const char* line : {"element vertex", "element vertex x", "element vertex -1", "element vertex 1.5",
                           "element vertex 99999999999999999999", "property float x", "nonsense 3"})
    expect_error(start + line + "\nend_header\n", {":3"});
  for (const char* line : {"property quad x", "property float", "property list float int i",
                           "property list uchar x", "property list uchar quad i", "element vertex 2"})
    expect_error(start + "element vertex 1\n" + line + "\nend_header\n0\n", {":4"});
  expect_error(header("ascii", "1", "property float x\nproperty float y\n") + "0 0\n", {"x, y and z"});
  expect_error(header("ascii", "3", std::string(kXyz) + "element face 1\nproperty int vertex_indices\n") +
                   "0 0 0\n1 0 0\n0 1 0\n3\n",
               {"vertex_indices", "list of integers"});
  expect_error(
      header("ascii", "3", std::string(kXyz) + "element face 1\nproperty list uchar float vertex_indices\n") +
          "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
      {"list of integers"});
}

TEST_F(PlyMeshTest, holds_counts_against_the_size_of_the_file_before_memory_is_taken) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    expect_error(header(format, "18446744073709551615", kXyz) + "0 0 0\n",
                 {"element vertex", "18446744073709551615"});
    expect_error(header(format, "4000000000", std::string(kXyz)) + "0 0 0\n", {"4000000000"});
  }
  expect_error(header("binary_little_endian", "0",
                      std::string(kXyz) + "element face 1\nproperty list uint int vertex_indices\n") +
                   "\xff\xff\xff\xff" + std::string(100, '\0'),
               {"4294967295", "as many as the file holds"});
}

TEST_F(PlyMeshTest, refuses_bad_bodies) {
  for (const char* line : {"0 0", "0 0 0 0", "0 nan 0", "0 0 inf", "0 x 0", "0 1e101 0"})
    expect_error(kSquare + "0 0 0\n" + line + "\n0 0 0\n0 0 0\n4 0 1 2 3\n", {":12", "vertex"});
  for (const char* line : {"3 0 1", "3 0 1 2 3", "3 0 1 4", "3 0 1 -1", "3 0 1 1.5", "3 0 1 4294967296",
                           "2 0 1", "-1", "256 0 1 2", "3 0 1 2x"})
    expect_error(kSquare + kCorners + line + "\n", {":15", "face"});
  expect_error(kSquare + kCorners, {"the end of the file"});
  expect_error(header("ascii", "1",
                      std::string(kXyz) + "property float red\nproperty float green\nproperty float blue\n") +
                   "0 0 0 0 0 2\n",
               {"colour"});
  expect_error(header("ascii", "1", kXyz) + "0 0 0\n", {"no triangle"});
}

}  // namespace ply_mesh_test
