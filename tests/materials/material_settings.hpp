#pragma once

#include "tests/materials/material_bench.hpp"

/// Materials of every kind, for tests that hold for all of them.
namespace test_support {

struct Setting {
  const char* name;
  path_tracer::Lobes lobes;
  MonoMaterial material;
};

inline path_tracer::Lobes lobes_of(std::initializer_list<bool path_tracer::Lobes::*> members) {
  path_tracer::Lobes lobes;
  for (bool path_tracer::Lobes::*member : members) lobes.*member = true;
  return lobes;
}

inline path_tracer::Lobes every_lobe() {
  using path_tracer::Lobes;
  return lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::mirror, &Lobes::glass, &Lobes::rough_glass,
                   &Lobes::thin_glass, &Lobes::coat, &Lobes::sheen});
}

inline MonoMaterial metal(double roughness) {
  MonoMaterial material;
  material.metallic = 1;
  material.roughness = roughness;
  material.base_color = {0.9, 0.6, 0.3};
  return material;
}

inline MonoMaterial varnish(double roughness) {
  MonoMaterial material;
  material.roughness = roughness;
  material.base_color = {0.2, 0.5, 0.8};
  return material;
}

inline MonoMaterial glass(double roughness, double eta) {
  MonoMaterial material;
  material.transmission = 1;
  material.roughness = roughness;
  material.eta = eta;
  material.base_color = {0.9, 1, 0.8};
  return material;
}

inline MonoMaterial thin(double roughness) {
  MonoMaterial material = glass(roughness, 1.5);
  material.thin = true;
  return material;
}

inline MonoMaterial with_coat(MonoMaterial material, double coat, double roughness) {
  material.coat = coat;
  material.coat_roughness = roughness;
  return material;
}

inline MonoMaterial with_sheen(MonoMaterial material, double roughness) {
  material.sheen_color = {0.7, 0.5, 0.9};
  material.sheen_roughness = roughness;
  return material;
}

/// A bit of everything, so that every lobe is sampled.
inline MonoMaterial mixture(double roughness) {
  MonoMaterial material = with_sheen(with_coat(varnish(roughness), 0.6, 0.4), 0.6);
  material.metallic = 0.3;
  material.transmission = 0.4;
  return material;
}

inline std::vector<Setting> material_settings() {
  using path_tracer::Lobes;
  const Lobes glossy = lobes_of({&Lobes::glossy});
  const Lobes plastic = lobes_of({&Lobes::diffuse, &Lobes::glossy});
  const Lobes frosted = lobes_of({&Lobes::rough_glass});
  const Lobes coated = lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::coat});
  std::vector<Setting> all = {
      {"diffuse", lobes_of({&Lobes::diffuse}), varnish(0.5)},
      {"varnish over diffuse, smooth", lobes_of({&Lobes::diffuse, &Lobes::mirror}), varnish(0)},
      {"varnish, roughness 0.2", plastic, varnish(0.2)},
      {"varnish, roughness 0.7", plastic, varnish(0.7)},
      {"half metal", plastic, mixture(0.5)},
      {"glass into a dense medium, 0.4", frosted, glass(0.4, 1.5)},
      {"glass into a dense medium, 0.8", frosted, glass(0.8, 1.5)},
      {"glass out of a dense medium, 0.4", frosted, glass(0.4, 1 / 1.5)},
      {"glass out of a dense medium, 1", frosted, glass(1, 1 / 1.5)},
      {"diamond", frosted, glass(0.6, 2.4)},
      {"nearly no boundary", frosted, glass(0.9, 1.2)},
      {"thin frosted sheet, 0.4", lobes_of({&Lobes::rough_glass, &Lobes::thin_glass}), thin(0.4)},
      {"thin frosted sheet, 0.9", lobes_of({&Lobes::rough_glass, &Lobes::thin_glass}), thin(0.9)},
      {"coat, rough, over metal", coated, with_coat(metal(0.5), 1, 0.4)},
      {"coat, smooth, over varnish", coated, with_coat(varnish(0.4), 0.8, 0)},
      {"coat over diffuse alone", lobes_of({&Lobes::diffuse, &Lobes::coat}), with_coat(varnish(0.4), 1, 0.3)},
      {"sheen alone", lobes_of({&Lobes::sheen}), with_sheen(varnish(1), 0.3)},
      {"sheen over diffuse", lobes_of({&Lobes::diffuse, &Lobes::sheen}), with_sheen(varnish(1), 0.5)},
      {"sheen over a mirror", lobes_of({&Lobes::mirror, &Lobes::sheen}), with_sheen(metal(0), 0.5)},
      {"every lobe, rough", every_lobe(), mixture(0.5)},
      {"every lobe, smooth", every_lobe(), mixture(0)},
  };
  for (const double roughness : {0.1, 0.25, 0.5, 0.75, 1.0})
    all.push_back({"metal", glossy, metal(roughness)});
  return all;
}

/// From the zenith to grazing.
inline constexpr double kViewerCosines[] = {1, 0.6, 0.1, 0.02};

inline MonoPoint seen_at(double cosine) {
  const Vector normal = unit({1, 2, -3});
  const Vector tangent = unit(cross(normal, Vector{0.3, 0.1, 1}));
  return {normal, normal * cosine + tangent * std::sqrt(1 - cosine * cosine), normal};
}

}  // namespace test_support
