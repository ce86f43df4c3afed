#include "testbench/scene/scene_file.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <initializer_list>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "testbench/scene/gltf_mesh.hpp"
#include "testbench/scene/obj_mesh.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr double kLargestDouble = std::numeric_limits<double>::max();

/// Throws InputError. `where` is a file, or a file and a line.
[[noreturn]] void fail(const std::string& where, std::string_view key, std::string_view found,
                       std::string_view allowed) {
  std::ostringstream message;
  message << where << ": " << key << ": found " << found << "; allowed: " << allowed;
  std::string line = message.str();
  std::replace(line.begin(), line.end(), '\n', ' ');
  throw InputError(line);
}

std::string joined(std::initializer_list<const char*> words) {
  std::string result;
  for (const char* word : words) result += (result.empty() ? "" : ", ") + std::string(word);
  return result;
}

/// One table of a scene.toml, with typed and checked access to its keys.
class TableReader {
 public:
  TableReader(std::string file, std::string name, const toml::table& table)
      : file_(std::move(file)), name_(std::move(name)), table_(table) {}

  void require_only(std::initializer_list<const char*> allowed) const {
    for (const auto& [key, node] : table_) {
      const auto matches = [&key_text = key](const char* word) { return key_text.str() == word; };
      if (std::none_of(allowed.begin(), allowed.end(), matches)) {
        fail(where(node), full_key(key.str()), "an unknown key", joined(allowed));
      }
    }
  }

  bool has(const char* key) const { return table_.contains(key); }

  /// Whether the table holds the first of two groups of keys. Fails unless it holds one of them completely
  /// and no key of the other.
  bool has_first_of(std::initializer_list<const char*> first,
                    std::initializer_list<const char*> second) const {
    const auto present = [this](const char* key) { return has(key); };
    const bool first_whole = std::all_of(first.begin(), first.end(), present);
    const bool second_whole = std::all_of(second.begin(), second.end(), present);
    const bool any_first = std::any_of(first.begin(), first.end(), present);
    const bool any_second = std::any_of(second.begin(), second.end(), present);
    if (first_whole && !any_second) return true;
    if (second_whole && !any_first) return false;
    std::string found;
    for (const auto& group : {first, second}) {
      for (const char* key : group) {
        if (has(key)) found += (found.empty() ? "" : " and ") + std::string(key);
      }
    }
    fail(where(table_), name_, found.empty() ? "neither form" : found,
         "either " + joined(first) + " or " + joined(second));
  }

  /// A number in the open interval (low, high).
  double number_between(const char* key, double low, double high) const {
    const toml::node& node = require(key);
    const std::optional<double> value = finite(node);
    if (!value || *value <= low || *value >= high) {
      std::ostringstream allowed;
      allowed << "a number greater than " << low;
      if (high < kLargestDouble) allowed << " and less than " << high;
      fail(where(node), full_key(key), text_of(node), allowed.str());
    }
    return *value;
  }

  int pixels(const char* key) const {
    if (!has(key)) return kDefaultFilmSide;
    const toml::node& node = require(key);
    const std::optional<std::int64_t> value = node.value_exact<std::int64_t>();
    if (!value || *value < 1 || *value > kMaxFilmSide) {
      fail(where(node), full_key(key), text_of(node),
           "a whole number from 1 to " + std::to_string(kMaxFilmSide));
    }
    return static_cast<int>(*value);
  }

  glm::dvec3 vector(const char* key) const {
    const toml::node& node = require(key);
    const toml::array* array = node.as_array();
    glm::dvec3 result(0.0);
    bool good = array != nullptr && array->size() == 3;
    for (std::size_t axis = 0; good && axis < 3; ++axis) {
      const std::optional<double> value = finite((*array)[axis]);
      good = value && std::abs(*value) <= kMaxCoordinate;
      if (good) result[static_cast<int>(axis)] = *value;
    }
    if (!good)
      fail(where(node), full_key(key), text_of(node), "three finite numbers [x, y, z] of at most 1e100");
    return result;
  }

  glm::dvec3 vector_or(const char* key, const glm::dvec3& otherwise) const {
    return has(key) ? vector(key) : otherwise;
  }

  std::string text(const char* key) const {
    const toml::node& node = require(key);
    const std::optional<std::string> value = node.value_exact<std::string>();
    if (!value || value->empty()) fail(where(node), full_key(key), text_of(node), "a file name in quotes");
    return *value;
  }

  /// Fails at the line of `key`, or at the line of the table if it has no such key.
  [[noreturn]] void fail_at(const char* key, std::string_view found, std::string_view allowed) const {
    const toml::node* node = table_.get(key);
    fail(node != nullptr ? where(*node) : where(table_), full_key(key), found, allowed);
  }

  std::string text_of(const char* key) const { return text_of(require(key)); }

 private:
  static std::optional<double> finite(const toml::node& node) {
    if (!node.is_number()) return std::nullopt;
    const std::optional<double> value = node.value<double>();
    if (!value || !std::isfinite(*value)) return std::nullopt;
    return value;
  }

  static std::string text_of(const toml::node& node) {
    std::ostringstream text;
    text << toml::toml_formatter{node};
    return text.str();
  }

  const toml::node& require(const char* key) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) fail(where(table_), full_key(key), "none", "this key is required");
    return *node;
  }

  std::string where(const toml::node& node) const {
    const auto line = node.source().begin.line;
    return line > 0 ? file_ + ":" + std::to_string(line) : file_;
  }

  std::string full_key(std::string_view key) const {
    return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
  }

  std::string file_;
  std::string name_;
  const toml::table& table_;
};

bool is_gltf(const std::filesystem::path& file) {
  return file.extension() == ".gltf" || file.extension() == ".glb";
}

constexpr const char* kSceneFiles = "a directory that holds scene.toml, or a .toml, .gltf or .glb file";

std::filesystem::path scene_path(const std::filesystem::path& scene) {
  std::error_code error;
  std::filesystem::path file = std::filesystem::is_directory(scene, error) ? scene / "scene.toml" : scene;
  if (!std::filesystem::is_regular_file(file, error)) {
    fail(scene.string(), "scene", "no file " + file.string(), kSceneFiles);
  }
  if (file.extension() != ".toml" && !is_gltf(file)) {
    fail(scene.string(), "scene", "a file named " + file.filename().string(), kSceneFiles);
  }
  return file;
}

toml::table parse_toml(const std::filesystem::path& file) {
  try {
    return toml::parse_file(file.string());
  } catch (const toml::parse_error& error) {
    const auto line = error.source().begin.line;
    fail(line > 0 ? file.string() + ":" + std::to_string(line) : file.string(), "TOML", error.description(),
         "a readable file in valid TOML");
  }
}

glm::dvec3 unit(const glm::dvec3& vector) {
  // Scaled first, so that the squares of very large or small components stay within the range of a double.
  const double largest = std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
  return glm::normalize(vector / largest);
}

double field_of_view_radians(const TableReader& table) {
  if (table.has_first_of({"vertical_fov_degrees"}, {"focal_length", "film_height"})) {
    return glm::radians(table.number_between("vertical_fov_degrees", 0.0, 180.0));
  }
  const double focal_length = table.number_between("focal_length", 0.0, kLargestDouble);
  const double film_height = table.number_between("film_height", 0.0, kLargestDouble);
  return 2.0 * std::atan2(0.5 * film_height, focal_length);
}

Camera read_camera(const TableReader& table) {
  table.require_only(
      {"position", "look_at", "direction", "up", "vertical_fov_degrees", "focal_length", "film_height"});
  Camera camera;
  camera.position = table.vector("position");
  const char* const direction_key = table.has_first_of({"look_at"}, {"direction"}) ? "look_at" : "direction";
  const glm::dvec3 target = table.vector(direction_key);
  const glm::dvec3 direction = table.has("look_at") ? target - camera.position : target;
  if (direction == glm::dvec3(0.0)) {
    table.fail_at(direction_key, table.text_of(direction_key),
                  table.has("look_at") ? "a point other than camera.position" : "a vector other than zero");
  }
  camera.direction = unit(direction);

  const glm::dvec3 up = table.vector_or("up", {0.0, 1.0, 0.0});
  if (up == glm::dvec3(0.0)) table.fail_at("up", "a zero vector", "a vector not parallel to the direction");
  const glm::dvec3 side = glm::cross(camera.direction, unit(up));
  if (glm::length(side) < 1e-6) {
    table.fail_at("up", "a vector parallel to the direction",
                  "a vector that is at least 1e-6 radians off it");
  }
  camera.up = glm::normalize(glm::cross(side, camera.direction));
  camera.vertical_field_of_view_radians = field_of_view_radians(table);
  return camera;
}

/// The transform of a mesh: scale, then rotate about x, y and z, then translate.
glm::dmat4 read_transform(const TableReader& table) {
  const double scale = table.has("scale") ? table.number_between("scale", 0.0, kMaxCoordinate) : 1.0;
  const glm::dvec3 angles = glm::radians(table.vector_or("rotate_degrees", glm::dvec3(0.0)));
  glm::dmat4 transform = glm::translate(glm::dmat4(1.0), table.vector_or("translate", glm::dvec3(0.0)));
  transform = glm::rotate(transform, angles.z, {0.0, 0.0, 1.0});
  transform = glm::rotate(transform, angles.y, {0.0, 1.0, 0.0});
  transform = glm::rotate(transform, angles.x, {1.0, 0.0, 0.0});
  return glm::scale(transform, glm::dvec3(scale));
}

GltfFile load_mesh_file(const std::filesystem::path& file) {
  if (is_gltf(file)) return load_gltf(file);
  return {load_obj_mesh(file), std::nullopt};
}

Camera moved(Camera camera, const glm::dmat4& transform) {
  camera.position = glm::dvec3(transform * glm::dvec4(camera.position, 1.0));
  camera.direction = glm::normalize(glm::dmat3(transform) * camera.direction);
  camera.up = glm::normalize(glm::dmat3(transform) * camera.up);
  return camera;
}

/// Adds the mesh file that `table` names.
/// @param camera set to the file's camera if it has one and `camera` is empty
void add_mesh(const TableReader& table, const std::filesystem::path& directory, Scene& scene,
              std::optional<Camera>& camera) {
  table.require_only({"file", "scale", "rotate_degrees", "translate"});
  const bool is_moved = table.has("scale") || table.has("rotate_degrees") || table.has("translate");
  const glm::dmat4 transform = read_transform(table);
  const GltfFile file = load_mesh_file(directory / table.text("file"));
  if (file.camera && !camera) camera = moved(file.camera->camera, transform);
  const Mesh& mesh = file.mesh;
  scene.files.insert(scene.files.end(), mesh.files.begin(), mesh.files.end());
  const auto first_material = static_cast<std::int32_t>(scene.materials.size());
  scene.materials.insert(scene.materials.end(), mesh.materials.begin(), mesh.materials.end());
  scene.degenerate_triangles += mesh.degenerate_triangles;
  scene.triangles.reserve(scene.triangles.size() + mesh.triangles.size());
  for (Triangle triangle : mesh.triangles) {
    triangle.material += first_material;
    if (is_moved) {
      for (glm::dvec3& vertex : triangle.vertex) vertex = glm::dvec3(transform * glm::dvec4(vertex, 1.0));
      if (!is_in_range(triangle)) {
        table.fail_at("scale", "a transform that moves a vertex out of range",
                      "coordinates of at most 1e100");
      }
      if (is_degenerate(triangle)) {
        ++scene.degenerate_triangles;
        continue;
      }
    }
    scene.triangles.push_back(triangle);
  }
}

TableReader subtable(const toml::table& root, const std::string& file, const char* name) {
  const toml::node* node = root.get(name);
  const std::string allowed = std::string("one [") + name + "] table";
  if (node == nullptr) fail(file, name, "none", allowed);
  if (!node->is_table()) fail(file, name, "no table", allowed);
  return TableReader(file, name, *node->as_table());
}

FilmSize read_film(const toml::table& root, const std::string& file) {
  if (!root.contains("film")) return {kDefaultFilmSide, kDefaultFilmSide};
  const TableReader film = subtable(root, file, "film");
  film.require_only({"width", "height"});
  return {film.pixels("width"), film.pixels("height")};
}

std::optional<Camera> add_meshes(const toml::table& root, const std::filesystem::path& file, Scene& scene) {
  const toml::array* meshes = root.get_as<toml::array>("mesh");
  if (meshes == nullptr || meshes->empty() || !meshes->is_array_of_tables()) {
    fail(file.string(), "mesh", root.contains("mesh") ? "no array of tables" : "none",
         "one [[mesh]] table or more");
  }
  std::optional<Camera> camera;
  for (const toml::node& node : *meshes) {
    add_mesh(TableReader(file.string(), "mesh", *node.as_table()), file.parent_path(), scene, camera);
  }
  return camera;
}

void require_renderable(const Scene& scene, const std::string& file) {
  if (scene.triangles.empty()) fail(file, "mesh", "no triangle with an area", "one or more");
  const auto emits = [&scene](const Triangle& triangle) {
    return scene.materials[static_cast<std::size_t>(triangle.material)].emission != glm::dvec3(0.0);
  };
  if (std::none_of(scene.triangles.begin(), scene.triangles.end(), emits)) {
    fail(file, "mesh", "no light",
         "one triangle or more with a material that emits (OBJ: Ke, glTF: emissiveFactor)");
  }
}

/// The scene of a glTF file that is opened directly, without a scene.toml.
Scene gltf_scene(const std::filesystem::path& file) {
  GltfFile gltf = load_gltf(file);
  if (!gltf.camera) fail(file.string(), "camera", "none", "one that a node of the scene holds");
  Scene scene;
  scene.name = file.stem().string();
  scene.camera = gltf.camera->camera;
  scene.film = {kDefaultFilmSide, kDefaultFilmSide};
  const double width = kDefaultFilmSide * gltf.camera->aspect_ratio.value_or(1.0);
  scene.film.width = static_cast<int>(std::clamp(std::round(width), 1.0, double(kMaxFilmSide)));
  scene.materials = std::move(gltf.mesh.materials);
  scene.triangles = std::move(gltf.mesh.triangles);
  scene.degenerate_triangles = gltf.mesh.degenerate_triangles;
  scene.files = std::move(gltf.mesh.files);
  require_renderable(scene, file.string());
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path) {
  const std::filesystem::path file = scene_path(path);
  if (is_gltf(file)) return gltf_scene(file);
  const toml::table root = parse_toml(file);
  TableReader(file.string(), "", root).require_only({"camera", "film", "mesh"});

  Scene scene;
  scene.files = {file};
  const std::filesystem::path absolute = std::filesystem::absolute(file).lexically_normal();
  scene.name = (file.filename() == "scene.toml" ? absolute.parent_path().filename() : file.stem()).string();
  scene.film = read_film(root, file.string());
  std::optional<Camera> camera;
  if (root.contains("camera")) camera = read_camera(subtable(root, file.string(), "camera"));
  const std::optional<Camera> of_mesh = add_meshes(root, file, scene);
  if (!camera) camera = of_mesh;
  if (!camera) fail(file.string(), "camera", "none", "one [camera] table, or a mesh file that holds one");
  scene.camera = *camera;
  require_renderable(scene, file.string());
  return scene;
}

}  // namespace testbench
