#include "testbench/gltf/gltf_compression.hpp"

#include "testbench/gltf/gltf_schema.hpp"

#ifdef CSX600_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif
#ifdef CSX600_HAS_DRACO
#include <draco/compression/decode.h>
#endif

namespace testbench {

std::vector<std::string> supported_gltf_extensions() {
  return {
#ifdef CSX600_HAS_DRACO
      "KHR_draco_mesh_compression",
#endif
#ifdef CSX600_HAS_MESHOPTIMIZER
      "EXT_meshopt_compression",
#endif
      "EXT_mesh_gpu_instancing",    "KHR_materials_emissive_strength", "KHR_materials_pbrSpecularGlossiness",
      "KHR_mesh_quantization"};
}

#ifdef CSX600_HAS_MESHOPTIMIZER

namespace {

/// The library takes these for granted (specification of EXT_meshopt_compression).
void require_meshopt_sizes(const GltfDocument& document, const GltfBytes& packed,
                           const nlohmann::json& extension, const std::string& pointer) {
  const auto count = extension["count"].get<std::size_t>();
  const auto stride = extension["byteStride"].get<std::size_t>();
  const std::string mode = extension["mode"].get<std::string>();
  const bool holds_vertices = mode == "ATTRIBUTES";
  if (holds_vertices ? stride % 4 != 0 : stride != 2 && stride != 4)
    document.fail(pointer + "/byteStride", std::to_string(stride),
                  holds_vertices ? "a multiple of 4" : "2 or 4");
  if (mode == "TRIANGLES" && count % 3 != 0)
    document.fail(pointer + "/count", std::to_string(count), "a multiple of 3");
  // Vertices take a byte for 64 at least, indices one for 3 of 4 bytes: more than this no data can hold.
  if (count > 64 * (packed.size + 1))
    document.fail(pointer + "/count",
                  std::to_string(count) + " elements in " + std::to_string(packed.size) +
                      " bytes, more than they can hold",
                  "a count that fits");
}

}  // namespace

std::vector<std::uint8_t> decode_meshopt(const GltfDocument& document, const GltfBytes& packed,
                                         const nlohmann::json& extension, const std::string& pointer) {
  require_meshopt_sizes(document, packed, extension, pointer);
  const auto count = extension["count"].get<std::size_t>();
  const auto stride = extension["byteStride"].get<std::size_t>();
  const std::string mode = extension["mode"].get<std::string>();
  const std::string filter = extension.value("filter", "NONE");
  std::vector<std::uint8_t> bytes(count * stride);
  const int error = mode == "ATTRIBUTES"
                        ? meshopt_decodeVertexBuffer(bytes.data(), count, stride, packed.data, packed.size)
                    : mode == "TRIANGLES"
                        ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, packed.data, packed.size)
                        : meshopt_decodeIndexSequence(bytes.data(), count, stride, packed.data, packed.size);
  if (error != 0) document.fail(pointer, "data that cannot be decompressed", "data of its mode and count");
  const bool is_oct = filter == "OCTAHEDRAL";
  if ((is_oct && stride != 4 && stride != 8) || (filter == "QUATERNION" && stride != 8))
    document.fail(pointer + "/byteStride", std::to_string(stride), is_oct ? "4 or 8" : "8");
  if (is_oct) meshopt_decodeFilterOct(bytes.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), count, stride);
  return bytes;
}

#else

std::vector<std::uint8_t> decode_meshopt(const GltfDocument& document, const GltfBytes&,
                                         const nlohmann::json&, const std::string& pointer) {
  document.fail(pointer, "compressed data, which this program was built without", "data that is not");
}

#endif

#ifdef CSX600_HAS_DRACO

bool has_draco() {
  return true;
}

namespace {

GltfNumbers numbers_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute) {
  GltfNumbers numbers;
  numbers.width = std::size_t(attribute.num_components());
  numbers.values.resize(mesh.num_points() * numbers.width);
  std::vector<double> element(numbers.width);
  for (std::uint32_t point = 0; point < mesh.num_points(); ++point) {
    attribute.ConvertValue<double>(attribute.mapped_index(draco::PointIndex(point)),
                                   static_cast<std::int8_t>(numbers.width), element.data());
    std::copy(element.begin(), element.end(), numbers.values.begin() + std::ptrdiff_t(point * numbers.width));
  }
  return numbers;
}

}  // namespace

DracoPrimitive decode_draco(const GltfDocument& document, const GltfBytes& packed,
                            const nlohmann::json& extension, const std::string& pointer) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(packed.data), packed.size);
  std::unique_ptr<draco::Mesh> mesh;
  try {
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (decoded.ok()) mesh = std::move(decoded).value();
  } catch (const std::exception&) {  // asked for more memory than there is
  }
  if (mesh == nullptr) document.fail(pointer, "data that cannot be decompressed", "a Draco mesh");
  DracoPrimitive primitive;
  for (std::int32_t i = 0; i < mesh->num_attributes(); ++i)
    mesh->attribute(i)->set_normalized(false);  // whether integers are, the accessor says
  for (const auto& [name, id] : extension["attributes"].items()) {
    const draco::PointAttribute* const attribute = mesh->GetAttributeByUniqueId(id.get<std::uint32_t>());
    if (attribute == nullptr)
      document.fail(std::string(pointer).append("/attributes/").append(name), json_in_message(id),
                    "the number of an attribute in the data");
    if (attribute->data_type() == draco::DT_BOOL)  // whose bytes may be neither true nor false
      document.fail(std::string(pointer).append("/attributes/").append(name), "an attribute of booleans",
                    "numbers");
    primitive.attributes.emplace(name, numbers_of(*mesh, *attribute));
  }
  for (std::uint32_t face = 0; face < mesh->num_faces(); ++face)
    for (const draco::PointIndex& point : mesh->face(draco::FaceIndex(face)))
      primitive.indices.push_back(point.value());
  for (const std::uint32_t index : primitive.indices)
    if (index >= mesh->num_points()) document.fail(pointer, "vertex " + std::to_string(index), "one of them");
  return primitive;
}

#else

bool has_draco() {
  return false;
}

DracoPrimitive decode_draco(const GltfDocument& document, const GltfBytes&, const nlohmann::json&,
                            const std::string& pointer) {
  document.fail(pointer, "compressed data, which this program was built without", "data that is not");
}

#endif

}  // namespace testbench
