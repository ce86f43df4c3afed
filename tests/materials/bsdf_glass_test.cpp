#include <cmath>

#include "tests/materials/material_bench.hpp"

/// Smooth and rough glass against Fresnel's equations, closed forms and the formulas of textbooks.
namespace bsdf_glass_test {

using path_tracer::BsdfConfig;
using path_tracer::Lobes;
using test_support::at_angle;
using test_support::config_of;
using test_support::MonoMaterial;
using test_support::MonoPoint;
using test_support::MonoSample;
using test_support::MonoValue;
using test_support::PerPe;
using test_support::seen_from_above;
using test_support::unit;
using test_support::Vector;

constexpr double kPi = path_tracer::kPi;

class MaterialsGlass : public test_support::MaterialBench {
 protected:
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

TEST_F(MaterialsGlass, FresnelsEquations) {
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

/// Thin sheets keep all light. A rough boundary between two media loses what it scatters several times: the
/// losses are those of docs/materials.md.
TEST_F(MaterialsGlass, FrostedGlass) {
  const BsdfConfig config = config_of({&Lobes::rough_glass, &Lobes::thin_glass});
  const auto total = [&](const MonoMaterial& material, double cosine) {
    double sum = 0;
    constexpr std::size_t kSamples = 1 << 17;
    const double eta_squared = material.thin ? 1 : material.eta * material.eta;
    for (const MonoSample& s : sample_all(config, material, seen_from_above(cosine), even_numbers(kSamples)))
      sum += s.weight.x * (s.transmits ? eta_squared : 1);
    return sum / kSamples;
  };
  MonoMaterial material;
  material.transmission = 1;
  const double kept[][3] = {{0.3, 0.95, 0.90}, {0.5, 0.91, 0.79}, {0.7, 0.84, 0.66}, {1, 0.70, 0.41}};
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

/// A sample of the specular way with the given branch: its weight times its probability.
struct Branch {
  double transmitted = 0;
  double reflected = 0;
  Vector transmitted_direction{0, 0, 0};
};

/// Light through a plane-parallel sheet without interference, by following both branches at each side.
TEST_F(MaterialsGlass, SlabOfGlass) {
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
        sample_all(config, material, seen_from_above(cosine), {{0.5, 0.5, 1e-9}, {0.5, 0.5, 1 - 1e-9}});
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
TEST_F(MaterialsGlass, SmoothGlassReflectsFresnelsShare) {
  const BsdfConfig config = config_of({&Lobes::glass, &Lobes::thin_glass});
  MonoMaterial material;
  material.transmission = 1;
  material.roughness = 0;
  for (const double cosine : {1.0, 0.5, 0.1}) {
    double reflected = 0;
    constexpr std::size_t kSamples = 1 << 16;
    for (const MonoSample& s :
         sample_all(config, material, seen_from_above(cosine), even_numbers(kSamples))) {
      reflected += !s.transmits;
      // Radiance is compressed by eta^2 behind the surface.
      EXPECT_NEAR(s.weight.x, s.transmits ? 1 / 2.25 : 1.0, 1e-14);
    }
    EXPECT_NEAR(reflected / kSamples, fresnel(1.5, cosine), 2e-4);
  }
  material.thin = true;
  for (const MonoSample& s : sample_all(config, material, seen_from_above(0.5), even_numbers(1024))) {
    EXPECT_NEAR(s.weight.x, 1, 1e-14);
    if (!s.transmits) continue;
    EXPECT_NEAR(dot(s.direction, seen_from_above(0.5).to_viewer), -1, 1e-14);
  }
  material.thin = false;
  material.eta = 1;  // no boundary: straight on, with nothing lost
  for (const MonoSample& s : sample_all(config, material, seen_from_above(0.5), even_numbers(1024))) {
    EXPECT_TRUE(s.transmits);
    EXPECT_NEAR(s.weight.x, 1, 1e-14);
    EXPECT_NEAR(dot(s.direction, seen_from_above(0.5).to_viewer), -1, 1e-14);
  }
}

/// Through a sheet of glass, the weights times the factors stay 1, although the radiance inside does not.
TEST_F(MaterialsGlass, RouletteFactorsUndoTheCompression) {
  const BsdfConfig config = config_of({&Lobes::glass, &Lobes::thin_glass});
  MonoMaterial material;
  material.transmission = 1;
  material.roughness = 0;
  for (const double eta : {1.5, 1 / 1.5})
    for (const bool thin : {false, true})
      for (const double choice : {1e-9, 1 - 1e-9}) {
        material.eta = eta;
        material.thin = thin;
        PerPe<double> weight = per_pe<double>();
        PerPe<double> factor = per_pe<double>();
        run([&] {
          const path_tracer::Bsdf bsdf = prepare(config, material, seen_from_above(0.9));
          const path_tracer::BsdfSample found = sample(bsdf, {0.5, 0.5}, choice);
          test_support::store(weight, found.weight.x);
          test_support::store(factor, path_tracer::roulette_factor(bsdf, found));
        });
        EXPECT_NEAR(weight.front() * factor.front(), 1, 1e-14) << eta << " " << thin << " " << choice;
        EXPECT_EQ(factor.front() != 1, choice > 0.5 && !thin) << eta;
      }
}

TEST_F(MaterialsGlass, RoughGlassTransmitsWhatQuadratureSays) {
  const BsdfConfig config = config_of({&Lobes::rough_glass});
  MonoMaterial material;
  material.transmission = 1;
  material.roughness = std::sqrt(0.5);
  double reflected = 0;
  double transmitted = 0;
  constexpr std::size_t kSamples = 1 << 19;
  for (const MonoSample& s : sample_all(config, material, seen_from_above(0.6), even_numbers(kSamples)))
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
  const std::vector<MonoValue> values = evaluate_all(config, material, seen_from_above(0.6), directions);
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

TEST_F(MaterialsGlass, ValuesAreTheTextbooks) {
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
        const MonoPoint point = seen_from_above(viewer);
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

}  // namespace bsdf_glass_test
