#include <cmath>

#include "tests/support/material_bench.hpp"

/// BSDFs against closed forms and published integrals: energy, reciprocity, Fresnel's equations.
namespace materials_energy_test {

using cn::poly;
using path_tracer::BsdfConfig;
using path_tracer::Lobes;
using test_support::MonoMaterial;
using test_support::MonoPoint;
using test_support::MonoSample;
using test_support::MonoValue;
using test_support::Numbers;
using test_support::PerPe;
using test_support::unit;
using test_support::Vector;

constexpr double kPi = path_tracer::kPi;

Vector at_angle(double cosine, double around) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(around), sine * std::sin(around), cosine};
}

MonoPoint seen_at(double cosine) {
  MonoPoint point;
  point.to_viewer = at_angle(cosine, 0.4);
  return point;
}

BsdfConfig config_of(std::initializer_list<bool Lobes::*> members) {
  BsdfConfig config;
  for (bool Lobes::*member : members) config.lobes.*member = true;
  return config;
}

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

  /// Fresnel's reflectance by the poly code.
  double fresnel(double eta, double cosine) {
    PerPe<double> result = per_pe<double>();
    run([&] {
      const path_tracer::DielectricSurface surface{eta, 1.0 / eta};
      test_support::store(result, path_tracer::dielectric_fresnel(
                                      surface, cosine, path_tracer::refracted_cosine(surface, cosine)));
    });
    return result.front();
  }
};

TEST_F(MaterialsEnergy, FresnelsEquations) {
  EXPECT_NEAR(fresnel(1.5, 1), 0.04, 1e-15);
  EXPECT_NEAR(fresnel(1.5, 0.5), 0.08918671, 1e-8);
  EXPECT_NEAR(fresnel(1.5, path_tracer::kLeastCosine), 1, 1e-10);
  EXPECT_NEAR(fresnel(1 / 1.5, 1), 0.04, 1e-15);
  EXPECT_EQ(fresnel(1 / 1.5, 0.7), 1.0);   // total reflection: sin^2 > 1 / 1.5^2
  EXPECT_LT(fresnel(1 / 1.5, 0.75), 1.0);  // just inside
  EXPECT_NEAR(fresnel(1, 0.3), 0, 1e-30);
  // Light takes the same way back: the reflectance is that at the refracted angle.
  for (const double cosine : {0.1, 0.4, 0.9}) {
    const double refracted = std::sqrt(1 - (1 - cosine * cosine) / (1.5 * 1.5));
    EXPECT_NEAR(fresnel(1.5, cosine), fresnel(1 / 1.5, refracted), 1e-14);
  }
  // Brewster's angle: the parallel part vanishes, and the perpendicular one is cos(2 angle)^2.
  const double cosine = 1 / std::hypot(1, 1.5);
  EXPECT_NEAR(fresnel(1.5, cosine), 0.5 * std::pow(2 * cosine * cosine - 1, 2), 1e-15);
}

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
      EXPECT_NEAR(furnace(config, perfect_reflector(row[0]), seen_at(cosines[i])).x, row[i + 1], 1.5e-3)
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
            path_tracer::directional_albedo(path_tracer::ggx_albedo(alpha, false, true), cosine, true);
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
            path_tracer::ggx_albedo(alpha, false, true), test_support::load(cosines), true);
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
          path_tracer::average_albedo(path_tracer::ggx_albedo(alpha, false, true), roughness, true);
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
        EXPECT_NEAR(furnace(plastic, material, seen_at(cosine), 1 << 18).x, 1, 0.009)
            << "metallic " << material.metallic << ", roughness " << roughness << ", cosine " << cosine;
      }
  for (const double cosine : {0.05, 0.3, 1.0})
    for (MonoMaterial material : {metal, varnish, half}) {
      material.roughness = 0;
      EXPECT_NEAR(furnace(plastic, material, seen_at(cosine)).x, 1, 0.005) << cosine;
    }
}

/// Thin sheets keep all light. A rough boundary between two media loses what it scatters several times: the
/// losses are those of docs/materials.md.
TEST_F(MaterialsEnergy, FrostedGlass) {
  const BsdfConfig config = config_of({&Lobes::rough_glass, &Lobes::thin_glass});
  const auto total = [&](const MonoMaterial& material, double cosine) {
    double sum = 0;
    constexpr std::size_t kSamples = 1 << 17;
    const double eta_squared = material.thin ? 1 : material.eta * material.eta;
    for (const MonoSample& s : sample_all(config, material, seen_at(cosine), even_numbers(kSamples)))
      sum += s.weight.x * (s.transmits ? eta_squared : 1);
    return sum / kSamples;
  };
  MonoMaterial material;
  material.transmission = 1;
  const double kept[][3] = {{0.3, 0.97, 0.97}, {0.5, 0.97, 0.90}, {0.7, 0.90, 0.76}, {1, 0.70, 0.52}};
  for (const auto& [roughness, into_glass, out_of_glass] : kept)
    for (const double cosine : {0.2, 0.5, 0.8, 1.0}) {
      material.roughness = roughness;
      material.thin = true;
      material.eta = 1.5;
      EXPECT_NEAR(total(material, cosine), 1, 0.008) << roughness << " " << cosine;
      material.thin = false;
      EXPECT_LT(total(material, cosine), 1.001) << roughness << " " << cosine;
      EXPECT_GT(total(material, cosine), into_glass) << roughness << " " << cosine;
      material.eta = 1 / 1.5;
      EXPECT_LT(total(material, cosine), 1.001) << roughness << " " << cosine;
      EXPECT_GT(total(material, cosine), out_of_glass) << roughness << " " << cosine;
    }
}

/// Layers lose up to 15 % of white light where one direction is grazing and the other is not, and gain none.
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
          const auto total = [&](const MonoMaterial& m) { return furnace(config, m, seen_at(cosine)).x; };
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
  EXPECT_NEAR(furnace(config, material, seen_at(1)).x, 0.04 * 0.9984, 2e-4);
  material.f0 = path_tracer::reflectance_at_normal(2);
  EXPECT_NEAR(furnace(config, material, seen_at(1)).x, 0.9984 / 9, 3e-4);
  EXPECT_EQ(path_tracer::reflectance_at_normal(0), 1.0);
}

/// A sample of the specular way with the given branch: its weight times its probability.
struct Branch {
  double transmitted = 0;
  double reflected = 0;
  Vector transmitted_direction{0, 0, 0};
};

/// Light through a plane-parallel sheet without interference, by following both branches at each side.
TEST_F(MaterialsEnergy, SlabOfGlass) {
  const BsdfConfig config = config_of({&Lobes::glass});
  MonoMaterial in;
  in.transmission = 1;
  in.roughness = 0;
  MonoMaterial out = in;
  out.eta = 1 / in.eta;
  /// Splits by choice: nearly all choices but the reflected share transmit.
  const auto split = [&](const MonoMaterial& material, double cosine) {
    Branch branch;
    const std::vector<MonoSample> samples =
        sample_all(config, material, seen_at(cosine), {{0.5, 0.5, 1e-9}, {0.5, 0.5, 1 - 1e-9}});
    EXPECT_FALSE(samples[0].transmits);
    EXPECT_TRUE(samples[0].is_delta);
    EXPECT_TRUE(samples[1].transmits);
    EXPECT_EQ(samples[1].pdf, 0.0);
    EXPECT_NEAR(samples[0].weight.x, 1, 1e-14);  // white: reflectance / its share of the samples
    // Its share of the samples is Fresnel's reflectance; the furnace counts it.
    branch.reflected = fresnel(material.eta, cosine);
    branch.transmitted = samples[1].weight.x * (1 - branch.reflected);
    branch.transmitted_direction = samples[1].direction;
    return branch;
  };
  for (const auto& [cosine, expected] : {std::pair(1.0, 0.92307692), {0.5, 0.83623246}}) {
    const Branch entry = split(in, cosine);
    const double inside = std::abs(entry.transmitted_direction.z);
    EXPECT_NEAR(inside, std::sqrt(1 - (1 - cosine * cosine) / 2.25), 1e-14);
    const Branch exit = split(out, inside);
    EXPECT_NEAR(std::abs(exit.transmitted_direction.z), cosine, 1e-14);
    double sum = 0;
    double radiance = entry.transmitted;
    for (int bounce = 0; bounce < 40; ++bounce) {
      if (bounce % 2 == 0) sum += radiance * exit.transmitted;
      radiance *= exit.reflected;
    }
    EXPECT_NEAR(sum, expected, 1e-8);
  }
}

/// How often a smooth dielectric reflects is Fresnel's reflectance.
TEST_F(MaterialsEnergy, SmoothGlassReflectsFresnelsShare) {
  const BsdfConfig config = config_of({&Lobes::glass, &Lobes::thin_glass});
  MonoMaterial material;
  material.transmission = 1;
  material.roughness = 0;
  for (const double cosine : {1.0, 0.5, 0.1}) {
    double reflected = 0;
    constexpr std::size_t kSamples = 1 << 16;
    for (const MonoSample& s : sample_all(config, material, seen_at(cosine), even_numbers(kSamples))) {
      reflected += !s.transmits;
      // Radiance is compressed by eta^2 behind the surface.
      EXPECT_NEAR(s.weight.x, s.transmits ? 1 / 2.25 : 1.0, 1e-14);
    }
    EXPECT_NEAR(reflected / kSamples, fresnel(1.5, cosine), 2e-4);
  }
  material.thin = true;
  for (const MonoSample& s : sample_all(config, material, seen_at(0.5), even_numbers(1024))) {
    EXPECT_NEAR(s.weight.x, 1, 1e-14);
    if (!s.transmits) continue;
    EXPECT_NEAR(dot(s.direction, seen_at(0.5).to_viewer), -1, 1e-14);
  }
  material.thin = false;
  material.eta = 1;  // no boundary: straight on, with nothing lost
  for (const MonoSample& s : sample_all(config, material, seen_at(0.5), even_numbers(1024))) {
    EXPECT_TRUE(s.transmits);
    EXPECT_NEAR(s.weight.x, 1, 1e-14);
    EXPECT_NEAR(dot(s.direction, seen_at(0.5).to_viewer), -1, 1e-14);
  }
}

TEST_F(MaterialsEnergy, RoughGlassTransmitsWhatQuadratureSays) {
  const BsdfConfig config = config_of({&Lobes::rough_glass});
  MonoMaterial material;
  material.transmission = 1;
  material.roughness = std::sqrt(0.5);
  double reflected = 0;
  double transmitted = 0;
  constexpr std::size_t kSamples = 1 << 19;
  for (const MonoSample& s : sample_all(config, material, seen_at(0.6), even_numbers(kSamples)))
    (s.transmits ? transmitted : reflected) += s.weight.x;
  EXPECT_NEAR(transmitted / kSamples * 2.25, 0.874226, 3e-4);
  EXPECT_NEAR(reflected / kSamples, 0.038171, 2e-4);
  // The same by quadrature of the value over all directions.
  std::vector<Vector> directions;
  constexpr int kHeights = 1024;
  constexpr int kAround = 512;
  for (int i = 0; i < kHeights; ++i)
    for (int j = 0; j < kAround; ++j)
      directions.push_back(at_angle(-1 + 2 * (i + 0.5) / kHeights, 2 * kPi * (j + 0.5) / kAround));
  double below = 0;
  double above = 0;
  const std::vector<MonoValue> values = evaluate_all(config, material, seen_at(0.6), directions);
  for (std::size_t i = 0; i < values.size(); ++i)
    (directions[i].z < 0 ? below : above) += values[i].value.x * 4 * kPi / (double(kHeights) * kAround);
  EXPECT_NEAR(below * 2.25, 0.874226, 2e-4);
  EXPECT_NEAR(above, 0.038171, 1e-5);
}

/// The formulas as books print them, in a local frame and with normalised half vectors.
double textbook(double alpha, double eta, const Vector& viewer, const Vector& light) {
  const auto lambda = [&](const Vector& w) {
    return (std::sqrt(1 + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z)) - 1) / 2;
  };
  const bool refracts = light.z < 0;
  Vector half = unit(viewer + light * (refracts ? eta : 1.0));
  if (half.z < 0) half = half * -1.0;
  const double vh = dot(viewer, half);
  const double lh = dot(light, half);
  if (vh <= 0 || (refracts && lh >= 0)) return 0;
  const double tangent2 = (1 - half.z * half.z) / (half.z * half.z);
  const double d =
      1 / (kPi * alpha * alpha * std::pow(half.z, 4) * std::pow(1 + tangent2 / (alpha * alpha), 2));
  const double g = 1 / (1 + lambda(viewer) + lambda(light));
  const double sine2 = (1 - vh * vh) / (eta * eta);
  double f = 1;
  if (sine2 < 1) {
    const double ct = std::sqrt(1 - sine2);
    const double parallel = (eta * vh - ct) / (eta * vh + ct);
    const double perpendicular = (vh - eta * ct) / (vh + eta * ct);
    f = (parallel * parallel + perpendicular * perpendicular) / 2;
  }
  if (!refracts) return f * d * g / (4 * viewer.z * light.z);
  // Walter et al. 2007, equation 21 over eta^2, for radiance.
  return std::abs(vh * lh / (viewer.z * light.z)) * (1 - f) * d * g / std::pow(vh + eta * lh, 2);
}

TEST_F(MaterialsEnergy, ValuesAreTheTextbooks) {
  const BsdfConfig config = config_of({&Lobes::rough_glass});
  int positive = 0;
  for (const double alpha : {0.05, 0.3, 1.0})
    for (const double eta : {1.5, 1 / 1.5, 2.4, 1.01})
      for (const double viewer : {0.95, 0.4, 0.05}) {
        MonoMaterial material;
        material.transmission = 1;
        material.roughness = std::sqrt(alpha);
        material.eta = eta;
        std::vector<Vector> lights;
        for (const double z : {0.97, 0.6, 0.2, 0.03, -0.03, -0.2, -0.6, -0.97})
          for (const double around : {0.4, 1.0, 2.9, 3.6}) lights.push_back(at_angle(z, around));
        const MonoPoint point = seen_at(viewer);
        const std::vector<MonoValue> values = evaluate_all(config, material, point, lights);
        for (std::size_t i = 0; i < lights.size(); ++i) {
          const double expected = textbook(alpha, eta, point.to_viewer, lights[i]) * std::abs(lights[i].z);
          positive += expected > 0;
          EXPECT_NEAR(values[i].value.x, expected, 1e-9 * expected + 1e-14)
              << alpha << " " << eta << " " << viewer << " " << lights[i].z;
        }
      }
  EXPECT_GT(positive, 500);
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

}  // namespace materials_energy_test
