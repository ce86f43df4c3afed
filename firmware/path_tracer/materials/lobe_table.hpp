#pragma once

#include <array>
#include <string_view>

#include "firmware/path_tracer/materials/material.hpp"

namespace path_tracer {

/// The parts of shading that a program issues as a whole. Facets, coat and sheen are skipped where no PE asks
/// for them (BsdfConfig::skips_absent_lobes).
enum class LobePart {
  always,  ///< issued for every block
  facets,  ///< metal, varnish and dielectric, rough and smooth
  coat,
  sheen,
  none,  ///< a factor of another lobe
};

/// A lobe for pages, reports and messages: its name, what it is, and what a scene file must say for a
/// material to have it.
struct LobeDescription {
  std::string_view name;
  bool Lobes::*member;
  LobePart part;
  std::string_view meaning;
  std::string_view gltf;
  std::string_view mtl;
};

/// The one list of lobes. A lobe is added here, to Lobes and to bsdf*.hpp (docs/how-to/add-a-material.md).
inline constexpr std::array<LobeDescription, 11> kLobeTable = {{
    {"diffuse", &Lobes::diffuse, LobePart::always, "Lambertian reflection below the specular one",
     "metallicFactor < 1, not fully transmissive", "Kd"},
    {"glossy", &Lobes::glossy, LobePart::facets,
     "GGX reflection by metal or varnish, with the light scattered several times", "roughnessFactor > 0.01",
     "Ks with Ns, or Pm with Pr"},
    {"mirror", &Lobes::mirror, LobePart::facets, "reflection into one direction", "roughnessFactor <= 0.01",
     "illum 3, 5, or Pr 0"},
    {"glass", &Lobes::glass, LobePart::facets, "reflection and refraction into one direction each",
     "KHR_materials_transmission, roughnessFactor <= 0.01", "illum 4, 6, 7 with Ni, Tf"},
    {"rough_glass", &Lobes::rough_glass, LobePart::facets, "GGX reflection and refraction",
     "KHR_materials_transmission, roughnessFactor > 0.01", "illum 6, 7 with Pr"},
    {"thin_glass", &Lobes::thin_glass, LobePart::facets,
     "either glass as a thin sheet: transmission without refraction",
     "KHR_materials_transmission without KHR_materials_volume", "illum 4, 6, 7 with Ni 1"},
    {"coat", &Lobes::coat, LobePart::coat, "clear coat of index 1.5 above all but itself",
     "KHR_materials_clearcoat", "Pc, Pcr"},
    {"sheen", &Lobes::sheen, LobePart::sheen, "fibres that stand off, seen at grazing angles",
     "KHR_materials_sheen", "Ps"},
    {"absorption", &Lobes::absorption, LobePart::always, "coloured loss within a transmissive body",
     "KHR_materials_volume", "none"},
    {"varnish_tint", &Lobes::varnish_tint, LobePart::none,
     "colour of varnish's reflection at normal incidence", "KHR_materials_specular, specularColorFactor",
     "Ks"},
    {"transmission_tint", &Lobes::transmission_tint, LobePart::none,
     "colour of what passes, where some passes and it is not the base colour", "none", "Tf with d"},
}};

}  // namespace path_tracer
