#include "testbench/scene/gltf_light.hpp"

#include <glm/gtc/constants.hpp>

#include "testbench/gltf/gltf_schema.hpp"
#include "testbench/scene/mesh.hpp"

namespace testbench {
namespace {

constexpr const char* kLightsPunctual = "KHR_lights_punctual";

/// The light that a node names.
const nlohmann::json& gltf_light_of(const GltfDocument& document, std::size_t node, std::string& pointer) {
  const std::string of_node = "/nodes/" + std::to_string(node) + "/extensions/" + kLightsPunctual;
  const nlohmann::json& use = document.element("nodes", node)["extensions"][kLightsPunctual];
  document.check(use, "node.KHR_lights_punctual", of_node);
  const nlohmann::json* const lights = find_gltf(document.root(), "extensions", kLightsPunctual, "lights");
  const std::size_t size = lights == nullptr || !lights->is_array() ? 0 : lights->size();
  const auto index = use["light"].get<std::size_t>();
  if (index >= size)
    document.fail(of_node + "/light", "light " + std::to_string(index),
                  size == 0 ? "none, the file holds no light" : "0 to " + std::to_string(size - 1));
  pointer = std::string("/extensions/") + kLightsPunctual + "/lights/" + std::to_string(index);
  return (*lights)[index];
}

void read_gltf_cone(const GltfDocument& document, const nlohmann::json& source, const std::string& pointer,
                    Light& light) {
  const nlohmann::json spot = source.value("spot", nlohmann::json::object());
  light.inner_cone_radians = spot.value("innerConeAngle", 0.0);
  light.outer_cone_radians = spot.value("outerConeAngle", glm::quarter_pi<double>());
  if (!(light.inner_cone_radians < light.outer_cone_radians))
    document.fail(pointer + "/spot", "an inner cone no smaller than the outer one", "a smaller one");
}

void place_gltf_light(const GltfDocument& document, std::size_t node, const glm::dmat4& transform,
                      Light& light) {
  const std::string where = document.named("nodes", "node", node);
  light.position = glm::dvec3(transform[3]);
  light.direction = unit_or_zero(-glm::dvec3(transform[2]));
  if (light.direction == glm::dvec3(0.0))
    document.fail(where, "a light in a transform without volume", "one with");
  if (!is_point_in_range(light.position))
    document.fail(where, "a light too far away", "coordinates of at most 1e100");
}

}  // namespace

Light read_gltf_light(GltfDocument& document, std::size_t node, const glm::dmat4& transform) {
  std::string pointer;
  const nlohmann::json& source = gltf_light_of(document, node, pointer);
  document.check(source, "KHR_lights_punctual.light", pointer);
  Light light;
  light.name = source.value("name", "");
  const std::string type = source.at("type").get<std::string>();
  light.kind = type == "point" ? LightKind::point : type == "spot" ? LightKind::spot : LightKind::directional;
  light.intensity = glm::dvec3(source.value("intensity", 1.0));
  if (const nlohmann::json* const colour = find_gltf(source, "color"))
    for (int channel = 0; channel < 3; ++channel)
      light.intensity[channel] *= (*colour)[std::size_t(channel)].get<double>();
  if (light.kind == LightKind::spot) read_gltf_cone(document, source, pointer, light);
  if (source.contains("range")) document.note("the range of a light is left out", pointer);
  place_gltf_light(document, node, transform, light);
  return light;
}

}  // namespace testbench
