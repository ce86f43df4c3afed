#pragma once

#include "firmware/path_tracer/records/features.hpp"
#include "firmware/path_tracer/sampling/sampling.hpp"

/// What a BSDF is evaluated from, and what a program is built for.
namespace path_tracer {

/// Red, green, blue.
using Rgb = vec3<poly<double>>;

/// How a program evaluates its materials; mono.
struct BsdfConfig {
  Lobes lobes;
  /// Shading normals differ from geometric ones. Without it the geometric normal is not looked at.
  bool shading_normals = false;
  /// Samples of purely diffuse materials get their density. All others have one anyway.
  bool diffuse_pdf = false;
  /// The control unit skips specular lobes, coat and sheen where no PE's material has them.
  bool skips_absent_lobes = false;
};

/// The material at a hit, after textures, as seen from the side that the ray arrives from. Fields of lobes
/// that the program lacks are not read. Colours and shares are in [0, 1].
struct Material {
  Rgb base_color;               ///< diffuse reflectance, reflectance of metal, colour of transmission
  poly<double> metallic;        ///< share of metal
  poly<double> roughness;       ///< square root of GGX's width alpha
  poly<double> f0;              ///< reflectance of what is not metal at normal incidence, opaque part
  poly<double> f90;             ///< the same at grazing incidence: 1, or 0 for a purely diffuse surface
  poly<double> transmission;    ///< share of the rest that is transmissive
  poly<double> eta;             ///< refractive index behind the surface / on the ray's side; positive
  mask thin;                    ///< transmits without refraction; eta is the sheet's, seen from either side
  poly<double> coat;            ///< weight of the clear coat
  poly<double> coat_roughness;  ///< square root of its alpha
  Rgb sheen_color;
  poly<double> sheen_roughness;  ///< square root of the width of sheen's distribution
  Rgb varnish_tint;              ///< factor of f0, whose strongest channel is 1
  Rgb transmission_color;        ///< in place of base_color, for what passes
};

/// Factor of what a transmissive surface lets through.
inline const Rgb& transmission_color(const Lobes& lobes, const Material& material) {
  return lobes.transmission_tint ? material.transmission_color : material.base_color;
}

/// Reflectance at normal incidence of a material with this index of refraction. Index 0 stands for total
/// reflection (KHR_materials_ior).
inline double reflectance_at_normal(double index_of_refraction) {
  const double root = (index_of_refraction - 1.0) / (index_of_refraction + 1.0);
  return root * root;
}

/// GGX narrower than this is a mirror, which reflects into a single direction.
inline constexpr double kSmoothAlpha = 1e-4;

/// Cosines at least this large keep every quotient finite. Directions closer to the surface get no light.
inline constexpr double kLeastCosine = 1e-12;

inline poly<double> clamp_cosine(const poly<double>& cosine) {
  return cn::min(cn::max(cosine, poly<double>(kLeastCosine)), poly<double>(1.0));
}

/// Keeps a divisor or the argument of a root that cannot be negative from being 0.
inline poly<double> keep_positive(const poly<double>& value) {
  return cn::max(value, poly<double>(1e-60));
}

/// Adds terms of which a program has some: the first costs no instruction.
class Sum {
 public:
  void add(const poly<double>& term) {
    total_.assign_all_lanes(empty_ ? term : total_ + term);
    empty_ = false;
  }
  const poly<double>& total() const { return total_; }

 private:
  poly<double> total_ = 0.0;
  bool empty_ = true;
};

class RgbSum {
 public:
  void add(const Rgb& term) { x_.add(term.x), y_.add(term.y), z_.add(term.z); }
  Rgb total() const { return {x_.total(), y_.total(), z_.total()}; }

 private:
  Sum x_, y_, z_;
};

}  // namespace path_tracer
