#include "testbench/scene_file/scene_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <string>

#include "testbench/files/input_file.hpp"
#include "testbench/files/text_lines.hpp"
#include "testbench/scene/coincident_triangles.hpp"
#include "testbench/scene/default_view.hpp"
#include "testbench/scene/gltf_mesh.hpp"
#include "testbench/scene/normalise.hpp"
#include "testbench/scene/not_shown.hpp"
#include "testbench/scene/obj_mesh.hpp"
#include "testbench/scene/ply_mesh.hpp"
#include "testbench/scene/repeated_triangles.hpp"
#include "testbench/scene_file/table_reader.hpp"
#include "testbench/scene_file/toml_light.hpp"
#include "testbench/scene_file/toml_material.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/nesting.hpp"

namespace testbench {
namespace {

bool has_suffix(const std::filesystem::path& file, std::initializer_list<const char*> suffixes) {
  const std::string suffix = lower_case(file.extension().string());
  return std::find(suffixes.begin(), suffixes.end(), suffix) != suffixes.end();
}

bool is_gltf(const std::filesystem::path& file) {
  return has_suffix(file, {".gltf", ".glb"});
}

bool is_ply(const std::filesystem::path& file) {
  return has_suffix(file, {".ply"});
}

constexpr const char* kSceneFiles =
    "a directory that holds scene.toml, or a .toml, .obj, .ply, .gltf or .glb file";

std::filesystem::path scene_path(const std::filesystem::path& scene) {
  std::error_code error;
  std::filesystem::path file = std::filesystem::is_directory(scene, error) ? scene / "scene.toml" : scene;
  if (!std::filesystem::is_regular_file(file, error)) {
    fail_at_key(scene.string(), "scene", "no file " + file.string(), kSceneFiles);
  }
  if (!has_suffix(file, {".toml", ".obj", ".ply", ".gltf", ".glb"})) {
    fail_at_key(scene.string(), "scene", "a file named " + file.filename().string(), kSceneFiles);
  }
  return file;
}

toml::table parse_toml(const std::filesystem::path& file) {
  const std::string text = read_input_file(file, "a readable TOML file", kMostTomlBytes);
  require_shallow_toml(text, file.string());
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    const auto line = error.source().begin.line;
    fail_at_key(line > 0 ? file.string() + ":" + std::to_string(line) : file.string(), "TOML",
                error.description(), "a readable file in valid TOML");
  }
}

glm::dvec3 unit(const glm::dvec3& vector) {
  // Scaled first, so that the squares of very large or small components stay within the range of a double.
  const double largest = std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
  return glm::normalize(vector / largest);
}

/// What part of the scene the picture shows: an angle, or a height in parallel rays.
void read_projection(const TableReader& table, Camera& camera) {
  switch (
      table.group_of({{"vertical_fov_degrees"}, {"focal_length", "film_height"}, {"orthographic_height"}})) {
    case 0:
      camera.vertical_field_of_view_radians =
          glm::radians(table.number_between("vertical_fov_degrees", 0.0, 180.0));
      return;
    case 1: {
      const double focal_length = table.number_between("focal_length", 0.0, kLargestDouble);
      const double film_height = table.number_between("film_height", 0.0, kLargestDouble);
      camera.vertical_field_of_view_radians = 2.0 * std::atan2(0.5 * film_height, focal_length);
      return;
    }
    default:
      camera.orthographic_height = table.number_between("orthographic_height", 0.0, kMaxCoordinate);
  }
}

Camera read_camera(const TableReader& table) {
  table.require_only({"position", "look_at", "direction", "up", "vertical_fov_degrees", "focal_length",
                      "film_height", "orthographic_height"});
  Camera camera;
  camera.position = table.vector("position");
  const char* const direction_key =
      table.group_of({{"look_at"}, {"direction"}}) == 0 ? "look_at" : "direction";
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
  read_projection(table, camera);
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

GltfFile load_mesh_file(const std::filesystem::path& file, const MeshOptions& options) {
  if (is_gltf(file)) return load_gltf(file, options);
  return {is_ply(file) ? load_ply_mesh(file, options) : load_obj_mesh(file, options), std::nullopt};
}

/// The material that faces without one get.
std::optional<Material> read_material(const TableReader& mesh, const TextureFiles& files) {
  if (!mesh.has("material")) return std::nullopt;
  if (is_gltf(mesh.text("file")))
    mesh.fail_at("material", "a material for a glTF file",
                 "one for OBJ and PLY files; glTF has a default of its own");
  return read_toml_material(mesh.table("material"), files);
}

Camera moved(Camera camera, const glm::dmat4& transform) {
  camera.position = glm::dvec3(transform * glm::dvec4(camera.position, 1.0));
  // Without the power of two in the scale, whose square may vanish or overflow.
  const glm::dvec3 first(transform[0]);
  const double largest = std::max({std::abs(first.x), std::abs(first.y), std::abs(first.z)});
  const int exponent = std::max(std::ilogb(largest), -1000);
  const glm::dmat3 axes = glm::dmat3(transform) * std::ldexp(1.0, -exponent);
  camera.direction = glm::normalize(axes * camera.direction);
  const glm::dvec3 up = axes * camera.up;
  camera.up = glm::normalize(up);
  if (camera.orthographic_height) *camera.orthographic_height *= std::ldexp(glm::length(up), exponent);
  return camera;
}

/// What a triangle's corners have, when its mesh is moved.
TriangleAttributes moved(TriangleAttributes attributes, const glm::dmat4& transform) {
  const glm::dmat3 of_normals = normal_transform(glm::dmat3(transform));
  if (attributes.normals)
    for (glm::dvec3& normal : *attributes.normals) normal = unit_or_zero(of_normals * normal);
  if (attributes.tangents) attributes.tangents = moved_tangents(*attributes.tangents, glm::dmat3(transform));
  return attributes;
}

/// The name of the camera that the scene wants of a mesh file.
std::optional<std::string> read_camera_name(const TableReader& mesh) {
  if (!mesh.has("camera")) return std::nullopt;
  if (!is_gltf(mesh.text("file")))
    mesh.fail_at("camera", "a camera of a file without cameras", "one of a glTF file, by its name");
  return mesh.text("camera");
}

/// Adds the mesh file that `table` names.
/// @param camera set to the file's camera if it has one and `camera` is empty
void add_mesh(const TableReader& table, const std::filesystem::path& directory, const FileReach& reach,
              const std::shared_ptr<TextureStore>& textures, Scene& scene, std::optional<Camera>& camera) {
  table.require_only({"file", "scale", "rotate_degrees", "translate", "material", "camera"});
  const bool is_moved = table.has("scale") || table.has("rotate_degrees") || table.has("translate");
  const glm::dmat4 transform = read_transform(table);
  const std::filesystem::path mesh_file = directory / table.text("file");
  reach.require(mesh_file, table.where_is("file") + ": mesh.file");
  const GltfFile file = load_mesh_file(mesh_file, {reach, read_material(table, {directory, reach, *textures}),
                                                   read_camera_name(table), textures, true});
  if (file.camera && !camera) camera = moved(file.camera->camera, transform);
  const Mesh& mesh = file.mesh;
  const auto first_material = static_cast<std::int32_t>(scene.materials.size());
  scene.materials.insert(scene.materials.end(), mesh.materials.begin(), mesh.materials.end());
  scene.degenerate_triangles += mesh.degenerate_triangles;
  scene.notes.add(mesh.notes);
  scene.triangles.reserve(scene.triangles.size() + mesh.triangles.size());
  for (const Light& light : mesh.lights) {
    scene.lights.push_back(moved(light, transform));
    if (!is_point_in_range(scene.lights.back().position))
      table.fail_at("scale", "a transform that moves a light out of range", "coordinates of at most 1e100");
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle triangle = mesh.triangles[i];
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
    if (!mesh.corners.is_empty())
      set_corner_attributes(scene.corners, scene.triangles.size(),
                            moved(corner_attributes_of(mesh.corners, i), transform));
    scene.triangles.push_back(triangle);
  }
}

TableReader subtable(const toml::table& root, const std::string& file, const char* name) {
  const toml::node* node = root.get(name);
  const std::string allowed = std::string("one [") + name + "] table";
  if (node == nullptr) fail_at_key(file, name, "none", allowed);
  if (!node->is_table()) fail_at_key(file, name, "no table", allowed);
  return TableReader(file, name, *node->as_table());
}

FilmSize read_film(const toml::table& root, const std::string& file) {
  if (!root.contains("film")) return {kDefaultFilmSide, kDefaultFilmSide};
  const TableReader film = subtable(root, file, "film");
  film.require_only({"width", "height"});
  return {film.pixels("width"), film.pixels("height")};
}

/// Adds all mesh files of a scene.toml. Returns the first camera that one of them holds.
std::optional<Camera> add_meshes(const toml::table& root, const std::filesystem::path& file,
                                 bool is_outside_allowed, Scene& scene) {
  const toml::array* meshes = root.get_as<toml::array>("mesh");
  if (meshes == nullptr || meshes->empty() || !meshes->is_array_of_tables()) {
    fail_at_key(file.string(), "mesh", root.contains("mesh") ? "no array of tables" : "none",
                "one [[mesh]] table or more");
  }
  const FileReach reach(file.parent_path(), is_outside_allowed);
  const auto textures = std::make_shared<TextureStore>();
  std::optional<Camera> camera;
  for (const toml::node& node : *meshes)
    add_mesh(TableReader(file.string(), "mesh", *node.as_table()), file.parent_path(), reach, textures, scene,
             camera);
  scene.textures = textures->take();
  read_toml_lights(root, file, reach, scene);
  scene.files.insert(scene.files.end(), reach.files().begin(), reach.files().end());
  return camera;
}

/// In the scene's normal unit (normalise.hpp) the camera, too, has coordinates that are allowed.
void require_camera_in_reach(const Scene& scene, const std::filesystem::path& file) {
  const Camera& camera = scene.camera;
  const double farthest = std::max({std::abs(camera.position.x), std::abs(camera.position.y),
                                    std::abs(camera.position.z), camera.orthographic_height.value_or(0.0)});
  if (farthest / largest_coordinate(scene) <= kMaxCoordinate) return;
  fail_at_key(file.string(), "camera", "a position or height that is too large for the meshes",
              "at most 1e100 times the largest coordinate of a mesh");
}

void add_light_with_note(Scene& scene, const std::filesystem::path& file) {
  add_default_light(scene);
  scene.notes.add("no triangle emits, so a square light above and behind the camera is added", file.string());
}

/// The scene of a mesh file that is opened directly, without a scene.toml.
Scene mesh_scene(const std::filesystem::path& file, bool is_outside_allowed) {
  const FileReach reach(file.parent_path(), is_outside_allowed);
  const MeshOptions options{reach, std::nullopt};
  GltfFile mesh_file = load_mesh_file(file, options);
  Scene scene;
  scene.files = reach.files();
  scene.files.push_back(file);
  scene.name = file.stem().string();
  scene.film = {kDefaultFilmSide, kDefaultFilmSide};
  scene.materials = std::move(mesh_file.mesh.materials);
  scene.triangles = std::move(mesh_file.mesh.triangles);
  scene.corners = std::move(mesh_file.mesh.corners);
  scene.lights = std::move(mesh_file.mesh.lights);
  scene.textures = options.textures->take();
  scene.degenerate_triangles = mesh_file.mesh.degenerate_triangles;
  scene.notes = std::move(mesh_file.mesh.notes);
  if (mesh_file.camera) {
    scene.camera = mesh_file.camera->camera;
    const double width = kDefaultFilmSide * mesh_file.camera->aspect_ratio.value_or(1.0);
    scene.film.width = static_cast<int>(std::clamp(std::round(width), 1.0, double(kMaxFilmSide)));
  } else {
    scene.camera = framing_camera(scene);
    scene.notes.add("no camera, so one that sees the whole mesh is used", file.string());
  }
  return scene;
}

/// The scene of a scene.toml.
Scene toml_scene(const std::filesystem::path& file, bool is_outside_allowed) {
  const toml::table root = parse_toml(file);
  TableReader(file.string(), "", root).require_only({"camera", "film", "mesh", "environment", "light"});

  Scene scene;
  scene.files = {file};
  const std::filesystem::path absolute = std::filesystem::absolute(file).lexically_normal();
  scene.name = (file.filename() == "scene.toml" ? absolute.parent_path().filename() : file.stem()).string();
  scene.film = read_film(root, file.string());
  std::optional<Camera> camera;
  if (root.contains("camera")) camera = read_camera(subtable(root, file.string(), "camera"));
  const std::optional<Camera> camera_of_mesh = add_meshes(root, file, is_outside_allowed, scene);
  if (!camera) camera = camera_of_mesh;
  if (!camera)
    fail_at_key(file.string(), "camera", "none", "one [camera] table, or a mesh file that holds one");
  scene.camera = *camera;
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, bool is_outside_allowed) {
  const std::filesystem::path file = scene_path(path);
  Scene scene = has_suffix(file, {".toml"}) ? toml_scene(file, is_outside_allowed)
                                            : mesh_scene(file, is_outside_allowed);
  if (scene.triangles.empty()) fail_at_key(file.string(), "mesh", "no triangle with an area", "one or more");
  require_camera_in_reach(scene, file);
  if (!has_light(scene)) add_light_with_note(scene, file);
  complete_corner_attributes(scene.corners, scene.triangles.size());
  scene.notes.add("a triangle without area is left out", file.string(), scene.degenerate_triangles);
  scene.notes.add("a triangle that repeats another one is left out", file.string(),
                  remove_repeated_triangles(scene));
  order_coincident_triangles(scene, file.string());
  keep_used_textures(scene);
  note_what_is_not_shown(scene, file.string());
  return scene;
}

}  // namespace testbench
