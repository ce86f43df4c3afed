#pragma once

#include "firmware/path_tracer/materials/fresnel.hpp"

/// Directional albedo of GGX's single scattering, fitted. Tests recompute the integrals and bound the error.
namespace path_tracer {

/// A polynomial in two variables: entry [i][j] belongs to x^i y^j.
template <std::size_t rows, std::size_t columns>
struct Polynomial2 {
  double at[rows][columns];
};

/// A polynomial in x, one for each PE.
template <std::size_t rows>
struct PolyCoefficients {
  poly<double> of_power[rows];
};

template <std::size_t rows, std::size_t columns>
inline PolyCoefficients<rows> insert_y(const Polynomial2<rows, columns>& polynomial, const poly<double>& y) {
  PolyCoefficients<rows> result;
  for (std::size_t i = 0; i < rows; ++i) {
    const auto& row = polynomial.at[i];
    std::size_t j = columns - 1;
    while (j > 1 && row[j] == 0) --j;
    poly<double> sum = y * row[j] + row[j - 1];
    for (--j; j > 0; --j) sum.assign_all_lanes(sum * y + row[j - 1]);
    result.of_power[i].assign_all_lanes(sum);
  }
  return result;
}

template <std::size_t rows>
inline poly<double> value_at(const PolyCoefficients<rows>& polynomial, const poly<double>& x) {
  poly<double> sum = polynomial.of_power[rows - 1];
  for (std::size_t i = rows - 1; i > 0; --i) sum.assign_all_lanes(sum * x + polynomial.of_power[i - 1]);
  return sum;
}

template <std::size_t count>
inline poly<double> value_at(const double (&coefficients)[count], const poly<double>& x) {
  poly<double> sum = x * coefficients[count - 1] + coefficients[count - 2];
  for (std::size_t i = count - 2; i > 0; --i) sum.assign_all_lanes(sum * x + coefficients[i - 1]);
  return sum;
}

namespace albedo_detail {

// Least maximum error by iteratively reweighted least squares over alpha in [4e-4, 1] and cosines in [0, 1];
// x is cos / (cos + 0.7 alpha).

/// Loss / x in x and alpha. Its first column adds up to 0: a mirror loses nothing.
inline constexpr Polynomial2<7, 5> kLoss = {{
    {0.00501807137, -0.457558101, 4.92988388, 0.214038123, -1.17171817},
    {2.32601711, 19.5879819, -82.1249829, 27.4327646, 4.98992993},
    {-13.0013935, -167.914648, 678.729911, -335.237584, 24.8089892},
    {36.9770313, 589.519532, -2384.88064, 1164.94416, -120.752191},
    {-52.8041001, -998.034595, 4010.04214, -1578.12711, 114.661783},
    {34.8309073, 809.592896, -3188.44239, 732.856385, 0},
    {-8.33348005, -252.294081, 958.631764, 0, 0},
}};

/// Schlick share / (1 - cos)^5 in x and 1 / (1 + 16 alpha).
inline constexpr Polynomial2<6, 5> kSchlickShare = {{
    {-0.00823788832, 0.835849203, 1.24048006, -2.25187305, 1.17586276},
    {-0.480424603, 6.14703845, -20.1034563, 24.9072789, -10.9958065},
    {3.60386907, -47.167245, 155.408544, -187.996835, 79.2893317},
    {-8.90009026, 162.19579, -546.493308, 645.92198, -262.934204},
    {1.6519043, -195.487159, 735.311511, -888.79897, 360.721477},
    {11.1485725, 46.8955012, -280.846973, 374.918565, -157.910313},
}};

/// Averages over the cosine-weighted hemisphere of the two fits, in the roughness. That of the loss holds
/// from roughness 0.1 on, below which it is less than 3e-4.
inline constexpr double kLossAverage[] = {-0.0065384198, 0.20000716, -2.30456262, 12.3221009,
                                          -28.5849561,   39.2624263, -28.4216571, 8.12152715};
inline constexpr double kSchlickShareAverage[] = {0.047382917, 0.0155498173, -0.109940263, -0.788700967,
                                                  2.35912993,  -2.2635608,   0.742516909};

}  // namespace albedo_detail

/// What a program needs to know of albedos; mono.
struct AlbedoNeeds {
  bool rough;  ///< without it, all surfaces are smooth and their albedos exact
  bool smooth;
  bool schlick_share;
};

/// For a width of GGX, the light that single scattering loses or reflects, by direction.
struct GgxAlbedo {
  poly<double> scaled_alpha;
  PolyCoefficients<7> loss;
  PolyCoefficients<6> schlick_share;
};

/// @param alpha 0 where the surface is smooth
inline GgxAlbedo ggx_albedo(const AlbedoNeeds& needs, const poly<double>& alpha) {
  if (!needs.rough) return {};
  return {alpha * 0.7, insert_y(albedo_detail::kLoss, alpha),
          needs.schlick_share ? insert_y(albedo_detail::kSchlickShare, 1.0 / (1.0 + 16.0 * alpha))
                              : PolyCoefficients<6>{}};
}

/// The light of one direction.
struct DirectionalAlbedo {
  /// Share of light that a perfect reflector loses, because single scattering leaves it among the facets.
  poly<double> loss;
  /// Integral of schlick_weight() over single scattering. Reflection with Schlick's f0 and f90 has the albedo
  /// f0 (1 - loss) + (f90 - f0) schlick_share.
  poly<double> schlick_share;
};

inline poly<double> schlick_albedo(const DirectionalAlbedo& albedo, const poly<double>& f0,
                                   const poly<double>& f90) {
  return f0 * (1.0 - albedo.loss) + (f90 - f0) * albedo.schlick_share;
}

/// The fitted value, or the exact one where the surface is smooth.
inline poly<double> fitted_or_smooth(const AlbedoNeeds& needs, const GgxAlbedo& albedo,
                                     const poly<double>& fitted, double smooth) {
  if (!needs.smooth) return fitted;
  return cn::select(albedo.scaled_alpha > 0.0, fitted, poly<double>(smooth));
}

inline DirectionalAlbedo directional_albedo(const AlbedoNeeds& needs, const GgxAlbedo& albedo,
                                            const poly<double>& cosine) {
  const poly<double> zero = 0.0;
  if (!needs.rough) return {zero, needs.schlick_share ? schlick_weight(cosine) : zero};
  const poly<double> x = cosine / (cosine + albedo.scaled_alpha);
  const poly<double> loss = fitted_or_smooth(needs, albedo, cn::max(x * value_at(albedo.loss, x), zero), 0.0);
  if (!needs.schlick_share) return {loss, zero};
  const poly<double> share =
      fitted_or_smooth(needs, albedo, cn::max(value_at(albedo.schlick_share, x), zero), 1.0);
  return {loss, schlick_weight(cosine) * share};
}

/// Averages over the cosine-weighted hemisphere.
inline DirectionalAlbedo average_albedo(const AlbedoNeeds& needs, const GgxAlbedo& albedo,
                                        const poly<double>& roughness) {
  constexpr double kAverageSchlickWeight = 1.0 / 21.0;
  const poly<double> zero = 0.0;
  if (!needs.rough) return {zero, kAverageSchlickWeight};
  const poly<double> loss =
      fitted_or_smooth(needs, albedo, cn::max(value_at(albedo_detail::kLossAverage, roughness), zero), 0.0);
  if (!needs.schlick_share) return {loss, zero};
  const poly<double> share = value_at(albedo_detail::kSchlickShareAverage, roughness);
  return {loss, fitted_or_smooth(needs, albedo, share, kAverageSchlickWeight)};
}

}  // namespace path_tracer
