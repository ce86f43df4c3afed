#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "testbench/material/material.hpp"

namespace testbench {

/// What an MTL file says of a surface besides Kd, Ke and textures.
struct MtlSurface {
  std::optional<glm::dvec3> specular_colour;      ///< Ks
  std::optional<double> phong_exponent;           ///< Ns
  std::optional<double> ior;                      ///< Ni
  std::optional<double> opacity;                  ///< d
  std::optional<double> transparency;             ///< Tr, which is 1 - d
  std::optional<glm::dvec3> transmission_colour;  ///< Tf
  std::optional<double> roughness;                ///< Pr
  std::optional<double> metallic;                 ///< Pm
  std::optional<double> sheen;                    ///< Ps
  std::optional<double> clearcoat;                ///< Pc
  std::optional<double> clearcoat_roughness;      ///< Pcr
  int illumination_model = 2;                     ///< illum
};

/// The roughness whose GGX lobe is about as wide as a Phong lobe: alpha^2 = 2 / (exponent + 2), and alpha is
/// the square of the roughness. Source of the first: Walter et al., "Microfacet Models for Refraction through
/// Rough Surfaces", EGSR 2007, section 5.2 (Phong's exponent of a Beckmann lobe).
double roughness_of_phong(double exponent);

/// Sets the fields of `material` that `surface` asks for; docs/how-to/materials.md has the mapping.
void set_mtl_surface(const MtlSurface& surface, Material& material);

}  // namespace testbench
