#include "testbench/mono_image/material_records.hpp"

#include <algorithm>

#include "firmware/path_tracer/materials/material.hpp"

namespace testbench {
namespace {

/// Reflectance of varnish at normal incidence (KHR_materials_specular, without the strength that multiplies
/// it): no channel is above 1.
glm::dvec3 varnish_reflectance(const Material& material) {
  return glm::min(material.specular_colour * path_tracer::reflectance_at_normal(material.ior), 1.0);
}

double strongest_channel(const glm::dvec3& colour) {
  return std::max({colour.x, colour.y, colour.z});
}

}  // namespace

path_tracer::MaterialRecord material_record(const Material& material) {
  path_tracer::MaterialRecord record;
  const glm::dvec3& colour = material.specular_colour;
  record.metallic = material.metallic;
  record.roughness = material.roughness;
  record.f90 = material.specular;
  record.f0 =
      std::min(material.specular, material.specular * path_tracer::reflectance_at_normal(material.ior) *
                                      std::max({colour.x, colour.y, colour.z}));
  record.transmission = material.transmission;
  record.ior = material.ior;
  record.thin = material.is_thin ? 1 : 0;
  return record;
}

path_tracer::VarnishTintRecord varnish_tint_record(const Material& material) {
  path_tracer::VarnishTintRecord record;
  const glm::dvec3 reflectance = varnish_reflectance(material);
  const double strongest = strongest_channel(reflectance);
  if (!(strongest > 0.0)) return record;
  record.tint = {reflectance.x / strongest, reflectance.y / strongest, reflectance.z / strongest};
  return record;
}

bool has_varnish_tint(const Material& material) {
  const auto& tint = varnish_tint_record(material).tint;
  return material.specular > 0.0 && !(tint.x == 1.0 && tint.y == 1.0 && tint.z == 1.0);
}

path_tracer::TransmissionTintRecord transmission_tint_record(const Material& material) {
  const glm::dvec3& colour = material.transmission_colour;
  return {{colour.x, colour.y, colour.z}, has_transmission_tint(material) ? 0 : 1};
}

bool has_transmission_tint(const Material& material) {
  return material.transmission > 0.0 && !shows_transmission_colour(material) &&
         material.transmission_colour != material.reflectance;
}

}  // namespace testbench
