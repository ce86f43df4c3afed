#include "testbench/scene_file/save_scene.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/gtc/constants.hpp>
#include <sstream>
#include <string>
#include <unordered_map>

#include "testbench/files/atomic_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// The number with enough digits to be read back to the last bit.
std::string text_of(double number) {
  char text[32];
  const int length = std::snprintf(text, sizeof(text), "%.17g", number);
  return std::string(text, std::size_t(length));
}

std::string text_of(const glm::dvec3& v) {
  return text_of(v.x) + " " + text_of(v.y) + " " + text_of(v.z);
}

std::string mtl_of(const Scene& scene) {
  std::string text;
  for (const Material& material : scene.materials)
    text += "newmtl " + material.name + "\nKd " + text_of(material.reflectance) + "\nKe " +
            text_of(material.emission) + "\n";
  return text;
}

struct BitsHash {
  std::size_t operator()(const std::array<std::uint64_t, 3>& bits) const {
    return (bits[0] * 0x9e3779b97f4a7c15u) ^ (bits[1] * 0xc2b2ae3d27d4eb4fu) ^
           (bits[2] * 0x165667b19e3779f9u);
  }
};

/// The OBJ text of the scene. A vertex that several triangles share is written once.
std::string obj_of(const Scene& scene) {
  std::string text = "mtllib mesh.mtl\n";
  std::string faces;
  std::unordered_map<std::array<std::uint64_t, 3>, std::size_t, BitsHash> number_of;
  std::int32_t material = -1;
  for (const Triangle& triangle : scene.triangles) {
    if (triangle.material != material) {
      material = triangle.material;
      faces += "usemtl " + scene.materials[std::size_t(material)].name + "\n";
    }
    faces += "f";
    for (const glm::dvec3& vertex : triangle.vertex) {
      std::array<std::uint64_t, 3> bits;
      for (std::size_t axis = 0; axis < 3; ++axis)
        std::memcpy(&bits[axis], &vertex[int(axis)], sizeof(double));
      const auto [entry, is_new] = number_of.emplace(bits, number_of.size() + 1);
      if (is_new) text += "v " + text_of(vertex) + "\n";
      faces += " " + std::to_string(entry->second);
    }
    faces += "\n";
  }
  return text + faces;
}

std::string toml_of(const Scene& scene) {
  const auto vector = [](const glm::dvec3& v) { return toml::array{v.x, v.y, v.z}; };
  const Camera& camera = scene.camera;

  toml::table camera_table{{"position", vector(camera.position)},
                           {"direction", vector(camera.direction)},
                           {"up", vector(camera.up)}};
  if (camera.orthographic_height)
    camera_table.insert("orthographic_height", *camera.orthographic_height);
  else
    camera_table.insert("vertical_fov_degrees",
                        camera.vertical_field_of_view_radians * (180.0 / glm::pi<double>()));
  const toml::table table{{"camera", std::move(camera_table)},
                          {"film", toml::table{{"width", scene.film.width}, {"height", scene.film.height}}},
                          {"mesh", toml::array{toml::table{{"file", "mesh.obj"}}}}};
  std::ostringstream text;
  text << table << "\n";
  return text.str();
}

/// What the files do not hold.
Notes notes_of_saving(const Scene& scene, const std::string& where) {
  Notes notes;
  const auto rich = std::count_if(scene.materials.begin(), scene.materials.end(),
                                  [](const Material& material) { return !is_plain(material); });
  notes.add("a material is saved without what it has besides reflectance and emission", where,
            std::size_t(rich));
  notes.add("a texture is not saved", where, scene.textures.size());
  notes.add("normals and texture coordinates are not saved", where, scene.corners.is_empty() ? 0 : 1);
  notes.add("the environment is not saved", where, scene.environment.is_lit() ? 1 : 0);
  notes.add("a light without area is not saved", where, scene.lights.size());
  return notes;
}

}  // namespace

Notes save_scene(const Scene& scene, const std::filesystem::path& directory) {
  std::error_code error;
  const bool is_new = std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory))
    throw InputError(directory.string() + ": cannot be made; allowed: a directory that can be written");
  try {
    write_together({{directory / "mesh.mtl", mtl_of(scene)},
                    {directory / "mesh.obj", obj_of(scene)},
                    {directory / "scene.toml", toml_of(scene)}});
  } catch (...) {
    if (is_new) std::filesystem::remove(directory, error);  // only if it is empty
    throw;
  }
  return notes_of_saving(scene, directory.string());
}

}  // namespace testbench
