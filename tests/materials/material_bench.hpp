#pragma once

#include <cmath>
#include <initializer_list>
#include <random>
#include <vector>

#include "firmware/path_tracer/materials/absorption.hpp"
#include "firmware/path_tracer/materials/sample_bsdf.hpp"
#include "tests/support/strip_fixture.hpp"

/// BSDFs of whole arrays of directions, for tests that look at them as mathematicians do.
namespace test_support {

using Vector = cn::vec3<double>;

inline Vector unit(const Vector& v) {
  return v * (1.0 / std::sqrt(dot(v, v)));
}

/// path_tracer::Material, the same for all PEs; an opaque white varnished surface unless said otherwise.
struct MonoMaterial {
  Vector base_color{1, 1, 1};
  double metallic = 0;
  double roughness = 0.5;
  double f0 = 0.04;
  double f90 = 1;
  double transmission = 0;
  double eta = 1.5;
  bool thin = false;
  double coat = 0;
  double coat_roughness = 0;
  Vector sheen_color{0, 0, 0};
  Vector varnish_tint{1, 1, 1};
  Vector transmission_color{1, 1, 1};
  double sheen_roughness = 0.5;
};

struct MonoPoint {
  Vector normal{0, 0, 1};
  Vector to_viewer{0, 0, 1};
  Vector geometric_normal{0, 0, 1};
};

/// Unit length, at this cosine from the z axis.
inline Vector at_angle(double cosine, double around) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(around), sine * std::sin(around), cosine};
}

/// A surface that faces +z.
inline MonoPoint seen_from_above(double cosine) {
  MonoPoint point;
  point.to_viewer = at_angle(cosine, 0.4);
  return point;
}

inline path_tracer::BsdfConfig config_of(std::initializer_list<bool path_tracer::Lobes::*> members) {
  path_tracer::BsdfConfig config;
  for (bool path_tracer::Lobes::*member : members) config.lobes.*member = true;
  return config;
}

struct MonoValue {
  Vector value;
  double pdf;
};

struct MonoSample {
  Vector direction;
  Vector weight;
  double pdf;
  bool is_delta;
  bool transmits;
};

struct Numbers {
  double u;
  double v;
  double choice;
};

class MaterialBench : public StripFixture {
 protected:
  MaterialBench() : StripFixture(1024) {}

  static path_tracer::Material poly_material(const MonoMaterial& m) {
    return {{m.base_color.x, m.base_color.y, m.base_color.z},
            m.metallic,
            m.roughness,
            m.f0,
            m.f90,
            m.transmission,
            m.eta,
            cn::mask(cn::mask_from_bits(m.thin ? 0xff : 0)),
            m.coat,
            m.coat_roughness,
            {m.sheen_color.x, m.sheen_color.y, m.sheen_color.z},
            m.sheen_roughness,
            {m.varnish_tint.x, m.varnish_tint.y, m.varnish_tint.z},
            {m.transmission_color.x, m.transmission_color.y, m.transmission_color.z}};
  }
  static path_tracer::Direction3 poly_direction(const Vector& v) { return {v.x, v.y, v.z}; }

  [[gnu::noinline]] static path_tracer::Bsdf prepare(const path_tracer::BsdfConfig& config,
                                                     const MonoMaterial& material, const MonoPoint& point) {
    return path_tracer::prepare_bsdf(config, poly_material(material),
                                     {poly_direction(point.normal), poly_direction(point.geometric_normal),
                                      poly_direction(point.to_viewer)});
  }
  [[gnu::noinline]] static path_tracer::BsdfValue evaluate(const path_tracer::Bsdf& bsdf,
                                                           const path_tracer::Direction3& to_light) {
    return path_tracer::evaluate_bsdf(bsdf, to_light);
  }
  [[gnu::noinline]] static path_tracer::BsdfSample sample(const path_tracer::Bsdf& bsdf,
                                                          const path_tracer::UniformPair& uniform,
                                                          const cn::poly<double>& choice) {
    return path_tracer::sample_bsdf(bsdf, uniform, choice);
  }

  std::vector<MonoValue> evaluate_all(const path_tracer::BsdfConfig& config, const MonoMaterial& material,
                                      const MonoPoint& point, const std::vector<Vector>& to_light) {
    std::vector<MonoValue> all(to_light.size());
    for (std::size_t first = 0; first < all.size(); first += std::size_t(num_pes()))
      run([&] {
        const path_tracer::Bsdf bsdf = prepare(config, material, point);
        const path_tracer::BsdfValue found =
            evaluate(bsdf, {gather(to_light, first, [](const Vector& v) { return v.x; }),
                            gather(to_light, first, [](const Vector& v) { return v.y; }),
                            gather(to_light, first, [](const Vector& v) { return v.z; })});
        scatter(all, first, [&](MonoValue& to, int lane) {
          to = {{found.value.x.lanes()[lane], found.value.y.lanes()[lane], found.value.z.lanes()[lane]},
                found.pdf.lanes()[lane]};
        });
      });
    return all;
  }

  std::vector<MonoSample> sample_all(const path_tracer::BsdfConfig& config, const MonoMaterial& material,
                                     const MonoPoint& point, const std::vector<Numbers>& numbers) {
    std::vector<MonoSample> all(numbers.size());
    for (std::size_t first = 0; first < all.size(); first += std::size_t(num_pes()))
      run([&] {
        const path_tracer::Bsdf bsdf = prepare(config, material, point);
        const path_tracer::BsdfSample s =
            sample(bsdf,
                   {gather(numbers, first, [](const Numbers& n) { return n.u; }),
                    gather(numbers, first, [](const Numbers& n) { return n.v; })},
                   gather(numbers, first, [](const Numbers& n) { return n.choice; }));
        scatter(all, first, [&](MonoSample& to, int lane) {
          to = {{s.direction.x.lanes()[lane], s.direction.y.lanes()[lane], s.direction.z.lanes()[lane]},
                {s.weight.x.lanes()[lane], s.weight.y.lanes()[lane], s.weight.z.lanes()[lane]},
                s.pdf.lanes()[lane],
                s.is_delta.lanes()[lane] != 0,
                s.transmits.lanes()[lane] != 0};
        });
      });
    return all;
  }

  /// Numbers in (0, 1), a point of the plane and a third one, evenly spread (Kronecker sequence of the
  /// powers of the plastic number's analogue in three dimensions).
  static std::vector<Numbers> even_numbers(std::size_t count) {
    constexpr double kRoot = 1.22074408460575947536;  // x^4 = x + 1
    const double step[3] = {1 / kRoot, 1 / (kRoot * kRoot), 1 / (kRoot * kRoot * kRoot)};
    std::vector<Numbers> all(count);
    const auto fraction = [](double x) { return x - std::floor(x); };
    for (std::size_t i = 0; i < count; ++i) {
      const double n = static_cast<double>(i) + 0.5;
      all[i] = {fraction(n * step[0]), fraction(n * step[1]), fraction(n * step[2])};
    }
    return all;
  }

  static std::vector<Numbers> random_numbers(std::size_t count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return (static_cast<double>(random() >> 32) + 0.5) * 0x1p-32; };
    std::vector<Numbers> all(count);
    for (Numbers& n : all) n.u = uniform(), n.v = uniform(), n.choice = uniform();
    return all;
  }

 private:
  template <class T, class Member>
  static cn::poly<double> gather(const std::vector<T>& all, std::size_t first, Member member) {
    return cn::poly<double>(cn::each_lane<double>([&](int i) {
      const std::size_t at = first + std::size_t(cn::strip.first_pe + i);
      return member(all[std::min(at, all.size() - 1)]);
    }));
  }
  template <class T, class Assign>
  static void scatter(std::vector<T>& all, std::size_t first, Assign assign) {
    for (int i = 0; i < cn::kStripLanes; ++i) {
      const std::size_t at = first + std::size_t(cn::strip.first_pe + i);
      if (at < all.size()) assign(all[at], i);
    }
  }
};

}  // namespace test_support
