#include "testbench/scene/not_shown.hpp"

#include <vector>

namespace testbench {
namespace {

struct NotShown {
  const char* text;
  bool (*has)(const Material&);
};

/// What materials have and the firmware does not render.
constexpr NotShown kNotShown[] = {
    {"a colour of a dielectric's reflection is shown as its strongest channel in grey",
     [](const Material& material) {
       const glm::dvec3& colour = material.specular_colour;
       return material.specular > 0.0 && !(colour.x == colour.y && colour.y == colour.z);
     }},
    {"a colour of transmission is left out, what passes has the base colour",
     [](const Material& material) {
       return material.transmission > 0.0 && !shows_transmission_colour(material) &&
              material.transmission_colour != material.reflectance;
     }},
};

}  // namespace

void note_what_is_not_shown(Scene& scene, const std::string& file) {
  const std::vector<bool> is_used = materials_in_use(scene.triangles, scene.materials.size());
  for (const NotShown& kind : kNotShown) {
    std::size_t times = 0;
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
      times += is_used[i] && kind.has(scene.materials[i]);
    scene.notes.add(kind.text, file, times);
  }
  scene.notes.add("the environment's image is left out", file, scene.environment.image ? 1 : 0);
  scene.notes.add("a light without area is left out", file, scene.lights.size());
}

}  // namespace testbench
