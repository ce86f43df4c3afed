#include "testbench/scene/gltf_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <map>

#include "testbench/gltf/gltf_accessor.hpp"
#include "testbench/material/gltf_material.hpp"
#include "testbench/scene/gltf_light.hpp"
#include "testbench/scene/gltf_nodes.hpp"
#include "testbench/scene/gltf_primitive.hpp"

namespace testbench {
namespace {

/// A file of few bytes can place a mesh a million times.
constexpr std::size_t kMostGltfTriangles = std::size_t{1} << 26;
/// Vertices and triangles of meshes, those without area as well, counted wherever a mesh is placed.
constexpr std::size_t kMostPlaced = 4 * kMostGltfTriangles;

/// Collects the triangles, materials and the camera of a document's nodes.
class Collector {
 public:
  Collector(GltfDocument& document, TextureStore& textures, GltfFile& result)
      : document_(document), textures_(textures), result_(result), nodes_(read_gltf_nodes(document)) {
    is_read_.resize(document.array("materials").size());
    materials_.resize(is_read_.size());
    Material standard;  // glTF's, for primitives without a material
    standard.reflectance = glm::dvec3(1.0);
    standard.metallic = 1.0;
    standard.specular = 1.0;
    materials_.push_back(std::move(standard));
  }

  /// @param camera_name of the camera to take; see find_gltf_camera()
  void collect(const std::optional<std::string>& camera_name) {
    for (const std::size_t node : nodes_.in_scene) {
      const nlohmann::json& source = document_.element("nodes", node);
      if (source.contains("mesh")) add_mesh(node, source);
      if (find_gltf(source, "extensions", "KHR_lights_punctual") != nullptr) add_light(node);
    }
    if (const auto node = find_gltf_camera(document_, nodes_, camera_name))
      result_.camera = read_gltf_camera(document_, *node, nodes_.transforms[*node]);
    if (!document_.array("animations").empty())
      document_.note("an animation is left out, its nodes stand as the file places them", "",
                     document_.array("animations").size());
    if (result_.mesh.triangles.empty())
      document_.fail("",
                     "no triangle (" + std::to_string(result_.mesh.degenerate_triangles) + " without area, " +
                         std::to_string(cut_out_) + " cut out)",
                     "one triangle or more");
    add_back_sides();
    complete_corner_attributes(result_.mesh.corners, result_.mesh.triangles.size());
    keep_used_materials(materials_, result_.mesh);
    forget_masks();
    result_.mesh.notes.add(document_.notes());
  }

 private:
  void add_light(std::size_t node) {
    result_.mesh.lights.push_back(read_gltf_light(document_, node, nodes_.transforms[node]));
  }

  void add_mesh(std::size_t node, const nlohmann::json& source) {
    const auto mesh = source["mesh"].get<std::size_t>();
    const nlohmann::json& of_mesh = document_.element("meshes", mesh);
    GltfPrimitivePlace place{mesh, 0, {}, 0};
    for (const nlohmann::json* holder : {&of_mesh, &source})  // a node's weights go before its mesh's
      if (const nlohmann::json* const weights = find_gltf(*holder, "weights"))
        place.weights = weights->get<std::vector<double>>();
    std::vector<glm::dmat4> joints;
    if (source.contains("skin")) joints = joint_transforms(source["skin"].get<std::size_t>());
    place.joints = joints.size();
    const std::vector<glm::dmat4> instances =
        joints.empty() ? read_gltf_instances(document_, node) : std::vector<glm::dmat4>{glm::dmat4(1.0)};
    for (; place.primitive < of_mesh["primitives"].size(); ++place.primitive) {
      const Material& of_primitive = material(material_index(place));
      place.is_textured = has_texture(of_primitive);
      place.has_normal_texture = bool(of_primitive.textures.normal);
      const std::optional<GltfPrimitive> primitive = read_gltf_primitive(document_, place);
      if (!primitive) {
        ++points_and_lines_;
        continue;
      }
      for (const glm::dmat4& instance : instances)
        add_primitive(*primitive, place, nodes_.transforms[node] * instance, joints);
    }
  }

  /// The transforms of a skin's joints (glTF 2.0, section 3.7.3.1) to the scene's coordinates.
  std::vector<glm::dmat4> joint_transforms(std::size_t skin) {
    const nlohmann::json& source = document_.element("skins", skin);
    const auto joints = source["joints"].get<std::vector<std::size_t>>();
    const std::string pointer = "/skins/" + std::to_string(skin) + "/inverseBindMatrices";
    GltfNumbers inverses;
    if (const nlohmann::json* const index = find_gltf(source, "inverseBindMatrices"))
      inverses = read_gltf_accessor(document_, *index, {{"MAT4"}, {}, {GltfComponent::f32}}, pointer);
    if (inverses.width != 0 && inverses.size() < joints.size())
      document_.fail(pointer, std::to_string(inverses.size()) + " matrices",
                     std::to_string(joints.size()) + ", one for each joint");
    std::vector<glm::dmat4> transforms;
    for (std::size_t i = 0; i < joints.size(); ++i)
      transforms.push_back(nodes_.transforms[joints[i]] *
                           (inverses.width == 0 ? glm::dmat4(1.0) : glm::make_mat4(inverses[i])));
    return transforms;
  }

  static glm::dmat4 transform_of(const std::vector<GltfInfluence>& influences,
                                 const std::vector<glm::dmat4>& joints) {
    glm::dmat4 sum(0.0);
    for (const GltfInfluence& influence : influences) sum += joints[influence.joint] * influence.weight;
    return sum;
  }

  void add_primitive(const GltfPrimitive& primitive, const GltfPrimitivePlace& place,
                     const glm::dmat4& transform, const std::vector<glm::dmat4>& joints) {
    const std::string where =
        document_.named("meshes", "mesh", place.mesh) + ", primitive " + std::to_string(place.primitive);
    placed_ += primitive.positions.size() + primitive.triangles.size();
    if (placed_ > kMostPlaced)
      document_.fail(where, "more vertices and triangles in all places together",
                     "at most " + std::to_string(kMostPlaced));
    const auto of_vertex = [&](std::uint32_t vertex) {
      return joints.empty() ? transform : transform_of(primitive.influences[vertex], joints);
    };
    std::vector<glm::dvec3> positions;
    positions.reserve(primitive.positions.size());
    for (std::uint32_t i = 0; i < primitive.positions.size(); ++i)
      positions.emplace_back(of_vertex(i) * glm::dvec4(primitive.positions[i], 1.0));
    const std::size_t plain = material_index(place);
    const bool emits_from_both_sides = material(plain).is_side_of_light;
    const PrimitiveFrames frames = moved_frames(primitive, of_vertex);
    // A transform that mirrors reverses the winding of triangles.
    const bool is_mirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
    for (const auto& [a, b, c] : primitive.triangles) {
      const bool is_reversed =
          joints.empty() ? is_mirrored : glm::determinant(glm::dmat3(of_vertex(a))) < 0.0;
      const std::array<std::uint32_t, 3> corners{a, is_reversed ? c : b, is_reversed ? b : c};
      Triangle triangle{{positions[corners[0]], positions[corners[1]], positions[corners[2]]}, 0};
      const auto index = material_of(primitive, {a, b, c}, plain, where);
      if (!index) continue;
      triangle.material = *index;
      if (add_triangle(triangle, emits_from_both_sides, where))
        add_corners(primitive, frames, corners, triangle);
    }
  }

  /// Normals and tangents of a primitive's vertices in the scene's coordinates; each may be empty.
  struct PrimitiveFrames {
    std::vector<glm::dvec3> normals;
    std::vector<glm::dvec4> tangents;
  };

  /// @param of_vertex returns the transform
  template <class OfVertex>
  static PrimitiveFrames moved_frames(const GltfPrimitive& primitive, const OfVertex& of_vertex) {
    PrimitiveFrames frames;
    frames.normals.reserve(primitive.normals.size());
    for (std::uint32_t i = 0; i < primitive.normals.size(); ++i)
      frames.normals.push_back(normal_transform(glm::dmat3(of_vertex(i))) * primitive.normals[i]);
    for (std::uint32_t i = 0; i < primitive.tangents.size(); ++i) {
      const glm::dvec4& tangent = primitive.tangents[i];
      frames.tangents.push_back(moved_tangents({tangent, tangent, tangent}, glm::dmat3(of_vertex(i)))[0]);
    }
    return frames;
  }

  /// Adds what the corners of the last triangle have.
  void add_corners(const GltfPrimitive& primitive, const PrimitiveFrames& frames,
                   const std::array<std::uint32_t, 3>& corners, const Triangle& triangle) {
    const auto of = [&corners](const auto& all) {
      return std::array{all[corners[0]], all[corners[1]], all[corners[2]]};
    };
    TriangleAttributes attributes;
    if (!frames.normals.empty()) attributes.normals = corner_normals(triangle.vertex, of(frames.normals));
    if (!frames.tangents.empty())
      attributes.tangents = corner_tangents(triangle.vertex, of(frames.normals), of(frames.tangents));
    for (std::size_t set = 0; set < primitive.coordinates.size(); ++set)
      if (!primitive.coordinates[set].empty())
        attributes.coordinates[set] = corner_coordinates(of(primitive.coordinates[set]));
    set_corner_attributes(result_.mesh.corners, result_.mesh.triangles.size() - 1, attributes);
  }

  /// The material of a primitive; the one behind the file's own for none.
  std::size_t material_index(const GltfPrimitivePlace& place) const {
    const nlohmann::json& source = document_.element("meshes", place.mesh)["primitives"][place.primitive];
    return size_or(source, "material", is_read_.size());
  }

  /// Reads a material when its first primitive comes.
  const Material& material(std::size_t index) {
    if (index < is_read_.size() && !is_read_[index]) {
      is_read_[index] = true;
      Material& read = materials_[index] = read_gltf_material(document_, textures_, index);
      read.is_side_of_light = read.is_double_sided && read.emission != glm::dvec3(0.0);
    }
    return materials_[index];
  }

  /// The material of a triangle, of which there is one for each colour; std::nullopt if it is cut out. A
  /// Lambertian triangle has one colour, so it gets the average of its vertices.
  std::optional<std::int32_t> material_of(const GltfPrimitive& primitive,
                                          const std::array<std::uint32_t, 3>& triangle, std::size_t index,
                                          const std::string& where) {
    glm::dvec4 colour(1.0);
    if (!primitive.colours.empty()) {
      const glm::dvec4 corners[3] = {primitive.colours[triangle[0]], primitive.colours[triangle[1]],
                                     primitive.colours[triangle[2]]};
      const bool is_one = corners[0] == corners[1] && corners[0] == corners[2];
      colour = is_one ? corners[0] : glm::min((corners[0] + corners[1] + corners[2]) / 3.0, 1.0);
      if (!is_one) document_.note("a triangle whose vertices differ in colour has their average", where);
    }
    const Material& plain = material(index);
    if (plain.alpha_mode == AlphaMode::opaque) colour.a = 1.0;
    if (plain.alpha_mode == AlphaMode::mask && plain.alpha * colour.a < plain.alpha_cutoff) {
      ++cut_out_;
      return std::nullopt;
    }
    if (colour == glm::dvec4(1.0)) return static_cast<std::int32_t>(index);
    const glm::dvec4 all(plain.reflectance * glm::dvec3(colour), plain.alpha * colour.a);
    return coloured_.try_emplace(index, materials_).first->second.index_of(all, plain);
  }

  /// Returns whether it has an area.
  bool add_triangle(const Triangle& triangle, bool emits_from_both_sides, const std::string& where) {
    if (!is_in_range(triangle))
      document_.fail(where, "a coordinate that is no number or too large", "numbers of at most 1e100");
    if (is_degenerate(triangle)) {
      ++result_.mesh.degenerate_triangles;
      return false;
    }
    std::vector<Triangle>& triangles = result_.mesh.triangles;
    if (triangles.size() == kMostGltfTriangles)
      document_.fail(where, "more triangles", "at most " + std::to_string(kMostGltfTriangles));
    triangles.push_back(triangle);
    if (emits_from_both_sides) double_sided_.push_back(triangles.size() - 1);
    return true;
  }

  /// Materials emit from their front side, so a light of two sides is two triangles back to back. They must
  /// not lie in one plane, where a ray that comes from either side would find the same one of them. The
  /// second lies behind the first by 2^-30 of the file's largest coordinate, far more than the rounding of
  /// hits. The offset is rounded, so that neighbours in one plane still share their vertices.
  void add_back_sides() {
    std::vector<Triangle>& triangles = result_.mesh.triangles;
    double largest = 0;
    for (const Triangle& triangle : triangles)
      for (const glm::dvec3& vertex : triangle.vertex)
        largest = std::max({largest, std::abs(vertex.x), std::abs(vertex.y), std::abs(vertex.z)});
    for (const std::size_t place : double_sided_) {
      const Triangle front = triangles[place];
      const glm::dvec3 normal = unit_normal(front);
      const glm::dvec3 offset = glm::round(normal * 0x1p20) * (0x1p-50 * largest);
      const Triangle back{{front.vertex[0] - offset, front.vertex[2] - offset, front.vertex[1] - offset},
                          front.material};
      if (is_degenerate(back)) continue;
      set_corner_attributes(result_.mesh.corners, triangles.size(),
                            from_behind(corner_attributes_of(result_.mesh.corners, place)));
      triangles.push_back(back);
    }
  }

  /// What a mask without a texture cuts out is gone: the rest is opaque.
  void forget_masks() {
    for (Material& material : result_.mesh.materials) {
      if (material.alpha_mode != AlphaMode::mask || material.textures.alpha) continue;
      material.alpha_mode = AlphaMode::opaque;
      material.alpha = 1.0;
    }
  }

  /// What a triangle's corners have, for the same one with its second and third corner exchanged.
  static TriangleAttributes from_behind(TriangleAttributes attributes) {
    if (attributes.normals) {
      for (glm::dvec3& normal : *attributes.normals) normal = -normal;
      std::swap((*attributes.normals)[1], (*attributes.normals)[2]);
    }
    for (std::optional<CornerCoordinates>& of_set : attributes.coordinates)
      if (of_set) std::swap((*of_set)[1], (*of_set)[2]);
    if (attributes.tangents) {
      for (glm::dvec4& tangent : *attributes.tangents) tangent.w = -tangent.w;
      std::swap((*attributes.tangents)[1], (*attributes.tangents)[2]);
    }
    return attributes;
  }

  /// Edges are scaled first, so that their product stays within the range of a double.
  static glm::dvec3 unit_normal(const Triangle& triangle) {
    const glm::dvec3 edge1 = triangle.vertex[1] - triangle.vertex[0];
    const glm::dvec3 edge2 = triangle.vertex[2] - triangle.vertex[0];
    const auto scaled = [](const glm::dvec3& v) {
      return glm::normalize(v / std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
    };
    return scaled(glm::cross(scaled(edge1), scaled(edge2)));
  }

  GltfDocument& document_;
  TextureStore& textures_;
  GltfFile& result_;
  const GltfNodes nodes_;
  std::vector<bool> is_read_;        ///< by the file's index of a material
  std::vector<Material> materials_;  ///< those that are used, the default one, then those of a colour
  std::map<std::size_t, ColourMaterials> coloured_;  ///< by the material that the colour multiplies
  std::vector<std::size_t> double_sided_;            ///< triangles that emit from both sides
  std::size_t placed_ = 0;                           ///< vertices and triangles, in all places
  std::size_t cut_out_ = 0;                          ///< triangles
  std::size_t points_and_lines_ = 0;                 ///< primitives
};

}  // namespace

GltfFile load_gltf(const std::filesystem::path& file, const MeshOptions& options) {
  GltfDocument document(file, options.reach);
  GltfFile result;
  Collector(document, *options.textures, result).collect(options.camera);
  return result;
}

}  // namespace testbench
