#include <cmath>
#include <cstring>
#include <limits>

#include "tests/support/chi_square.hpp"
#include "tests/support/material_bench.hpp"
#include "tests/support/statistics.hpp"

/// Samples, densities and values of BSDFs against each other.
namespace materials_sampling_test {

using path_tracer::BsdfConfig;
using path_tracer::Lobes;
using test_support::ChiSquare;
using test_support::MonoMaterial;
using test_support::MonoPoint;
using test_support::MonoSample;
using test_support::MonoValue;
using test_support::Numbers;
using test_support::unit;
using test_support::Vector;

constexpr double kPi = path_tracer::kPi;

struct Setting {
  const char* name;
  Lobes lobes;
  MonoMaterial material;
};

Lobes lobes_of(std::initializer_list<bool Lobes::*> members) {
  Lobes lobes;
  for (bool Lobes::*member : members) lobes.*member = true;
  return lobes;
}

Lobes every_lobe() {
  return lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::mirror, &Lobes::glass, &Lobes::rough_glass,
                   &Lobes::coat, &Lobes::sheen});
}

MonoMaterial metal(double roughness) {
  MonoMaterial material;
  material.metallic = 1;
  material.roughness = roughness;
  material.base_color = {0.9, 0.6, 0.3};
  return material;
}

MonoMaterial varnish(double roughness) {
  MonoMaterial material;
  material.roughness = roughness;
  material.base_color = {0.2, 0.5, 0.8};
  return material;
}

MonoMaterial glass(double roughness, double eta) {
  MonoMaterial material;
  material.transmission = 1;
  material.roughness = roughness;
  material.eta = eta;
  material.base_color = {0.9, 1, 0.8};
  return material;
}

MonoMaterial thin(double roughness) {
  MonoMaterial material = glass(roughness, 1.5);
  material.thin = true;
  return material;
}

MonoMaterial with_coat(MonoMaterial material, double coat, double roughness) {
  material.coat = coat;
  material.coat_roughness = roughness;
  return material;
}

MonoMaterial with_sheen(MonoMaterial material, double roughness) {
  material.sheen_color = {0.7, 0.5, 0.9};
  material.sheen_roughness = roughness;
  return material;
}

/// A bit of everything, so that every lobe is sampled.
MonoMaterial mixture(double roughness) {
  MonoMaterial material = with_sheen(with_coat(varnish(roughness), 0.6, 0.4), 0.6);
  material.metallic = 0.3;
  material.transmission = 0.4;
  return material;
}

std::vector<Setting> settings() {
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
      {"thin frosted sheet", frosted, thin(0.6)},
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
constexpr double kViewerCosines[] = {1, 0.6, 0.1, 0.02};

MonoPoint seen_at(double cosine) {
  const Vector normal = unit({1, 2, -3});
  const Vector tangent = unit(cross(normal, Vector{0.3, 0.1, 1}));
  return {normal, normal * cosine + tangent * std::sqrt(1 - cosine * cosine), normal};
}

/// Cells of the sphere around a pole, small near it, because a narrow lobe is there.
class PolarCells {
 public:
  static constexpr int kRings = 36;
  static constexpr int kSectors = 36;

  /// @param points along each side of a cell
  PolarCells(const Vector& pole, int points)
      : points_(points),
        pole_(pole),
        x_(unit(cross(std::abs(pole.x) < 0.5 ? Vector{1, 0, 0} : Vector{0, 1, 0}, pole))),
        y_(cross(pole, x_)) {}

  std::size_t count() const { return std::size_t(kRings) * kSectors; }

  std::size_t cell_of(const Vector& direction) const {
    const double across = std::hypot(dot(direction, x_), dot(direction, y_));
    const double angle = std::atan2(across, dot(direction, pole_));
    const double around = std::atan2(dot(direction, y_), dot(direction, x_));
    const double sector = around / (2 * kPi) - std::floor(around / (2 * kPi));
    const double from_pole = std::cbrt(std::min(angle, kPi - angle) / (kPi / 2));
    const int ring = static_cast<int>(kRings / 2 * (angle < kPi / 2 ? from_pole : 2 - from_pole));
    return std::size_t(std::min(ring, kRings - 1)) * kSectors +
           std::size_t(std::min(static_cast<int>(sector * kSectors), kSectors - 1));
  }

  struct Point {
    std::size_t cell;
    Vector direction;
    double solid_angle;
  };

  /// Points of the midpoint rule in the two angles.
  std::vector<Point> points() const {
    std::vector<Point> all;
    for (int ring = 0; ring < kRings; ++ring) {
      const double low = ring_angle(ring);
      const double step = (ring_angle(ring + 1) - low) / points_;
      for (int i = 0; i < points_; ++i) {
        const double angle = low + (i + 0.5) * step;
        const double weight = step * 2 * kPi / (kSectors * points_) * std::sin(angle);
        for (int j = 0; j < kSectors * points_; ++j) {
          const double around = 2 * kPi * (j + 0.5) / (kSectors * points_);
          const Vector direction =
              pole_ * std::cos(angle) + (x_ * std::cos(around) + y_ * std::sin(around)) * std::sin(angle);
          all.push_back({std::size_t(ring) * kSectors + std::size_t(j / points_), direction, weight});
        }
      }
    }
    return all;
  }

 private:
  /// Narrow at both poles; one edge is the equator, which is the horizon where the pole is the normal.
  static double ring_angle(int ring) {
    const double share = 2.0 * ring / kRings;
    return share <= 1 ? kPi / 2 * std::pow(share, 3) : kPi - kPi / 2 * std::pow(2 - share, 3);
  }

  int points_;
  Vector pole_;
  Vector x_;
  Vector y_;
};

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
  const double threshold =
      test_support::normal_threshold(test_support::per_test(double(settings().size() * 4)));
  std::uint64_t seed = 100;
  for (const Setting& s : settings())
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
  for (const Setting& s : settings())
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
  for (const Setting& s : settings())
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

TEST_F(MaterialsSampling, SkippingAbsentLobesChangesNothing) {
  for (const MonoMaterial& material :
       {mixture(0.5), varnish(0.4), with_coat(metal(0.3), 1, 0.2), with_sheen(glass(0.5, 1.5), 0.4)}) {
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

/// FNV-1a over the bits of samples. After an intended change, copy what the test found.
TEST_F(MaterialsSampling, TheSameBitsAtEveryLevel) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    hash = (hash ^ bits) * 0x100000001b3u;
  };
  for (const Setting& s : settings())
    for (const double cosine : kViewerCosines) {
      BsdfConfig config;
      config.lobes = s.lobes;
      for (const MonoSample& sample :
           sample_all(config, s.material, seen_at(cosine), random_numbers(1024, 16))) {
        for (const double value : {sample.direction.x, sample.direction.y, sample.direction.z}) add(value);
        for (const double value : {sample.weight.x, sample.weight.y, sample.weight.z}) add(value);
      }
    }
  EXPECT_EQ(hash, 18314856689420599812u);
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

}  // namespace materials_sampling_test
