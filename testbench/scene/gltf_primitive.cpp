#include "testbench/scene/gltf_primitive.hpp"

#include <glm/gtc/type_ptr.hpp>

#include "testbench/gltf/gltf_accessor.hpp"
#include "testbench/gltf/gltf_schema.hpp"

namespace testbench {
namespace {

constexpr int kGltfTriangles = 4;
constexpr int kGltfStrip = 5;
constexpr int kGltfFan = 6;

const GltfForm kPositionForm{{"VEC3"}, {}, {GltfComponent::f32}};
/// KHR_mesh_quantization, "Extending Mesh Attributes".
const GltfForm kQuantizedPositionForm{
    {"VEC3"},
    {GltfComponent::i8, GltfComponent::u8, GltfComponent::i16, GltfComponent::u16},
    {GltfComponent::i8, GltfComponent::u8, GltfComponent::i16, GltfComponent::u16, GltfComponent::f32}};
const GltfForm kColourForm{{"VEC3", "VEC4"}, {GltfComponent::u8, GltfComponent::u16}, {GltfComponent::f32}};
const GltfForm kColourTargetForm{
    {"VEC3", "VEC4"},
    {GltfComponent::i8, GltfComponent::u8, GltfComponent::i16, GltfComponent::u16},
    {GltfComponent::f32}};
const GltfForm kNormalForm{{"VEC3"}, {}, {GltfComponent::f32}};
const GltfForm kQuantizedNormalForm{{"VEC3"}, {GltfComponent::i8, GltfComponent::i16}, {GltfComponent::f32}};
const GltfForm kTangentForm{{"VEC4"}, {}, {GltfComponent::f32}};
const GltfForm kQuantizedTangentForm{{"VEC4"}, {GltfComponent::i8, GltfComponent::i16}, {GltfComponent::f32}};
const GltfForm kCoordinateForm{{"VEC2"}, {GltfComponent::u8, GltfComponent::u16}, {GltfComponent::f32}};
const GltfForm kQuantizedCoordinateForm{
    {"VEC2"},
    {GltfComponent::i8, GltfComponent::u8, GltfComponent::i16, GltfComponent::u16},
    {GltfComponent::i8, GltfComponent::u8, GltfComponent::i16, GltfComponent::u16, GltfComponent::f32}};
const GltfForm kJointForm{{"VEC4"}, {}, {GltfComponent::u8, GltfComponent::u16}};
const GltfForm kWeightForm{{"VEC4"}, {GltfComponent::u8, GltfComponent::u16}, {GltfComponent::f32}};

/// Calls visit(a, b, c) with places in the list of vertices for each triangle, in the order that `mode`
/// defines.
template <class Visitor>
void for_each_triangle(int mode, std::size_t vertices, const Visitor& visit) {
  const auto last = [](std::size_t count, std::size_t step) { return count < step ? 0 : count - step + 1; };
  if (mode == kGltfTriangles)
    for (std::size_t i = 0; i < last(vertices, 3); i += 3) visit(i, i + 1, i + 2);
  if (mode == kGltfStrip)
    for (std::size_t i = 0; i < last(vertices, 3); ++i) visit(i, i + 1 + i % 2, i + 2 - i % 2);
  if (mode == kGltfFan)
    for (std::size_t i = 1; i < last(vertices, 2); ++i) visit(i, i + 1, std::size_t{0});
}

class PrimitiveReader {
 public:
  PrimitiveReader(GltfDocument& document, const GltfPrimitivePlace& place)
      : document_(document),
        place_(place),
        source_(document.element("meshes", place.mesh).at("primitives").at(place.primitive)),
        where_(document.named("meshes", "mesh", place.mesh) + ", primitive " +
               std::to_string(place.primitive)),
        is_quantized_(document.uses("KHR_mesh_quantization")) {}

  std::optional<GltfPrimitive> read() {
    const int mode = source_.value("mode", kGltfTriangles);
    if (mode < kGltfTriangles) {
      document_.note(mode == 0 ? "points are left out" : "lines are left out", where_);
      return std::nullopt;
    }
    if (!source_["attributes"].contains("POSITION")) document_.fail(where_, "no POSITION", "one");
    decompress();
    read_positions();
    read_colours();
    read_normals();
    if (place_.is_textured) read_coordinates();
    if (place_.has_normal_texture) read_tangents();
    if (place_.joints > 0) read_influences();
    read_triangles(mode);
    return std::move(result_);
  }

 private:
  void decompress() {
    const nlohmann::json* const packed = find_gltf(source_, "extensions", "KHR_draco_mesh_compression");
    if (packed == nullptr) return;
    const std::string pointer = where_ + ", KHR_draco_mesh_compression";
    const nlohmann::json& positions =
        document_.element("accessors", source_["attributes"]["POSITION"].get<std::size_t>());
    if (!has_draco() && positions.contains("bufferView")) return;  // the file holds the same uncompressed
    draco_ = decode_draco(document_, document_.view(packed->at("bufferView")), *packed, pointer);
  }

  /// An attribute of the primitive; without elements if it has none of that name.
  GltfNumbers attribute(const std::string& name, const GltfForm& form) {
    const nlohmann::json* const index = find_gltf(source_["attributes"], name.c_str());
    if (index == nullptr) return {};
    const std::string where = where_ + ", " + name;
    GltfNumbers numbers;
    if (draco_ && draco_->attributes.count(name) != 0) {
      const nlohmann::json& accessor = document_.element("accessors", *index);
      require_gltf_form(document_, accessor, form, where);
      numbers = std::move(draco_->attributes.at(name));
      normalize_gltf_numbers(accessor, numbers);
      const std::size_t width = std::size_t(accessor["type"].get<std::string>()[3] - '0');
      if (numbers.width != width)
        document_.fail(where, std::to_string(numbers.width) + " numbers a vertex in the compressed data",
                       std::to_string(width) + ", as its accessor says");
    } else {
      numbers = read_gltf_accessor(document_, index->get<std::size_t>(), form, where);
    }
    require_size(numbers, where);
    return numbers;
  }

  void require_size(const GltfNumbers& numbers, const std::string& where) {
    if (vertices_ == 0) vertices_ = numbers.size();  // POSITION comes first
    if (numbers.size() != vertices_)
      document_.fail(where, std::to_string(numbers.size()) + " elements",
                     std::to_string(vertices_) + ", one for each vertex");
  }

  /// Adds the targets' attribute at their weights (glTF 2.0, section 3.7.2.2).
  void add_targets(const std::string& name, const GltfForm& form, GltfNumbers& numbers) {
    const nlohmann::json* const targets = find_gltf(source_, "targets");
    if (targets == nullptr) return;
    if (!place_.weights.empty() && place_.weights.size() != targets->size())
      document_.fail(where_, std::to_string(place_.weights.size()) + " weights",
                     std::to_string(targets->size()) + ", one for each morph target");
    for (std::size_t i = 0; i < place_.weights.size(); ++i) {
      const nlohmann::json* const index = find_gltf((*targets)[i], name.c_str());
      if (index == nullptr || place_.weights[i] == 0.0) continue;
      const std::string where = where_ + ", target " + std::to_string(i) + ", " + name;
      const GltfNumbers offsets = read_gltf_accessor(document_, index->get<std::size_t>(), form, where);
      require_size(offsets, where);
      if (offsets.width != numbers.width) document_.fail(where, "another type", "the attribute's own");
      for (std::size_t k = 0; k < numbers.values.size(); ++k)
        numbers.values[k] += place_.weights[i] * offsets.values[k];
    }
  }

  void read_positions() {
    const GltfForm& form = is_quantized_ ? kQuantizedPositionForm : kPositionForm;
    GltfNumbers positions = attribute("POSITION", form);
    add_targets("POSITION", form, positions);
    for (std::size_t i = 0; i < vertices_; ++i) result_.positions.push_back(glm::make_vec3(positions[i]));
  }

  /// COLOR_0 (glTF 2.0, section 3.7.2.1) is linear and multiplies the base colour; its components are clamped
  /// to 0..1.
  void read_colours() {
    GltfNumbers colours = attribute("COLOR_0", kColourForm);
    if (colours.width == 0) return;
    add_targets("COLOR_0", kColourTargetForm, colours);
    for (std::size_t i = 0; i < vertices_; ++i) {
      glm::dvec4 colour(1.0);
      for (std::size_t k = 0; k < colours.width; ++k) {
        const double value = colours[i][k];
        colour[int(k)] = value >= 1.0 ? 1.0 : value > 0.0 ? value : 0.0;
      }
      result_.colours.push_back(colour);
    }
  }

  void read_normals() {
    const GltfForm& form = is_quantized_ ? kQuantizedNormalForm : kNormalForm;
    GltfNumbers normals = attribute("NORMAL", form);
    if (normals.width == 0) return;
    add_targets("NORMAL", form, normals);
    for (std::size_t i = 0; i < vertices_; ++i) result_.normals.push_back(glm::make_vec3(normals[i]));
  }

  void read_coordinates() {
    const GltfForm& form = is_quantized_ ? kQuantizedCoordinateForm : kCoordinateForm;
    for (std::size_t set = 0; set < result_.coordinates.size(); ++set) {
      const std::string name = "TEXCOORD_" + std::to_string(set);
      GltfNumbers numbers = attribute(name, form);
      if (numbers.width == 0) continue;
      add_targets(name, form, numbers);
      for (std::size_t i = 0; i < vertices_; ++i)
        result_.coordinates[set].push_back(glm::make_vec2(numbers[i]));
    }
  }

  /// Without normals, tangents are to be ignored (glTF 2.0, section 3.7.2.1). Morph targets move them, but
  /// not to the other side.
  void read_tangents() {
    GltfNumbers tangents = attribute("TANGENT", is_quantized_ ? kQuantizedTangentForm : kTangentForm);
    if (tangents.width == 0) return;
    if (result_.normals.empty())
      return document_.note("TANGENT without NORMAL is left out, tangents follow from texture coordinates",
                            where_);
    GltfNumbers directions{3, {}};
    for (std::size_t i = 0; i < vertices_; ++i)
      directions.values.insert(directions.values.end(), tangents[i], tangents[i] + 3);
    add_targets("TANGENT", is_quantized_ ? kQuantizedNormalForm : kNormalForm, directions);
    for (std::size_t i = 0; i < vertices_; ++i)
      result_.tangents.emplace_back(glm::make_vec3(directions[i]), tangents[i][3]);
  }

  void read_influences() {
    result_.influences.resize(vertices_);
    for (int set = 0;; ++set) {
      const std::string number = std::to_string(set);
      const GltfNumbers joints = attribute("JOINTS_" + number, kJointForm);
      const GltfNumbers weights = attribute("WEIGHTS_" + number, kWeightForm);
      if ((joints.width == 0) != (weights.width == 0))
        document_.fail(where_,
                       std::string("only one of JOINTS_").append(number).append(" and WEIGHTS_") + number,
                       "both or none");
      if (set == 0 && joints.width == 0) document_.fail(where_, "a skin without JOINTS_0", "with it");
      if (joints.width == 0) break;
      for (std::size_t i = 0; i < vertices_ * 4; ++i)
        add_influence(i / 4, joints.values[i], weights.values[i]);
    }
    for (std::vector<GltfInfluence>& of_vertex : result_.influences) normalize(of_vertex);
  }

  void add_influence(std::size_t vertex, double joint, double weight) {
    if (weight == 0.0) return;
    if (!(joint < double(place_.joints)) || !(weight > 0.0))
      document_.fail(where_,
                     "joint " + std::to_string(std::size_t(joint)) + " of weight " + std::to_string(weight),
                     "joints 0 to " + std::to_string(place_.joints - 1) + ", weights from 0");
    result_.influences[vertex].push_back({std::size_t(joint), weight});
  }

  /// Weights sum to 1 but for the rounding of the exporter. A vertex without any follows the first joint.
  static void normalize(std::vector<GltfInfluence>& influences) {
    if (influences.empty()) influences.push_back({0, 1.0});
    double sum = 0;
    for (const GltfInfluence& influence : influences) sum += influence.weight;
    for (GltfInfluence& influence : influences) influence.weight /= sum;
  }

  void read_triangles(int mode) {
    std::vector<std::uint32_t> indices;
    const nlohmann::json* const index = find_gltf(source_, "indices");
    const bool is_indexed = draco_ || index != nullptr;
    if (draco_)
      indices = std::move(draco_->indices);
    else if (index != nullptr)
      indices = read_gltf_indices(document_, index->get<std::size_t>(), vertices_, where_ + ", indices");
    const std::size_t size = is_indexed ? indices.size() : vertices_;
    const int actual_mode = draco_ ? kGltfTriangles : mode;
    const auto vertex = [&](std::size_t place) {
      return is_indexed ? indices[place] : static_cast<std::uint32_t>(place);
    };
    for_each_triangle(actual_mode, size, [&](std::size_t a, std::size_t b, std::size_t c) {
      result_.triangles.push_back({vertex(a), vertex(b), vertex(c)});
    });
    if (size < 3 || (actual_mode == kGltfTriangles && size % 3 != 0))
      document_.note("a vertex that completes no triangle is left out", where_, size < 3 ? size : size % 3);
  }

  GltfDocument& document_;
  const GltfPrimitivePlace& place_;
  const nlohmann::json& source_;
  const std::string where_;
  const bool is_quantized_;
  std::optional<DracoPrimitive> draco_;
  std::size_t vertices_ = 0;
  GltfPrimitive result_;
};

}  // namespace

std::optional<GltfPrimitive> read_gltf_primitive(GltfDocument& document, const GltfPrimitivePlace& place) {
  return PrimitiveReader(document, place).read();
}

}  // namespace testbench
