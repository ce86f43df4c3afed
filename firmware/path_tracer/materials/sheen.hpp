#pragma once

#include "firmware/path_tracer/materials/albedo.hpp"

/// Sheen (KHR_materials_sheen): the distribution of Estevez and Kulla, "Production Friendly Microfacet Sheen
/// BRDF", Sony Pictures Imageworks 2017, with the visibility that the extension calls simple.
namespace path_tracer {

/// Narrower sheen reflects more than it gets unless it is scaled down so far that little remains.
inline constexpr double kLeastSheenRoughness = 0.2;

namespace sheen_detail {

/// Albedo in cos / (cos + 0.1) and 1 / roughness; fitted as those of albedo.hpp over roughness in [0.2, 1].
inline constexpr Polynomial2<7, 4> kAlbedo = {{
    {0.408580408, 0.174197134, 0.0543490021, -0.00470939115},
    {-0.0957448177, 0.280164509, -0.402863379, 0.0432933771},
    {-3.80873775, -0.658385602, 2.81857645, -0.434746965},
    {24.9455187, -2.1474177, -11.9446109, 2.02315858},
    {-62.1573394, 7.70576145, 25.9920897, -4.53565182},
    {66.5879255, -5.59244912, -28.4663733, 4.90697907},
    {-25.5737767, -0.637876529, 12.3247676, -2.03902288},
}};

}  // namespace sheen_detail

struct Sheen {
  poly<double> exponent;  ///< of the squared sine
  poly<double> scale;     ///< of the distribution
  PolyCoefficients<7> albedo;
};

inline Sheen sheen_of(const poly<double>& roughness) {
  const poly<double> inverse = 1.0 / cn::max(roughness, poly<double>(kLeastSheenRoughness));
  const poly<double> inverse_alpha = inverse * inverse;
  return {inverse_alpha * 0.5, (2.0 + inverse_alpha) * (1.0 / (2.0 * kPi)),
          insert_y(sheen_detail::kAlbedo, inverse)};
}

/// Albedo of white sheen before it is scaled down: above 1 at grazing incidence where sheen is narrow.
inline poly<double> raw_sheen_albedo(const Sheen& sheen, const poly<double>& cosine) {
  return cn::max(value_at(sheen.albedo, cosine / (cosine + 0.1)), poly<double>(0.0));
}

/// White sheen without the light's cosine. It is divided by the larger albedo of the two directions where
/// that is above 1, which keeps it reciprocal.
/// @param squared_sine between the half vector and the normal
inline poly<double> evaluate_sheen(const Sheen& sheen, const poly<double>& squared_sine,
                                   const poly<double>& cos_viewer, const poly<double>& cos_light,
                                   const poly<double>& raw_albedo_viewer,
                                   const poly<double>& raw_albedo_light) {
  constexpr double kNotZero = 1e-300;
  const poly<double> base = cn::max(squared_sine, poly<double>(kNotZero));
  const poly<double> power = cn::exp(cn::log(base) * sheen.exponent);
  const poly<double> visibility = 4.0 * (cos_viewer + cos_light - cos_viewer * cos_light);
  const poly<double> excess = cn::max(cn::max(raw_albedo_viewer, raw_albedo_light), poly<double>(1.0));
  return sheen.scale * power / (visibility * excess);
}

}  // namespace path_tracer
