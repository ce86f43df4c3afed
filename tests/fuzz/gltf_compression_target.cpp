#include <nlohmann/json.hpp>
#include <string>

#include "testbench/scene_file/scene_file.hpp"
#include "tests/fuzz/input_files.hpp"
#include "tests/fuzz/targets.hpp"

namespace fuzz {
namespace {

using Json = nlohmann::json;

// glTF 2.0, section 3.6.2.2.
constexpr int kSigned16 = 5122;
constexpr int kUnsigned16 = 5123;
constexpr int kUnsigned32 = 5125;
constexpr int kFloat = 5126;

constexpr float kCorners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};

/// A scene of one mesh, whose primitive has positions from accessor 0 and indices from accessor 1.
Json one_mesh(std::size_t buffer_bytes) {
  return {{"asset", {{"version", "2.0"}}},
          {"scene", 0},
          {"scenes", {{{"nodes", {0}}}}},
          {"nodes", {{{"mesh", 0}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
          {"buffers", {{{"uri", "buffer.bin"}, {"byteLength", buffer_bytes}}}}};
}

Json accessor(int component, const char* type, std::size_t count) {
  return {{"componentType", component}, {"type", type}, {"count", count}};
}
Json accessor(int component, const char* type, std::size_t count, std::size_t view) {
  Json json = accessor(component, type, count);
  json["bufferView"] = view;
  return json;
}

void load(const Json& json, std::string_view buffer) {
  write_file("mesh.gltf", json.dump());
  write_file("buffer.bin", buffer);
  testbench::load_scene("mesh.gltf");
}

}  // namespace

/// The bytes of an input: mode, filter, stride, count (two bytes), whether the view holds indices or else
/// 32-bit or 16-bit positions, then the packed data.
void read_meshopt(std::string_view input) {
  constexpr std::size_t kHead = 6;
  if (input.size() <= kHead) return;
  const auto byte = [&](std::size_t i) { return std::size_t(static_cast<unsigned char>(input[i])); };
  static const char* const kModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
  static const char* const kFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  enum class Use : std::size_t { indices, positions_32_bit, positions_16_bit, number };
  const Use use = Use(byte(5) % std::size_t(Use::number));
  const std::size_t stride = byte(2);
  const std::size_t count = byte(3) + 256 * byte(4);
  const std::string_view packed = input.substr(kHead);
  Json json = one_mesh(sizeof(kCorners) + packed.size());
  json["extensionsUsed"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
  json["extensionsRequired"] = json["extensionsUsed"];
  json["buffers"].push_back(
      {{"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  json["bufferViews"] = {{{"buffer", 0}, {"byteLength", sizeof(kCorners)}},
                         {{"buffer", 1},
                          {"byteLength", count * stride},
                          {"extensions",
                           {{"EXT_meshopt_compression",
                             {{"buffer", 0},
                              {"byteOffset", sizeof(kCorners)},
                              {"byteLength", packed.size()},
                              {"byteStride", stride},
                              {"count", count},
                              {"mode", kModes[byte(0) % std::size(kModes)]},
                              {"filter", kFilters[byte(1) % std::size(kFilters)]}}}}}}};
  if (use == Use::indices) {
    json["accessors"] = {accessor(kFloat, "VEC3", std::size(kCorners) / 3, 0),
                         accessor(stride == 2 ? kUnsigned16 : kUnsigned32, "SCALAR", count, 1)};
  } else {
    json["accessors"] =
        Json::array({accessor(use == Use::positions_16_bit ? kSigned16 : kFloat, "VEC3", count, 1)});
    json["meshes"][0]["primitives"][0].erase("indices");
  }
  const std::string corners(reinterpret_cast<const char*>(kCorners), sizeof(kCorners));
  load(json, corners + std::string(packed));
}

/// The number of points and indices is 3; Draco's own number counts, and the reader must notice.
void read_draco(std::string_view input) {
  if (input.empty()) return;
  Json json = one_mesh(input.size());
  json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  json["extensionsRequired"] = json["extensionsUsed"];
  json["bufferViews"] = {{{"buffer", 0}, {"byteLength", input.size()}}};
  json["accessors"] = {accessor(kFloat, "VEC3", 3), accessor(kUnsigned32, "SCALAR", 3)};
  json["meshes"][0]["primitives"][0]["extensions"] = {
      {"KHR_draco_mesh_compression", {{"bufferView", 0}, {"attributes", {{"POSITION", 0}}}}}};
  load(json, input);
}

}  // namespace fuzz
