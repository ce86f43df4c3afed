// Compressed data is made with the libraries that the loader uses; without them files are refused by name.

#include "testbench/gltf/gltf_compression.hpp"

#include <gtest/gtest.h>

#ifdef CSX600_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif
#ifdef CSX600_HAS_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif

#include "testbench/scene/gltf_mesh.hpp"
#include "tests/support/gltf_builder.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace gltf_compression_test {

using nlohmann::json;
using test_support::GltfBuilder;
using test_support::kGltfCorners;

class GltfCompression : public test_support::DirectoryFixture {
 protected:
  testbench::Mesh load(const GltfBuilder& file) {
    write("a.bin", file.bytes);
    return testbench::load_gltf(write("a.gltf", file.root.dump()),
                                {testbench::FileReach(directory_), std::nullopt})
        .mesh;
  }
  std::string error_of(const GltfBuilder& file) {
    return test_support::input_error_of([&] { load(file); });
  }
  /// Any damage to the compressed bytes gives a mesh or one line.
  void expect_survival(const GltfBuilder& file) {
    for (std::size_t i = 0; i < file.bytes.size(); ++i) {
      for (const int bits : {0xff, 0x01, 0x80}) {
        GltfBuilder damaged = file;
        damaged.bytes[i] = static_cast<char>(damaged.bytes[i] ^ bits);
        EXPECT_EQ(error_of(damaged).find('\n'), std::string::npos);
      }
    }
  }
};

void expect_the_triangle(const testbench::Mesh& mesh) {
  ASSERT_EQ(mesh.triangles.size(), 1u);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_EQ(mesh.triangles[0].vertex[i / 3][int(i % 3)], double(kGltfCorners[i]));
}

#ifdef CSX600_HAS_MESHOPTIMIZER

/// A buffer view that the extension packs. Beside it stands the size of what is in it.
std::size_t add_packed(GltfBuilder& file, const std::vector<unsigned char>& packed, std::size_t count,
                       std::size_t stride, const char* mode) {
  const std::size_t place = file.bytes.size() + (4 - file.bytes.size() % 4) % 4;
  file.add_bytes({reinterpret_cast<const char*>(packed.data()), packed.size()});
  file.root["bufferViews"].erase(file.root["bufferViews"].size() - 1);
  return file.add("bufferViews", {{"buffer", 0},
                                  {"byteLength", count * stride},
                                  {"extensions",
                                   {{"EXT_meshopt_compression",
                                     {{"buffer", 0},
                                      {"byteOffset", place},
                                      {"byteLength", packed.size()},
                                      {"byteStride", stride},
                                      {"count", count},
                                      {"mode", mode}}}}}});
}

GltfBuilder meshopt_file() {
  GltfBuilder file;
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(3, 12));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), kGltfCorners.data(), 3, 12));
  const unsigned int corners[] = {0, 1, 2};
  std::vector<unsigned char> indices(meshopt_encodeIndexBufferBound(3, 3));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), corners, 3));
  const std::size_t of_vertices = add_packed(file, vertices, 3, 12, "ATTRIBUTES");
  const std::size_t of_indices = add_packed(file, indices, 3, 2, "TRIANGLES");
  file.add("accessors",
           {{"bufferView", of_vertices}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  file.add("accessors",
           {{"bufferView", of_indices}, {"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}});
  file.add_mesh({{"POSITION", 0}}, {{"indices", 1}});
  file.add_node({{"mesh", 0}});
  file.root["extensionsRequired"] = {"EXT_meshopt_compression"};
  return file;
}

TEST_F(GltfCompression, MeshoptDataIsDecompressed) {
  expect_the_triangle(load(meshopt_file()));
}

TEST_F(GltfCompression, MeshoptDataIsCheckedFirst) {
  for (const auto& [property, value] : std::vector<std::pair<const char*, json>>{{"byteStride", 6},
                                                                                 {"byteStride", 257},
                                                                                 {"count", 1u << 30},
                                                                                 {"count", 0},
                                                                                 {"mode", "POINTS"},
                                                                                 {"filter", "OCTAHEDRAL"},
                                                                                 {"byteLength", 100000},
                                                                                 {"byteLength", 5},
                                                                                 {"buffer", 1},
                                                                                 {"count", 2}}) {
    SCOPED_TRACE(property + value.dump());
    GltfBuilder file = meshopt_file();
    file.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][property] = value;
    EXPECT_NE(error_of(file).find("/bufferViews/0"), std::string::npos) << error_of(file);
  }
}

TEST_F(GltfCompression, DamagedMeshoptDataIsSurvived) {
  expect_survival(meshopt_file());
}

#endif

#ifdef CSX600_HAS_DRACO

GltfBuilder draco_file() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  builder.SetAttributeValuesForFace(position, draco::FaceIndex(0), kGltfCorners.data(),
                                    kGltfCorners.data() + 3, kGltfCorners.data() + 6);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer packed;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &packed).ok());
  GltfBuilder file;
  const std::size_t view = file.add_bytes({packed.data(), packed.size()});
  file.add("accessors", {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  file.add("accessors", {{"componentType", 5125}, {"count", 3}, {"type", "SCALAR"}});
  const std::uint32_t id = mesh->attribute(position)->unique_id();
  file.add_mesh(
      {{"POSITION", 0}},
      {{"indices", 1},
       {"extensions",
        {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", {{"POSITION", id}}}}}}}});
  file.add_node({{"mesh", 0}});
  file.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return file;
}

TEST_F(GltfCompression, DracoDataIsDecompressed) {
  expect_the_triangle(load(draco_file()));
}

TEST_F(GltfCompression, UnknownDracoAttributesAreRefused) {
  GltfBuilder file = draco_file();
  file.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]
           ["POSITION"] = 77;
  EXPECT_NE(error_of(file).find("attributes/POSITION: found 77"), std::string::npos) << error_of(file);
}

TEST_F(GltfCompression, DamagedDracoDataIsSurvived) {
  expect_survival(draco_file());
}

#endif

TEST_F(GltfCompression, OnlyWhatIsSupportedMayBeRequired) {
  const std::vector<std::string> supported = testbench::supported_gltf_extensions();
  for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"}) {
    GltfBuilder file;
    file.root["extensionsRequired"] = {name};
    const bool is_supported = std::find(supported.begin(), supported.end(), name) != supported.end();
    EXPECT_EQ(error_of(file).find("does not support") == std::string::npos, is_supported) << error_of(file);
  }
}

}  // namespace gltf_compression_test
