#include <cmath>

#include "tests/materials/material_bench.hpp"

/// BSDFs against closed forms and published integrals: energy, reciprocity, Fresnel's equations.
namespace bsdf_energy_test {

using cn::poly;
using path_tracer::BsdfConfig;
using path_tracer::Lobes;
using test_support::at_angle;
using test_support::config_of;
using test_support::MonoMaterial;
using test_support::MonoPoint;
using test_support::MonoSample;
using test_support::MonoValue;
using test_support::Numbers;
using test_support::PerPe;
using test_support::seen_from_above;
using test_support::unit;
using test_support::Vector;

constexpr double kPi = path_tracer::kPi;
constexpr path_tracer::AlbedoNeeds kRough{true, false, true};

/// GGX that reflects everything: a medium so thin that reflection is total at all but a few angles.
MonoMaterial perfect_reflector(double alpha) {
  MonoMaterial material;
  material.transmission = 1;
  material.eta = 1e-3;
  material.roughness = std::sqrt(alpha);
  return material;
}

/// Single scattering in plain C++, as an integral over visible normals: the share of light that leaves, and
/// Schlick's part of it.
struct SingleScattering {
  double albedo = 0;
  double schlick_share = 0;
};

SingleScattering integrate_ggx(double cosine, double alpha) {
  constexpr int kAround = 128;
  constexpr int kHeights = 1024;
  const auto size = [&](double z) { return std::sqrt(alpha * alpha * (1 - z * z) + z * z); };
  const double sine = std::sqrt(1 - cosine * cosine);
  const Vector stretched = unit({alpha * sine, 0, cosine});
  SingleScattering sum;
  for (int j = 0; j < kHeights; ++j) {
    const double t = (j + 0.5) / kHeights;  // denser at both ends, where the integrand is steep
    const double z = 1 - t * t * (3 - 2 * t) * (1 + stretched.z);
    const double weight = 6 * t * (1 - t) / kHeights / kAround;
    for (int i = 0; i < kAround; ++i) {
      const double around = kPi * (i + 0.5) / kAround;
      const double radius = std::sqrt(std::max(0.0, 1 - z * z));
      const Vector half = Vector{radius * std::cos(around), radius * std::sin(around), z} + stretched;
      const Vector facet = unit({alpha * half.x, alpha * half.y, std::max(half.z, 0.0)});
      const double with_facet = facet.x * sine + facet.z * cosine;
      const double light = 2 * with_facet * facet.z - cosine;
      if (light <= 0) continue;
      const double viewer_lambda = (size(cosine) / cosine - 1) / 2;
      const double light_lambda = (size(light) / light - 1) / 2;
      const double leaves = weight * (1 + viewer_lambda) / (1 + viewer_lambda + light_lambda);
      sum.albedo += leaves;
      sum.schlick_share += leaves * std::pow(1 - with_facet, 5);
    }
  }
  return sum;
}

class MaterialsEnergy : public test_support::MaterialBench {
 protected:
  /// Mean of the weights of evenly spread samples: what leaves of light that arrives from everywhere.
  Vector furnace(const BsdfConfig& config, const MonoMaterial& material, const MonoPoint& point,
                 std::size_t samples = 1 << 17) {
    Vector sum{0, 0, 0};
    for (const MonoSample& s : sample_all(config, material, point, even_numbers(samples)))
      sum = sum + s.weight;
    return sum * (1.0 / static_cast<double>(samples));
  }

  MonoValue value(const BsdfConfig& config, const MonoMaterial& material, const MonoPoint& point,
                  const Vector& to_light) {
    return evaluate_all(config, material, point, {to_light}).front();
  }
};

/// Albedo of single scattering by a perfect reflector. At alpha = 1 and normal incidence it is 1 - ln 2.
TEST_F(MaterialsEnergy, SingleScatteringLosesWhatItShould) {
  const BsdfConfig config = config_of({&Lobes::rough_glass});
  const double cosines[] = {0.1, 0.5, 0.9, 1};
  const double expected[][5] = {{0.04, 0.92908, 0.99554, 0.99806, 0.99840},
                                {0.25, 0.89162, 0.85726, 0.90738, 0.91581},
                                {0.5, 0.86011, 0.69825, 0.68396, 0.68785},
                                {1, 0.76021, 0.45069, 0.32751, 1 - std::log(2.0)}};
  for (const auto& row : expected)
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(furnace(config, perfect_reflector(row[0]), seen_from_above(cosines[i])).x, row[i + 1],
                  1.5e-3)
          << row[0] << " " << cosines[i];
      EXPECT_NEAR(integrate_ggx(cosines[i], row[0]).albedo, row[i + 1], 1e-4) << row[0] << " " << cosines[i];
    }
}

/// The bound that albedo.hpp states.
TEST_F(MaterialsEnergy, FittedAlbedosAreWithinTheirBound) {
  constexpr double kBound = 0.0032;
  double largest_loss = 0;
  double largest_share = 0;
  for (const double roughness : {0.02, 0.06, 0.11, 0.17, 0.23, 0.31, 0.42, 0.55, 0.63, 0.74, 0.86, 0.97, 1.0})
    for (const double cosine : {0.003, 0.01, 0.04, 0.09, 0.17, 0.26, 0.38, 0.52, 0.67, 0.83, 0.94, 1.0}) {
      const double alpha = roughness * roughness;
      const SingleScattering expected = integrate_ggx(cosine, alpha);
      PerPe<double> loss = per_pe<double>();
      PerPe<double> share = per_pe<double>();
      run([&] {
        const path_tracer::DirectionalAlbedo found =
            path_tracer::directional_albedo(kRough, path_tracer::ggx_albedo(kRough, alpha), cosine);
        test_support::store(loss, found.loss);
        test_support::store(share, found.schlick_share);
      });
      largest_loss = std::max(largest_loss, std::abs(loss.front() - (1 - expected.albedo)));
      largest_share = std::max(largest_share, std::abs(share.front() - expected.schlick_share));
    }
  EXPECT_LT(largest_loss, kBound);
  EXPECT_LT(largest_share, kBound);
}

TEST_F(MaterialsEnergy, FittedAveragesAreThoseOfTheFits) {
  for (const double roughness : {0.2, 0.4, 0.6, 0.8, 1.0}) {
    const double alpha = roughness * roughness;
    double loss = 0;
    double share = 0;
    constexpr int kRounds = 8;
    PerPe<double> cosines = per_pe<double>();
    for (int round = 0; round < kRounds; ++round) {
      PerPe<double> losses = per_pe<double>();
      PerPe<double> shares = per_pe<double>();
      for (std::size_t i = 0; i < cosines.size(); ++i)
        cosines[i] = std::sqrt((double(i) * kRounds + round + 0.5) / double(cosines.size() * kRounds));
      run([&] {
        const path_tracer::DirectionalAlbedo found = path_tracer::directional_albedo(
            kRough, path_tracer::ggx_albedo(kRough, alpha), test_support::load(cosines));
        test_support::store(losses, found.loss);
        test_support::store(shares, found.schlick_share);
      });
      for (std::size_t i = 0; i < cosines.size(); ++i) loss += losses[i], share += shares[i];
    }
    const double count = double(cosines.size()) * kRounds;
    PerPe<double> found_loss = cosines;
    PerPe<double> found_share = cosines;
    run([&] {
      const path_tracer::DirectionalAlbedo average =
          path_tracer::average_albedo(kRough, path_tracer::ggx_albedo(kRough, alpha), roughness);
      test_support::store(found_loss, average.loss);
      test_support::store(found_share, average.schlick_share);
    });
    // The loss is divided by its average, so a relative error counts where the loss is large.
    EXPECT_NEAR(found_loss.front(), loss / count, 0.015 * loss / count) << roughness;
    EXPECT_NEAR(found_share.front(), share / count, 2e-4);
  }
}

/// White surfaces in white light, with the bound that each is documented to keep.
TEST_F(MaterialsEnergy, WhiteFurnace) {
  MonoMaterial metal;
  metal.metallic = 1;
  MonoMaterial varnish;
  MonoMaterial half = varnish;
  half.metallic = 0.5;
  const BsdfConfig plastic = config_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::mirror});
  for (const double roughness : {0.2, 0.3, 0.5, 0.7, 0.85, 1.0})
    for (const double cosine : {0.05, 0.1, 0.3, 0.5, 0.9, 1.0})
      for (MonoMaterial material : {metal, varnish, half}) {
        material.roughness = roughness;
        EXPECT_NEAR(furnace(plastic, material, seen_from_above(cosine), 1 << 18).x, 1, 0.009)
            << "metallic " << material.metallic << ", roughness " << roughness << ", cosine " << cosine;
      }
  for (const double cosine : {0.05, 0.3, 1.0})
    for (MonoMaterial material : {metal, varnish, half}) {
      material.roughness = 0;
      EXPECT_NEAR(furnace(plastic, material, seen_from_above(cosine)).x, 1, 0.005) << cosine;
    }
}

/// LayerTransmittance lose up to 15 % of white light where one direction is grazing and the other is not, and
/// gain none.
TEST_F(MaterialsEnergy, LayersGainNothing) {
  const BsdfConfig config =
      config_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::mirror, &Lobes::coat, &Lobes::sheen});
  for (const double roughness : {0.0, 0.4, 1.0})
    for (const double layer : {0.0, 0.3, 1.0})
      for (const double cosine : {0.05, 0.3, 0.7, 1.0})
        for (const double metallic : {0.0, 1.0}) {
          MonoMaterial coated;
          coated.roughness = roughness;
          coated.metallic = metallic;
          coated.coat = 1;
          coated.coat_roughness = layer;
          MonoMaterial cloth = coated;
          cloth.coat = 0;
          cloth.sheen_color = {1, 1, 1};
          cloth.sheen_roughness = layer;
          MonoMaterial both = cloth;
          both.coat = 1;
          const auto total = [&](const MonoMaterial& m) {
            return furnace(config, m, seen_from_above(cosine), 1 << 16).x;
          };
          for (const double found : {total(coated), total(cloth), total(both)})
            EXPECT_LT(found, 1.01) << roughness << " " << layer << " " << cosine;
          EXPECT_GT(total(coated), 0.94) << roughness << " " << layer << " " << cosine;
          EXPECT_GT(total(cloth), 0.85) << roughness << " " << layer << " " << cosine;
        }
}

/// At normal incidence and without layers, varnish on black reflects Schlick's 4 %.
TEST_F(MaterialsEnergy, VarnishOnBlackReflectsFourPercent) {
  MonoMaterial material;
  material.base_color = {0, 0, 0};
  material.roughness = 0.2;
  const BsdfConfig config = config_of({&Lobes::diffuse, &Lobes::glossy});
  EXPECT_NEAR(furnace(config, material, seen_from_above(1)).x, 0.04 * 0.9984, 2e-4);
  material.f0 = path_tracer::reflectance_at_normal(2);
  EXPECT_NEAR(furnace(config, material, seen_from_above(1)).x, 0.9984 / 9, 3e-4);
  EXPECT_EQ(path_tracer::reflectance_at_normal(0), 1.0);
}

/// f(a, b) = f(b, a); across a boundary, f / eta^2 of the light's side.
TEST_F(MaterialsEnergy, Reciprocity) {
  const BsdfConfig config = config_of(
      {&Lobes::diffuse, &Lobes::glossy, &Lobes::rough_glass, &Lobes::coat, &Lobes::sheen, &Lobes::mirror});
  MonoMaterial material;
  material.base_color = {0.8, 0.5, 0.2};
  material.metallic = 0.3;
  material.transmission = 0.4;
  material.coat = 0.7;
  material.coat_roughness = 0.3;
  material.sheen_color = {0.4, 0.3, 0.2};
  MonoMaterial back = material;
  back.eta = 1 / material.eta;
  int positive = 0;  // not every pair has a facet that refracts one into the other
  for (const double roughness : {0.2, 0.5, 1.0}) {
    material.roughness = back.roughness = roughness;
    for (const double a : {0.9, 0.5, 0.1})
      for (const double b : {0.95, 0.4, 0.07, -0.1, -0.5, -0.9}) {
        const Vector viewer = at_angle(a, 0.4);
        const Vector light = at_angle(b, b < 0 ? 3.2 : 2.0);
        MonoPoint forth;
        forth.to_viewer = viewer;
        MonoPoint reverse;
        reverse.to_viewer = light;
        if (b < 0) reverse.normal = Vector{0, 0, -1};
        const double there = value(config, material, forth, light).value.x / std::abs(b);
        const double here = value(config, b < 0 ? back : material, reverse, viewer).value.x / a;
        // Radiance over the index squared is what does not change on the way.
        const double index_squared = b < 0 ? material.eta * material.eta : 1.0;
        EXPECT_NEAR(there * index_squared, here, 1e-11 * here) << roughness << " " << a << " " << b;
        positive += here > 0;
      }
  }
  EXPECT_GE(positive, 27 + 12);
}

TEST_F(MaterialsEnergy, AbsorptionIsBeersLaw) {
  const Vector coefficient = path_tracer::absorption_coefficient({0.5, 1, 0}, 2);
  EXPECT_DOUBLE_EQ(coefficient.x, std::log(2.0) / 2);
  EXPECT_EQ(coefficient.y, 0);
  EXPECT_TRUE(std::isfinite(coefficient.z));
  PerPe<double> x = per_pe<double>();
  PerPe<double> z = x;
  run([&] {
    const path_tracer::Rgb left =
        path_tracer::transmittance({coefficient.x, coefficient.y, coefficient.z}, poly<double>(6.0));
    test_support::store(x, left.x);
    test_support::store(z, left.z);
  });
  EXPECT_NEAR(x.front(), 0.125, 1e-15);
  EXPECT_NEAR(z.front(), 0, 1e-30);
}

}  // namespace bsdf_energy_test
