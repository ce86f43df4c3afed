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
    {"a colour or strength of reflection is left out where light passes",
     [](const Material& material) {
       return material.transmission > 0.0 &&
              (material.specular != 1.0 || material.specular_colour != glm::dvec3(1.0));
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
}

}  // namespace testbench
