#include "testbench/scene/gltf_mesh.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <string>

#include "testbench/scene/gltf_accessor.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";

[[noreturn]] void fail_in_gltf(const std::filesystem::path& file, const std::string& where,
                               const std::string& found, const std::string& allowed) {
  throw InputError(file.string() + ": " + (where.empty() ? "" : where + ": ") + "found " + found +
                   "; allowed: " + allowed);
}

/// Image loader that decodes nothing: material_of() refuses materials with textures.
bool leave_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                 void*) {
  return true;
}

tinygltf::Model parse_gltf(const std::filesystem::path& file) {
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(leave_image, nullptr);
  tinygltf::Model model;
  std::string error;
  std::string warning;
  std::error_code status;
  if (!std::filesystem::is_regular_file(file, status))
    fail_in_gltf(file, "", "no file that can be read", "a .gltf or .glb file");
  bool parsed = false;
  try {
    parsed = file.extension() == ".glb" ? parser.LoadBinaryFromFile(&model, &error, &warning, file.string())
                                        : parser.LoadASCIIFromFile(&model, &error, &warning, file.string());
  } catch (const std::exception& thrown) {  // thrown by TinyGLTF's JSON parser
    error = thrown.what();
  }
  if (!parsed)
    fail_in_gltf(file, "", error.empty() ? "something that is no glTF" : "'" + first_line(error) + "'",
                 "a valid glTF 2.0 file");
  for (const std::string& extension : model.extensionsRequired)
    if (extension != kEmissiveStrength)
      fail_in_gltf(file, "extensionsRequired", extension, std::string("none but ") + kEmissiveStrength);
  return model;
}

std::string named(const char* kind, std::size_t index, const std::string& name) {
  return std::string(kind) + " " + std::to_string(index) + (name.empty() ? "" : " '" + name + "'");
}

Material material_of(const std::filesystem::path& file, const tinygltf::Material& source, std::size_t index) {
  const std::string where = named("material", index, source.name);
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  if (pbr.baseColorTexture.index >= 0 || source.emissiveTexture.index >= 0)
    fail_in_gltf(file, where, "a texture", "colours only (baseColorFactor, emissiveFactor)");
  double strength = 1.0;
  const auto extension = source.extensions.find(kEmissiveStrength);
  if (extension != source.extensions.end() && extension->second.Has("emissiveStrength"))
    strength = extension->second.Get("emissiveStrength").GetNumberAsDouble();
  Material material;
  material.name = source.name;
  for (int channel = 0; channel < 3; ++channel) {
    const double reflectance = pbr.baseColorFactor[std::size_t(channel)];
    const double emission = source.emissiveFactor[std::size_t(channel)] * strength;
    if (!(reflectance >= 0.0 && reflectance <= 1.0))
      fail_in_gltf(file, where, "a baseColorFactor of " + std::to_string(reflectance), "0 to 1");
    if (!(emission >= 0.0 && emission <= kMaxEmission))
      fail_in_gltf(file, where, "an emission of " + std::to_string(emission), "0 to 1e12");
    material.reflectance[channel] = reflectance;
    material.emission[channel] = emission;
  }
  return material;
}

glm::dmat4 transform_of(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 transform(1.0);
  if (node.translation.size() == 3)
    transform = glm::translate(transform, glm::make_vec3(node.translation.data()));
  if (node.rotation.size() == 4)
    transform *= glm::mat4_cast(
        glm::normalize(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])));
  if (node.scale.size() == 3) transform = glm::scale(transform, glm::make_vec3(node.scale.data()));
  return transform;
}

/// Visits the corners of each triangle of a primitive, in the order that its mode defines.
template <class Visitor>  // (a, b, c): indices into the list of vertices
void for_each_triangle(int mode, std::size_t vertices, const Visitor& visit) {
  const auto last = [](std::size_t count, std::size_t step) { return count < step ? 0 : count - step + 1; };
  if (mode == TINYGLTF_MODE_TRIANGLES || mode < 0)
    for (std::size_t i = 0; i < last(vertices, 3); i += 3) visit(i, i + 1, i + 2);
  if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
    for (std::size_t i = 0; i < last(vertices, 3); ++i) visit(i, i + 1 + i % 2, i + 2 - i % 2);
  if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
    for (std::size_t i = 1; i < last(vertices, 2); ++i) visit(i, i + 1, std::size_t{0});
}

/// Walks the nodes and collects their triangles, materials and camera.
class Collector {
 public:
  Collector(const std::filesystem::path& file, const tinygltf::Model& model, GltfFile& result)
      : file_(file), model_(model), result_(result), visited_(model.nodes.size(), false) {
    for (std::size_t i = 0; i < model.materials.size(); ++i)
      materials_.push_back(material_of(file, model.materials[i], i));
    materials_.push_back(
        {"", glm::dvec3(1.0), glm::dvec3(0.0)});  // glTF's default, for primitives without one
  }

  void collect() {
    for (const int root : roots()) add_node(root, glm::dmat4(1.0));
    if (result_.mesh.triangles.empty())
      fail_in_gltf(file_, "",
                   "no triangle (" + std::to_string(result_.mesh.degenerate_triangles) + " without area)",
                   "one triangle or more");
    keep_used_materials(materials_, result_.mesh);
  }

 private:
  std::vector<int> roots() const {
    if (!model_.scenes.empty()) {
      const int scene = std::max(model_.defaultScene, 0);
      require_index(scene, model_.scenes.size(), "scene");
      return model_.scenes[std::size_t(scene)].nodes;
    }
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes)
      for (const int child : node.children)
        if (child >= 0 && std::size_t(child) < is_child.size()) is_child[std::size_t(child)] = true;
    std::vector<int> roots;
    for (std::size_t i = 0; i < model_.nodes.size(); ++i)
      if (!is_child[i]) roots.push_back(static_cast<int>(i));
    return roots;
  }

  void require_index(int index, std::size_t size, const std::string& what) const {
    if (index < 0 || std::size_t(index) >= size)
      fail_in_gltf(file_, "", what + " " + std::to_string(index),
                   size == 0 ? "none, the file holds no " + what : "0 to " + std::to_string(size - 1));
  }

  /// Uses an explicit stack of nodes, because a file may chain more nodes than recursion has room for.
  void add_node(int root, const glm::dmat4& of_root) {
    std::vector<std::pair<int, glm::dmat4>> open{{root, of_root}};
    while (!open.empty()) {
      const auto [index, of_parent] = open.back();
      open.pop_back();
      require_index(index, model_.nodes.size(), "node");
      const tinygltf::Node& node = model_.nodes[std::size_t(index)];
      if (visited_[std::size_t(index)])
        fail_in_gltf(file_, named("node", std::size_t(index), node.name), "a second way to it",
                     "a tree: one parent at most, and no node below itself");
      visited_[std::size_t(index)] = true;
      const glm::dmat4 transform = of_parent * transform_of(node);
      if (node.mesh >= 0) add_mesh(node.mesh, transform);
      if (node.camera >= 0 && !result_.camera) add_camera(node.camera, transform);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        open.emplace_back(*child, transform);
    }
  }

  void add_mesh(int index, const glm::dmat4& transform) {
    require_index(index, model_.meshes.size(), "mesh");
    const tinygltf::Mesh& mesh = model_.meshes[std::size_t(index)];
    for (std::size_t i = 0; i < mesh.primitives.size(); ++i)
      add_primitive(mesh.primitives[i], transform,
                    named("mesh", std::size_t(index), mesh.name) + ", primitive " + std::to_string(i));
  }

  void add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& transform,
                     const std::string& where) {
    if (primitive.material >= 0) require_index(primitive.material, model_.materials.size(), "material");
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) fail_in_gltf(file_, where, "no POSITION", "one");
    const GltfAccessor vertices(file_, model_, position->second, where + ", POSITION");
    std::optional<GltfAccessor> indices;
    if (primitive.indices >= 0) indices.emplace(file_, model_, primitive.indices, where + ", indices");
    const auto material = static_cast<std::int32_t>(primitive.material >= 0 ? std::size_t(primitive.material)
                                                                            : materials_.size() - 1);
    // A transform that mirrors reverses the winding of triangles.
    const bool is_mirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
    const auto vertex = [&](std::size_t place) {
      const std::size_t index = indices ? indices->index(place, vertices.size()) : place;
      return glm::dvec3(transform * glm::dvec4(vertices.point(index), 1.0));
    };
    for_each_triangle(primitive.mode, indices ? indices->size() : vertices.size(),
                      [&](std::size_t a, std::size_t b, std::size_t c) {
                        if (is_mirrored) std::swap(b, c);
                        add_triangle({{vertex(a), vertex(b), vertex(c)}, material}, where);
                      });
  }

  void add_triangle(const Triangle& triangle, const std::string& where) {
    if (!is_in_range(triangle))
      fail_in_gltf(file_, where, "a coordinate that is no number or too large", "numbers of at most 1e100");
    if (is_degenerate(triangle)) {
      ++result_.mesh.degenerate_triangles;
    } else {
      result_.mesh.triangles.push_back(triangle);
    }
  }

  /// Looks along -z with +y up (glTF 2.0, section 3.10).
  void add_camera(int index, const glm::dmat4& transform) {
    require_index(index, model_.cameras.size(), "camera");
    const tinygltf::Camera& source = model_.cameras[std::size_t(index)];
    const std::string where = named("camera", std::size_t(index), source.name);
    if (source.type != "perspective") fail_in_gltf(file_, where, "type " + source.type, "perspective");
    const double angle = source.perspective.yfov;
    if (!(angle > 0.0 && angle < glm::pi<double>()))
      fail_in_gltf(file_, where, "a yfov of " + std::to_string(angle), "0 to pi, both excluded");
    const glm::dmat3 axes(transform);
    if (!(std::abs(glm::determinant(axes)) > 0.0))
      fail_in_gltf(file_, where, "a transform without volume", "one with");
    Camera camera;
    camera.position = glm::dvec3(transform[3]);
    camera.direction = glm::normalize(-axes[2]);
    const glm::dvec3 side = glm::normalize(glm::cross(camera.direction, axes[1]));
    camera.up = glm::cross(side, camera.direction);
    camera.vertical_field_of_view_radians = angle;
    result_.camera = GltfCamera{camera, std::nullopt};
    if (source.perspective.aspectRatio > 0.0) result_.camera->aspect_ratio = source.perspective.aspectRatio;
  }

  const std::filesystem::path& file_;
  const tinygltf::Model& model_;
  GltfFile& result_;
  std::vector<Material> materials_;
  std::vector<bool> visited_;
};

/// "a b.bin" of "a%20b.bin" (RFC 3986, section 2.1).
std::string without_percents(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    int code = 0;
    const char* const digits = uri.data() + i + 1;
    const bool is_code = uri[i] == '%' && i + 2 < uri.size() &&
                         std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
    text += is_code ? static_cast<char>(code) : uri[i];
    if (is_code) i += 2;
  }
  return text;
}

/// The file and those that its buffers and images name.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& file, const tinygltf::Model& model) {
  std::vector<std::filesystem::path> files = {file};
  const auto add = [&](const std::string& uri) {
    if (!uri.empty() && !tinygltf::IsDataURI(uri))
      files.push_back(file.parent_path() / without_percents(uri));
  };
  for (const tinygltf::Buffer& buffer : model.buffers) add(buffer.uri);
  for (const tinygltf::Image& image : model.images) add(image.uri);
  return files;
}

}  // namespace

GltfFile load_gltf(const std::filesystem::path& file) {
  const tinygltf::Model model = parse_gltf(file);
  GltfFile result;
  result.mesh.files = files_of(file, model);
  Collector(file, model, result).collect();
  return result;
}

}  // namespace testbench
