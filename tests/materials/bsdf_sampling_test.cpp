#include <cmath>
#include <cstring>
#include <limits>

#include "tests/materials/material_settings.hpp"
#include "tests/materials/polar_cells.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/statistics.hpp"

/// Samples, densities and values of BSDFs against each other.
namespace bsdf_sampling_test {

using path_tracer::BsdfConfig;
using path_tracer::Lobes;
using test_support::ChiSquare;
using test_support::every_lobe;
using test_support::glass;
using test_support::kViewerCosines;
using test_support::lobes_of;
using test_support::metal;
using test_support::mixture;
using test_support::MonoMaterial;
using test_support::MonoPoint;
using test_support::MonoSample;
using test_support::MonoValue;
using test_support::Numbers;
using test_support::PolarCells;
using test_support::seen_at;
using test_support::Setting;
using test_support::thin;
using test_support::unit;
using test_support::varnish;
using test_support::Vector;
using test_support::with_coat;
using test_support::with_sheen;

constexpr double kPi = path_tracer::kPi;

Vector reflected(const MonoPoint& point) {
  return point.normal * (2 * dot(point.normal, point.to_viewer)) - point.to_viewer;
}

/// The refracted direction; at total reflection, the one along the surface.
Vector transmitted(const MonoMaterial& material, const MonoPoint& point) {
  if (material.thin) return point.to_viewer * -1.0;
  const double cosine = dot(point.normal, point.to_viewer);
  const Vector across = (point.normal * cosine - point.to_viewer) * (1 / material.eta);
  return unit(across - point.normal * std::sqrt(std::max(0.0, 1 - dot(across, across))));
}

class MaterialsSampling : public test_support::MaterialBench {
 protected:
  /// The probability of each cell by the density of `material`.
  std::vector<double> probabilities(const PolarCells& cells, const BsdfConfig& config,
                                    const MonoMaterial& material, const MonoPoint& point) {
    const std::vector<PolarCells::Point> points = cells.points();
    std::vector<Vector> directions;
    for (const PolarCells::Point& p : points) directions.push_back(p.direction);
    const std::vector<MonoValue> values = evaluate_all(config, material, point, directions);
    std::vector<double> result(cells.count());
    for (std::size_t i = 0; i < points.size(); ++i)
      result[points[i].cell] += values[i].pdf * points[i].solid_angle;
    return result;
  }

  /// Chi-square deviation between samples of `sampled` and the density of `expected`. Cells with few samples
  /// are pooled; one bin takes the samples without a density.
  double deviation(const BsdfConfig& config, const MonoMaterial& sampled, const MonoMaterial& expected,
                   const MonoPoint& point, std::uint64_t seed) {
    constexpr std::size_t kSamples = 1 << 18;
    // Glass has a second peak, away from the pole, and steep sides.
    const PolarCells cells = config.lobes.transmissive() ? PolarCells(transmitted(sampled, point), 24)
                                                         : PolarCells(reflected(point), 12);
    const std::vector<double> probability = probabilities(cells, config, expected, point);
    double total = 0;
    for (const double p : probability) total += p;
    EXPECT_LT(total, 1 + 2e-3) << sampled.roughness << " " << dot(point.normal, point.to_viewer);
    std::vector<double> bins;
    std::vector<std::size_t> bin_of(cells.count());
    double pooled = std::max(0.0, 1 - total);
    for (std::size_t i = 0; i < cells.count(); ++i) {
      const bool large = probability[i] * kSamples >= 8;
      bin_of[i] = large ? bins.size() + 1 : 0;
      if (large)
        bins.push_back(probability[i]);
      else
        pooled += probability[i];
    }
    bins.insert(bins.begin(), pooled + 1e-9);
    ChiSquare test(bins);
    for (const MonoSample& s : sample_all(config, sampled, point, random_numbers(kSamples, seed)))
      test.add(s.pdf > 0 ? bin_of[cells.cell_of(s.direction)] : 0);
    return test.deviation();
  }
};

TEST_F(MaterialsSampling, SamplesHaveTheDensity) {
  const double threshold = test_support::normal_threshold(
      test_support::per_test(double(test_support::material_settings().size() * 4)));
  std::uint64_t seed = 100;
  for (const Setting& s : test_support::material_settings())
    for (const double cosine : kViewerCosines) {
      BsdfConfig config;
      config.lobes = s.lobes;
      config.diffuse_pdf = true;
      EXPECT_LT(deviation(config, s.material, s.material, seen_at(cosine), ++seed), threshold)
          << s.name << ", roughness " << s.material.roughness << ", cosine " << cosine;
    }
}

TEST_F(MaterialsSampling, ShadingNormalsLeaveOutOneSide) {
  const double threshold = test_support::normal_threshold(test_support::per_test(3));
  std::uint64_t seed = 400;
  for (const Setting& s : {Setting{"metal", lobes_of({&Lobes::glossy}), metal(0.5)},
                           Setting{"glass", lobes_of({&Lobes::rough_glass}), glass(0.6, 1.5)},
                           Setting{"every lobe", every_lobe(), mixture(0.5)}}) {
    BsdfConfig config;
    config.lobes = s.lobes;
    config.shading_normals = true;
    MonoPoint point = seen_at(0.6);
    point.geometric_normal = unit(point.normal + cross(point.normal, point.to_viewer) * 0.6);
    EXPECT_LT(deviation(config, s.material, s.material, point, ++seed), threshold) << s.name;
    for (const MonoSample& sample : sample_all(config, s.material, point, random_numbers(1 << 14, seed))) {
      if (sample.weight.x == 0) continue;
      EXPECT_EQ(dot(sample.direction, point.geometric_normal) < 0, sample.transmits) << s.name;
    }
  }
}

/// That test would find these: 3 % of a width or index, or two thirds of a coat.
TEST_F(MaterialsSampling, TheTestSeesSmallErrors) {
  BsdfConfig config;
  config.lobes = lobes_of({&Lobes::glossy});
  EXPECT_GT(deviation(config, metal(0.5), metal(0.515), seen_at(0.6), 7), 6);
  config.lobes = lobes_of({&Lobes::rough_glass});
  EXPECT_GT(deviation(config, glass(0.5, 1.5), glass(0.5, 1.55), seen_at(0.6), 8), 6);
  config.lobes = lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::coat});
  EXPECT_GT(
      deviation(config, with_coat(varnish(0.5), 0.6, 0.4), with_coat(varnish(0.5), 1, 0.4), seen_at(0.3), 9),
      6);
}

TEST_F(MaterialsSampling, WeightsAndDensitiesAreThoseOfTheEvaluation) {
  for (const Setting& s : test_support::material_settings())
    for (const double cosine : kViewerCosines) {
      if (s.lobes.only_diffuse()) continue;  // its weight is the reflectance, without a quotient
      BsdfConfig config;
      config.lobes = s.lobes;
      const MonoPoint point = seen_at(cosine);
      const std::vector<MonoSample> samples = sample_all(config, s.material, point, random_numbers(2048, 11));
      std::vector<Vector> directions;
      for (const MonoSample& sample : samples) directions.push_back(sample.direction);
      const std::vector<MonoValue> values = evaluate_all(config, s.material, point, directions);
      int compared = 0;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (samples[i].pdf == 0) continue;
        ++compared;
        ASSERT_EQ(samples[i].pdf, values[i].pdf) << s.name << " " << cosine;
        const double inverse = 1 / samples[i].pdf;
        ASSERT_EQ(samples[i].weight.x, values[i].value.x * inverse) << s.name << " " << cosine;
        ASSERT_EQ(samples[i].weight.y, values[i].value.y * inverse) << s.name << " " << cosine;
        ASSERT_EQ(samples[i].weight.z, values[i].value.z * inverse) << s.name << " " << cosine;
      }
      EXPECT_GT(compared, 10) << s.name << " " << cosine;
    }
}

TEST_F(MaterialsSampling, WeightsAreBounded) {
  for (const Setting& s : test_support::material_settings())
    for (const double cosine : kViewerCosines) {
      BsdfConfig config;
      config.lobes = s.lobes;
      for (const MonoSample& sample :
           sample_all(config, s.material, seen_at(cosine), random_numbers(1 << 15, 12))) {
        const double largest = std::max({sample.weight.x, sample.weight.y, sample.weight.z});
        // Leaving glass brings eta^2. What narrow metal scatters several times comes at grazing angles.
        const bool narrow = s.lobes.glossy && s.material.roughness < 0.3;
        const bool leaves = s.lobes.transmissive() && s.material.eta < 1;
        ASSERT_LE(largest, narrow   ? 30.0
                           : leaves ? 2.3
                                    : 4.0)
            << s.name << " " << s.material.roughness << " " << cosine;
        ASSERT_GE(std::min({sample.weight.x, sample.weight.y, sample.weight.z}), 0.0) << s.name;
      }
    }
}

TEST_F(MaterialsSampling, DiffuseAloneIsTheSampleOfTheCosine) {
  BsdfConfig config;
  config.lobes.diffuse = true;
  const MonoPoint point = seen_at(0.6);
  const std::vector<Numbers> numbers = random_numbers(1024, 13);
  const std::vector<MonoSample> samples = sample_all(config, varnish(0.5), point, numbers);
  std::vector<Vector> expected(numbers.size());
  run([&] {
    const auto lanes = [&](auto member) {
      return cn::poly<double>(
          cn::each_lane<double>([&](int i) { return member(numbers[std::size_t(cn::strip.first_pe + i)]); }));
    };
    const path_tracer::Direction3 direction =
        path_tracer::sample_cosine(poly_direction(point.normal), lanes([](const Numbers& n) { return n.u; }),
                                   lanes([](const Numbers& n) { return n.v; }));
    for (int i = 0; i < cn::kStripLanes; ++i)
      expected[std::size_t(cn::strip.first_pe + i)] = {direction.x.lanes()[i], direction.y.lanes()[i],
                                                       direction.z.lanes()[i]};
  });
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].direction.x, expected[i].x);
    EXPECT_EQ(samples[i].direction.y, expected[i].y);
    EXPECT_EQ(samples[i].direction.z, expected[i].z);
    EXPECT_EQ(samples[i].weight.x, 0.2);
    EXPECT_EQ(samples[i].weight.y, 0.5);
    EXPECT_EQ(samples[i].weight.z, 0.8);
  }
}

/// A purely diffuse surface takes the same way, whatever other lobes the program has.
TEST_F(MaterialsSampling, OtherLobesDoNotMoveDiffuseSamples) {
  MonoMaterial material = varnish(0.5);
  material.f0 = material.f90 = 0;
  const MonoPoint point = seen_at(0.6);
  const std::vector<Numbers> numbers = random_numbers(1024, 14);
  BsdfConfig config;
  config.lobes.diffuse = true;
  const std::vector<MonoSample> alone = sample_all(config, material, point, numbers);
  for (const bool skips : {false, true})
    for (const Lobes& lobes :
         {every_lobe(), lobes_of({&Lobes::diffuse, &Lobes::mirror}),
          lobes_of({&Lobes::diffuse, &Lobes::sheen}), lobes_of({&Lobes::diffuse, &Lobes::glass})}) {
      config.lobes = lobes;
      config.skips_absent_lobes = skips;
      const std::vector<MonoSample> samples = sample_all(config, material, point, numbers);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        ASSERT_EQ(samples[i].direction.x, alone[i].direction.x);
        ASSERT_EQ(samples[i].direction.y, alone[i].direction.y);
        ASSERT_EQ(samples[i].direction.z, alone[i].direction.z);
        ASSERT_NEAR(samples[i].weight.x, alone[i].weight.x, 1e-15);
        ASSERT_NEAR(samples[i].weight.z, alone[i].weight.z, 1e-15);
      }
    }
}

/// A program with every lobe gives each material the samples of the program that has only its own: what is
/// left out is a pure saving.
TEST_F(MaterialsSampling, LobesOfOtherMaterialsChangeNothing) {
  for (const Setting& s : test_support::material_settings()) {
    if (s.lobes.only_diffuse()) continue;  // tested above
    MonoMaterial material = s.material;
    // What the small program does not read, the large one must be told is absent.
    if (!s.lobes.transmissive()) material.transmission = 0;
    if (!s.lobes.coat) material.coat = 0;
    if (!s.lobes.sheen) material.sheen_color = {0, 0, 0};
    if (!s.lobes.specular()) material.f0 = material.f90 = 0;
    if (!s.lobes.diffuse && !s.lobes.specular()) continue;  // sheen alone: the large one has a base
    const std::vector<Numbers> numbers = random_numbers(1024, 18);
    BsdfConfig config;
    config.lobes = s.lobes;
    const std::vector<MonoSample> own = sample_all(config, material, seen_at(0.4), numbers);
    config.lobes = every_lobe();
    const std::vector<MonoSample> all = sample_all(config, material, seen_at(0.4), numbers);
    for (std::size_t i = 0; i < own.size(); ++i) {
      ASSERT_EQ(own[i].direction.x, all[i].direction.x) << s.name;
      ASSERT_EQ(own[i].direction.y, all[i].direction.y) << s.name;
      ASSERT_EQ(own[i].direction.z, all[i].direction.z) << s.name;
      ASSERT_EQ(own[i].is_delta, all[i].is_delta) << s.name;
      ASSERT_NEAR(own[i].weight.x, all[i].weight.x, 1e-14 * own[i].weight.x) << s.name;
      ASSERT_NEAR(own[i].weight.z, all[i].weight.z, 1e-14 * own[i].weight.z) << s.name;
      ASSERT_NEAR(own[i].pdf, all[i].pdf, 1e-14 * own[i].pdf) << s.name;
    }
  }
}

TEST_F(MaterialsSampling, SkippingAbsentLobesChangesNothing) {
  MonoMaterial diffuse = varnish(0.5);
  diffuse.f0 = diffuse.f90 = 0;
  for (const MonoMaterial& material : {mixture(0.5), varnish(0.4), diffuse, with_coat(diffuse, 1, 0.2),
                                       with_coat(metal(0.3), 1, 0.2), with_sheen(glass(0.5, 1.5), 0.4)}) {
    BsdfConfig config;
    config.lobes = every_lobe();
    const MonoPoint point = seen_at(0.5);
    const std::vector<Numbers> numbers = random_numbers(1024, 15);
    const std::vector<MonoSample> all = sample_all(config, material, point, numbers);
    config.skips_absent_lobes = true;
    const std::vector<MonoSample> skipped = sample_all(config, material, point, numbers);
    for (std::size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(all[i].direction.x, skipped[i].direction.x);
      ASSERT_EQ(all[i].weight.y, skipped[i].weight.y);
      ASSERT_EQ(all[i].pdf, skipped[i].pdf);
    }
  }
}

/// Of a metal, hardly any light is scattered several times, and hardly any sample may go that way. Were the
/// shares those of both lobes without the loss in the light's direction, half of the samples would, and the
/// weights' variance would be up to 2.5.
TEST_F(MaterialsSampling, WeightsOfMetalHardlyVary) {
  BsdfConfig config;
  config.lobes = lobes_of({&Lobes::glossy});
  for (const double roughness : {0.2, 0.3, 0.4})
    for (const double cosine : {0.3, 0.7, 1.0}) {
      MonoMaterial material = metal(roughness);
      material.base_color = {1, 1, 1};
      double sum = 0;
      double squares = 0;
      const std::vector<MonoSample> samples =
          sample_all(config, material, seen_at(cosine), random_numbers(1 << 14, 21));
      for (const MonoSample& sample : samples) {
        sum += sample.weight.x;
        squares += sample.weight.x * sample.weight.x;
      }
      const double mean = sum / double(samples.size());
      const double relative_variance = squares / double(samples.size()) / (mean * mean) - 1;
      EXPECT_LT(relative_variance, 0.1) << "roughness " << roughness << ", cosine " << cosine;
    }
}

/// FNV-1a over the bits of samples. After an intended change, copy what the test found.
TEST_F(MaterialsSampling, TheSameBitsAtEveryLevel) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    hash = (hash ^ bits) * 0x100000001b3u;
  };
  for (const Setting& s : test_support::material_settings())
    for (const double cosine : kViewerCosines) {
      BsdfConfig config;
      config.lobes = s.lobes;
      for (const MonoSample& sample :
           sample_all(config, s.material, seen_at(cosine), random_numbers(1024, 16))) {
        for (const double value : {sample.direction.x, sample.direction.y, sample.direction.z}) add(value);
        for (const double value : {sample.weight.x, sample.weight.y, sample.weight.z}) add(value);
      }
    }
  EXPECT_EQ(hash, 16735621742652022649u);
}

/// Equal inputs give equal samples on every PE, whichever strip it is in and whatever its neighbours do.
TEST_F(MaterialsSampling, EveryPeComputesTheSame) {
  BsdfConfig config;
  config.lobes = every_lobe();
  const std::vector<Numbers> few = random_numbers(5, 17);
  std::vector<Numbers> many;
  for (int i = 0; i < 1024; ++i) many.push_back(few[std::size_t(i) % few.size()]);
  const std::vector<MonoSample> samples = sample_all(config, mixture(0.5), seen_at(0.4), many);
  for (std::size_t i = few.size(); i < samples.size(); ++i) {
    const MonoSample& other = samples[i % few.size()];
    ASSERT_EQ(samples[i].direction.x, other.direction.x);
    ASSERT_EQ(samples[i].weight.y, other.weight.y);
    ASSERT_EQ(samples[i].pdf, other.pdf);
    ASSERT_EQ(samples[i].is_delta, other.is_delta);
  }
}

bool is_sound(const MonoSample& s) {
  const auto finite = [](const Vector& v) { return std::isfinite(v.x + v.y + v.z); };
  const double length = std::sqrt(dot(s.direction, s.direction));
  return finite(s.weight) && std::isfinite(s.pdf) && s.pdf >= 0 && s.weight.x >= 0 && s.weight.y >= 0 &&
         s.weight.z >= 0 && std::abs(length - 1) < 1e-6;
}

/// Everything at its limits.
TEST_F(MaterialsSampling, NothingIsInfiniteOrNotANumber) {
  std::vector<Numbers> ends;
  for (const double u : {0.0, 0x1p-33, 0.5, 1 - 0x1p-53})
    for (const double v : {0.0, 0.25, 1 - 0x1p-53})
      for (const double choice : {0.0, 0.3, 0.6, 1 - 0x1p-53}) ends.push_back({u, v, choice});
  std::vector<Vector> lights;
  for (const double z : {1.0, 0.5, 1e-8, 1e-16, 1e-300, 0.0, -1e-16, -0.5, -1.0})
    for (const double around : {0.0, 1.0, kPi}) {
      const double across = std::sqrt(1 - z * z);
      lights.push_back({across * std::cos(around), across * std::sin(around), z});
    }
  const double top = std::numeric_limits<double>::denorm_min();
  for (const double cosine : {0.0, 1e-300, 1e-16, 1e-6, 0.5, 1.0})
    for (const double roughness : {0.0, 1e-8, 1e-3, 0.0101, 0.1, 1.0})
      for (const double eta : {1.0, 1 - 1e-12, 1 + 1e-12, 0.1, 10.0, top})
        for (const double share : {0.0, 0.5, 1.0})
          for (const bool thin_sheet : {false, true}) {
            MonoMaterial material = mixture(roughness);
            material.eta = eta;
            material.transmission = share;
            material.metallic = 1 - share;
            material.coat = share;
            material.coat_roughness = roughness;
            material.sheen_roughness = roughness;
            material.base_color = material.base_color * share;
            material.thin = thin_sheet;
            BsdfConfig config;
            config.lobes = every_lobe();
            MonoPoint point;
            point.to_viewer = {std::sqrt(1 - cosine * cosine), 0, cosine};
            for (const MonoSample& s : sample_all(config, material, point, ends))
              ASSERT_TRUE(is_sound(s)) << cosine << " " << roughness << " " << eta << " " << share;
            for (const MonoValue& v : evaluate_all(config, material, point, lights))
              ASSERT_TRUE(std::isfinite(v.value.x + v.pdf) && v.value.x >= 0 && v.pdf >= 0)
                  << cosine << " " << roughness << " " << eta << " " << share;
          }
}

}  // namespace bsdf_sampling_test
