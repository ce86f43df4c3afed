#include "testbench/scene/gltf_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "testbench/gltf/gltf_accessor.hpp"
#include "testbench/gltf/gltf_schema.hpp"
#include "testbench/scene/mesh.hpp"

namespace testbench {
namespace {

constexpr std::size_t kNoParent = std::numeric_limits<std::size_t>::max();
/// At one node.
constexpr std::size_t kMostInstances = std::size_t{1} << 20;
constexpr const char* kTree = "a tree: one parent at most, and no node below itself";

glm::dquat rotation_of(const double* xyzw) {
  return glm::normalize(glm::dquat(xyzw[3], xyzw[0], xyzw[1], xyzw[2]));
}

bool is_finite(const glm::dmat4& matrix) {
  return std::all_of(glm::value_ptr(matrix), glm::value_ptr(matrix) + 16,
                     [](double value) { return std::isfinite(value); });
}

/// One way to give a transform, and one that keeps points points (glTF 2.0, section 3.5.3).
void require_transform(const GltfDocument& document, const nlohmann::json& node, const std::string& pointer) {
  if (const nlohmann::json* const matrix = find_gltf(node, "matrix")) {
    for (const char* other : {"translation", "rotation", "scale"})
      if (node.contains(other)) document.fail(pointer, std::string("matrix and ") + other, "one of them");
    if ((*matrix)[3] != 0.0 || (*matrix)[7] != 0.0 || (*matrix)[11] != 0.0 || (*matrix)[15] != 1.0)
      document.fail(pointer + "/matrix", json_in_message(*matrix), "0, 0, 0, 1 as its last row");
  }
  if (const nlohmann::json* const rotation = find_gltf(node, "rotation"))
    if (std::all_of(rotation->begin(), rotation->end(), [](const auto& part) { return part == 0.0; }))
      document.fail(pointer + "/rotation", json_in_message(*rotation), "a quaternion of length 1");
}

glm::dmat4 transform_of(const nlohmann::json& node) {
  if (const nlohmann::json* const matrix = find_gltf(node, "matrix"))
    return glm::make_mat4(matrix->get<std::vector<double>>().data());
  glm::dmat4 transform(1.0);
  if (const nlohmann::json* const translation = find_gltf(node, "translation"))
    transform = glm::translate(transform, glm::make_vec3(translation->get<std::vector<double>>().data()));
  if (const nlohmann::json* const rotation = find_gltf(node, "rotation"))
    transform *= glm::mat4_cast(rotation_of(rotation->get<std::vector<double>>().data()));
  if (const nlohmann::json* const scale = find_gltf(node, "scale"))
    transform = glm::scale(transform, glm::make_vec3(scale->get<std::vector<double>>().data()));
  return transform;
}

std::vector<std::size_t> children_of(const nlohmann::json& node) {
  const nlohmann::json* const children = find_gltf(node, "children");
  return children == nullptr ? std::vector<std::size_t>() : children->get<std::vector<std::size_t>>();
}

std::vector<std::size_t> parents_of(const GltfDocument& document) {
  const nlohmann::json& nodes = document.array("nodes");
  std::vector<std::size_t> parents(nodes.size(), kNoParent);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const std::size_t child : children_of(nodes[i])) {
      if (parents[child] != kNoParent)
        document.fail(document.named("nodes", "node", child), "a second way to it", kTree);
      parents[child] = i;
    }
  }
  return parents;
}

/// Calls visit(node, parent) for the node and all below it, parents first, children in their order. Its stack
/// is explicit, because a file may chain more nodes than recursion has room for.
template <class Visitor>
void for_each_below(const GltfDocument& document, std::size_t root, const Visitor& visit) {
  std::vector<std::size_t> open{root};
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    visit(node);
    const std::vector<std::size_t> children = children_of(document.element("nodes", node));
    open.insert(open.end(), children.rbegin(), children.rend());
  }
}

std::vector<std::size_t> scene_roots(const GltfDocument& document, const std::vector<std::size_t>& parents) {
  std::vector<std::size_t> roots;
  if (document.array("scenes").empty()) {
    for (std::size_t i = 0; i < parents.size(); ++i)
      if (parents[i] == kNoParent) roots.push_back(i);
    return roots;
  }
  const std::size_t scene = size_or(document.root(), "scene", 0);
  const nlohmann::json* const nodes = find_gltf(document.element("scenes", scene), "nodes");
  if (nodes == nullptr) return roots;
  roots = nodes->get<std::vector<std::size_t>>();
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const std::string pointer = "/scenes/" + std::to_string(scene) + "/nodes/" + std::to_string(i);
    if (parents[roots[i]] != kNoParent)
      document.fail(pointer, document.named("nodes", "node", roots[i]) + ", which has a parent",
                    "nodes without a parent");
  }
  std::vector<std::size_t> sorted = roots;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    document.fail(document.named("nodes", "node", *twice), "a second way to it", kTree);
  return roots;
}

GltfNumbers read_instance_attribute(GltfDocument& document, const nlohmann::json& attributes,
                                    const char* name, const GltfForm& form, const std::string& pointer) {
  if (!attributes.contains(name)) return {};
  return read_gltf_accessor(document, attributes[name], form, pointer + "/attributes/" + name);
}

const nlohmann::json& camera_at(const GltfDocument& document, std::size_t node) {
  return document.element("cameras", document.element("nodes", node).at("camera").get<std::size_t>());
}

std::string camera_pointer(const GltfDocument& document, std::size_t node) {
  return "/cameras/" + std::to_string(document.element("nodes", node).at("camera").get<std::size_t>());
}

bool is_orthographic(const nlohmann::json& camera) {
  return camera.value("type", nlohmann::json()) == "orthographic";
}

bool has_name(const nlohmann::json& object, const std::string& name) {
  return object.value("name", nlohmann::json()) == name;
}

/// @param nodes with orthographic cameras
void note_unused(GltfDocument& document, const std::vector<std::size_t>& nodes) {
  for (const std::size_t node : nodes)
    document.note("an orthographic camera is left out (camera of [[mesh]] names the one to use)",
                  camera_pointer(document, node));
}

void read_perspective(const GltfDocument& document, const nlohmann::json& lens, const std::string& pointer,
                      GltfCamera& result) {
  const double angle = lens["yfov"].get<double>();
  if (!(angle < glm::pi<double>()))
    document.fail(pointer + "/perspective/yfov", json_in_message(lens["yfov"]), "0 to pi, both excluded");
  result.camera.vertical_field_of_view_radians = angle;
  if (const nlohmann::json* const ratio = find_gltf(lens, "aspectRatio"))
    result.aspect_ratio = ratio->get<double>();
}

/// xmag and ymag are half the width and height of the view (glTF 2.0, section 3.10.3).
void read_orthographic(const GltfDocument& document, const nlohmann::json& lens, const std::string& pointer,
                       GltfCamera& result) {
  for (const char* const size : {"xmag", "ymag"})
    if (!(lens[size].get<double>() <= 0.5 * kMaxCoordinate))
      document.fail(pointer + "/orthographic/" + size, json_in_message(lens[size]), "at most 5e99");
  result.camera.orthographic_height = 2.0 * lens["ymag"].get<double>();
  result.aspect_ratio = lens["xmag"].get<double>() / lens["ymag"].get<double>();
}

}  // namespace

GltfNodes read_gltf_nodes(GltfDocument& document) {
  const std::vector<std::size_t> parents = parents_of(document);
  GltfNodes nodes;
  nodes.transforms.resize(parents.size());
  std::vector<bool> is_placed(parents.size(), false);
  for (std::size_t root = 0; root < parents.size(); ++root) {
    if (parents[root] != kNoParent) continue;
    for_each_below(document, root, [&](std::size_t node) {
      const nlohmann::json& source = document.element("nodes", node);
      require_transform(document, source, "/nodes/" + std::to_string(node));
      const glm::dmat4 of_parent = node == root ? glm::dmat4(1.0) : nodes.transforms[parents[node]];
      nodes.transforms[node] = of_parent * transform_of(source);
      is_placed[node] = true;
    });
  }
  for (std::size_t i = 0; i < parents.size(); ++i)
    if (!is_placed[i]) document.fail(document.named("nodes", "node", i), "itself among its ancestors", kTree);
  for (const std::size_t root : scene_roots(document, parents))
    for_each_below(document, root, [&](std::size_t node) { nodes.in_scene.push_back(node); });
  return nodes;
}

std::vector<glm::dmat4> read_gltf_instances(GltfDocument& document, std::size_t node) {
  const nlohmann::json* const extension =
      find_gltf(document.element("nodes", node), "extensions", "EXT_mesh_gpu_instancing");
  if (extension == nullptr) return {glm::dmat4(1.0)};
  const std::string pointer = "/nodes/" + std::to_string(node) + "/extensions/EXT_mesh_gpu_instancing";
  const nlohmann::json& attributes = extension->at("attributes");
  const auto read = [&](const char* name, const GltfForm& form) {
    return read_instance_attribute(document, attributes, name, form, pointer);
  };
  const GltfNumbers translations = read("TRANSLATION", {{"VEC3"}, {}, {GltfComponent::f32}});
  const GltfNumbers rotations =
      read("ROTATION", {{"VEC4"}, {GltfComponent::i8, GltfComponent::i16}, {GltfComponent::f32}});
  const GltfNumbers scales = read("SCALE", {{"VEC3"}, {}, {GltfComponent::f32}});
  const std::size_t count = std::max({translations.size(), rotations.size(), scales.size()});
  for (const GltfNumbers* numbers : {&translations, &rotations, &scales})
    if (numbers->width != 0 && numbers->size() != count)
      document.fail(
          pointer,
          "attributes of " + std::to_string(numbers->size()) + " and " + std::to_string(count) + " instances",
          "one number of instances");
  if (count > kMostInstances)
    document.fail(pointer, std::to_string(count) + " instances", "at most " + std::to_string(kMostInstances));
  std::vector<glm::dmat4> transforms;
  transforms.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    glm::dmat4 transform(1.0);
    if (translations.width != 0) transform = glm::translate(transform, glm::make_vec3(translations[i]));
    if (rotations.width != 0) transform *= glm::mat4_cast(rotation_of(rotations[i]));
    if (scales.width != 0) transform = glm::scale(transform, glm::make_vec3(scales[i]));
    transforms.push_back(transform);
  }
  return transforms;
}

std::optional<std::size_t> find_gltf_camera(GltfDocument& document, const GltfNodes& nodes,
                                            const std::optional<std::string>& name) {
  std::vector<std::size_t> orthographic;
  for (const std::size_t node : nodes.in_scene) {
    const nlohmann::json& source = document.element("nodes", node);
    if (!source.contains("camera")) continue;
    const nlohmann::json& camera = camera_at(document, node);
    if (name) {
      if (has_name(camera, *name) || has_name(source, *name)) return node;
    } else if (!is_orthographic(camera)) {
      note_unused(document, orthographic);
      return node;
    } else {
      orthographic.push_back(node);
    }
  }
  if (name) document.fail("/cameras", "no camera '" + *name + "' in the scene", "the name of one");
  if (orthographic.empty()) return std::nullopt;
  const std::size_t first = orthographic.front();
  orthographic.erase(orthographic.begin());
  note_unused(document, orthographic);
  return first;
}

GltfCamera read_gltf_camera(GltfDocument& document, std::size_t node, const glm::dmat4& transform) {
  const nlohmann::json& source = camera_at(document, node);
  const std::string pointer = camera_pointer(document, node);
  document.check(source, "camera", pointer);
  const char* const projection = is_orthographic(source) ? "orthographic" : "perspective";
  if (!source.contains(projection)) document.fail(pointer + "/" + projection, "none", "an object");
  const glm::dmat3 axes(transform);
  const std::string where = document.named("nodes", "node", node);
  if (!is_finite(transform) || !(std::abs(glm::determinant(axes)) > 0.0))
    document.fail(where, "a camera in a transform without volume", "one with");
  GltfCamera result;
  Camera& camera = result.camera;
  camera.position = glm::dvec3(transform[3]);
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(camera.position[axis]) <= kMaxCoordinate))
      document.fail(where, "a camera too far away", "coordinates of at most 1e100");
  camera.direction = glm::normalize(-axes[2]);
  const glm::dvec3 side = glm::normalize(glm::cross(camera.direction, axes[1]));
  camera.up = glm::cross(side, camera.direction);
  const nlohmann::json& lens = source[projection];
  if (is_orthographic(source))
    read_orthographic(document, lens, pointer, result);
  else
    read_perspective(document, lens, pointer, result);
  return result;
}

}  // namespace testbench
