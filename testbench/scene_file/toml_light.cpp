#include "testbench/scene_file/toml_light.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include "testbench/texture/radiance_image.hpp"

namespace testbench {
namespace {

constexpr double kSunDiameterDegrees = 0.53;  // of the sun that the earth has
constexpr const char* kIntensityAllowed = "three numbers from 0 to 1e30";

glm::dmat3 rotation_of_angles(const glm::dvec3& degrees) {
  const glm::dvec3 angles = glm::radians(degrees);
  glm::dmat4 rotation = glm::rotate(glm::dmat4(1.0), angles.z, {0.0, 0.0, 1.0});
  rotation = glm::rotate(rotation, angles.y, {0.0, 1.0, 0.0});
  return glm::dmat3(glm::rotate(rotation, angles.x, {1.0, 0.0, 0.0}));
}

Environment read_environment(const TableReader& table, const std::filesystem::path& folder,
                             const FileReach& reach) {
  table.require_only({"constant", "file", "scale", "rotation_degrees"});
  Environment environment;
  if (table.group_of({{"file"}, {"constant"}}) == 1) {
    for (const char* const key : {"scale", "rotation_degrees"})
      if (table.has(key)) table.fail_at(key, "it beside constant", "it beside file");
    environment.constant = table.colour("constant", kMaxEmission, kIntensityAllowed);
    return environment;
  }
  const std::filesystem::path file = folder / table.text("file");
  reach.require(file, table.where_is("file") + ": environment.file");
  environment.image = read_radiance_image(file);
  if (table.has("scale")) environment.scale = table.number_between("scale", 0.0, kMaxEmission);
  if (table.has("rotation_degrees"))
    environment.rotation = rotation_of_angles(table.is_number("rotation_degrees")
                                                  ? glm::dvec3(0.0, table.number("rotation_degrees"), 0.0)
                                                  : table.vector("rotation_degrees"));
  return environment;
}

glm::dvec3 read_direction(const TableReader& table) {
  const glm::dvec3 direction = table.vector("direction");
  if (direction == glm::dvec3(0.0)) table.fail_at("direction", "a zero vector", "another vector");
  return unit_or_zero(direction);
}

void read_cone(const TableReader& table, Light& light) {
  const auto angle = [&](const char* key, double otherwise) {
    return glm::radians(table.has(key) ? table.number_within(key, 0.0, 90.0, "a number from 0 to 90")
                                       : otherwise);
  };
  light.outer_cone_radians = angle("outer_cone_degrees", 45.0);
  light.inner_cone_radians = angle("inner_cone_degrees", 0.0);
  if (!(light.inner_cone_radians < light.outer_cone_radians))
    table.fail_at("inner_cone_degrees", "a cone no smaller than the outer one", "a smaller one");
}

Light read_light(const TableReader& table) {
  Light light;
  light.kind = static_cast<LightKind>(table.choice("type", {"point", "spot", "directional", "sun"}));
  switch (light.kind) {
    case LightKind::point:
      table.require_only({"type", "position", "intensity"});
      break;
    case LightKind::spot:
      table.require_only(
          {"type", "position", "direction", "intensity", "outer_cone_degrees", "inner_cone_degrees"});
      read_cone(table, light);
      break;
    case LightKind::directional:
      table.require_only({"type", "direction", "irradiance"});
      break;
    case LightKind::sun:
      table.require_only({"type", "direction", "irradiance", "angular_diameter_degrees"});
      light.angular_diameter_radians = glm::radians(
          table.has("angular_diameter_degrees") ? table.number_between("angular_diameter_degrees", 0.0, 180.0)
                                                : kSunDiameterDegrees);
      break;
  }
  const bool has_position = light.kind == LightKind::point || light.kind == LightKind::spot;
  if (has_position) light.position = table.vector("position");
  if (light.kind != LightKind::point) light.direction = read_direction(table);
  light.intensity = table.colour(has_position ? "intensity" : "irradiance", kMaxEmission, kIntensityAllowed);
  return light;
}

}  // namespace

void read_toml_lights(const toml::table& root, const std::filesystem::path& file, const FileReach& reach,
                      Scene& scene) {
  const std::string name = file.string();
  if (const toml::node* const node = root.get("environment")) {
    if (!node->is_table()) fail_at_key(name, "environment", "no table", "one [environment] table");
    scene.environment =
        read_environment(TableReader(name, "environment", *node->as_table()), file.parent_path(), reach);
  }
  if (const toml::node* const node = root.get("light")) {
    const toml::array* const lights = node->as_array();
    if (lights == nullptr || !lights->is_array_of_tables())
      fail_at_key(name, "light", "no array of tables", "[[light]] tables");
    for (const toml::node& light : *lights)
      scene.lights.push_back(read_light(TableReader(name, "light", *light.as_table())));
  }
}

Light moved(Light light, const glm::dmat4& transform) {
  light.position = glm::dvec3(transform * glm::dvec4(light.position, 1.0));
  light.direction = unit_or_zero(glm::dmat3(transform) * light.direction);
  return light;
}

}  // namespace testbench
