#pragma once

#include <array>
#include <string_view>

#include "firmware/path_tracer/materials/material.hpp"

namespace path_tracer {

/// A lobe for pages, reports and messages: its name, what it is, and what a scene file must say for a
/// material to have it.
struct LobeDescription {
  std::string_view name;
  bool Lobes::*member;
  std::string_view meaning;
  std::string_view gltf;
  std::string_view mtl;
};

/// The one list of lobes. A lobe is added here, to Lobes and to bsdf*.hpp (docs/how-to/add-a-material.md).
inline constexpr std::array<LobeDescription, 11> kLobeTable = {{
    {"diffuse", &Lobes::diffuse, "Lambertian reflection below the specular one",
     "metallicFactor < 1, not fully transmissive", "Kd"},
    {"glossy", &Lobes::glossy, "GGX reflection by metal or varnish, with the light scattered several times",
     "roughnessFactor > 0.01", "Ks with Ns, or Pm with Pr"},
    {"mirror", &Lobes::mirror, "reflection into one direction", "roughnessFactor <= 0.01",
     "illum 3, 5, or Pr 0"},
    {"glass", &Lobes::glass, "reflection and refraction into one direction each",
     "KHR_materials_transmission, roughnessFactor <= 0.01", "illum 4, 6, 7 with Ni, Tf"},
    {"rough_glass", &Lobes::rough_glass, "GGX reflection and refraction",
     "KHR_materials_transmission, roughnessFactor > 0.01", "illum 6, 7 with Pr"},
    {"thin_glass", &Lobes::thin_glass, "either glass as a thin sheet: transmission without refraction",
     "KHR_materials_transmission without KHR_materials_volume", "illum 4, 6, 7 with Ni 1"},
    {"coat", &Lobes::coat, "clear coat of index 1.5 above all but itself", "KHR_materials_clearcoat",
     "Pc, Pcr"},
    {"sheen", &Lobes::sheen, "fibres that stand off, seen at grazing angles", "KHR_materials_sheen", "Ps"},
    {"absorption", &Lobes::absorption, "coloured loss within a transmissive body", "KHR_materials_volume",
     "none"},
    {"varnish_tint", &Lobes::varnish_tint, "colour of varnish's reflection at normal incidence",
     "KHR_materials_specular, specularColorFactor", "Ks"},
    {"transmission_tint", &Lobes::transmission_tint,
     "colour of what passes, where some passes and it is not the base colour", "none", "Tf with d"},
}};

}  // namespace path_tracer
