#include "testbench/material/mtl_surface.hpp"

#include <cmath>

namespace testbench {
namespace {

// Illumination models of MTL.
constexpr int kLambert = 1;     // and 0, colour alone
constexpr int kRefraction = 6;  // refraction, Fresnel off
constexpr int kFresnelRefraction = 7;

void set_glass(const MtlSurface& surface, double opacity, Material& material) {
  material.transmission = opacity < 1.0 ? 1.0 - opacity : 1.0;
  material.transmission_colour = surface.transmission_colour.value_or(glm::dvec3(1.0));
  material.is_thin = false;
  material.ior = surface.ior.value_or(1.5);
  material.specular = 1.0;
  material.roughness = surface.roughness.value_or(0.0);
}

void set_reflection(const MtlSurface& surface, Material& material) {
  const double phong_roughness = roughness_of_phong(surface.phong_exponent.value_or(0.0));
  if (surface.roughness || surface.metallic) {
    material.specular = 1.0;
    material.roughness = surface.roughness.value_or(phong_roughness);
    material.metallic = surface.metallic.value_or(0.0);
  } else if (surface.specular_colour.value_or(glm::dvec3(0.0)) != glm::dvec3(0.0) &&
             surface.illumination_model > kLambert) {
    material.specular = 1.0;
    material.specular_colour = *surface.specular_colour / kDefaultSpecularReflectance;
    material.roughness = phong_roughness;
  }
}

}  // namespace

double roughness_of_phong(double exponent) {
  return std::sqrt(std::sqrt(2.0 / (exponent + 2.0)));
}

void set_mtl_surface(const MtlSurface& surface, Material& material) {
  const double opacity = surface.opacity.value_or(1.0 - surface.transparency.value_or(0.0));
  if (surface.illumination_model == kRefraction || surface.illumination_model == kFresnelRefraction) {
    set_glass(surface, opacity, material);
  } else {
    set_reflection(surface, material);
    if (opacity < 1.0) {
      material.alpha_mode = AlphaMode::blend;
      material.alpha = opacity;
    }
  }
  material.sheen_colour = glm::dvec3(surface.sheen.value_or(0.0));
  material.sheen_roughness = surface.sheen ? material.roughness : 0.0;
  material.clearcoat = surface.clearcoat.value_or(0.0);
  material.clearcoat_roughness = surface.clearcoat_roughness.value_or(0.0);
}

}  // namespace testbench
