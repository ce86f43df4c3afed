// The sums by which strategies of bidirectional paths share their light, against the weights that the
// densities of whole paths give.

#include "firmware/path_tracer/bidirectional/weights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/strip_fixture.hpp"

namespace pair_weights_test {

using cn::poly;
using cn::PolyPointer;
using path_tracer::PairRecord;
using path_tracer::Window;
using test_support::load;
using test_support::PerPe;

/// A path x_0 on a light to x_k on the lens: densities by area from both sides without the cosine there,
/// squared lengths of its segments, and where it scatters into more than single directions.
struct Path {
  std::vector<double> from_light;
  std::vector<double> from_eye;
  std::vector<double> squared_length;  ///< [i]: from x_i to x_(i+1)
  std::vector<bool> connects;          ///< true of x_0 and of the lens
  bool light_can_be_hit = true;
  double pixels = 1;

  int last() const { return static_cast<int>(from_light.size()) - 1; }
  bool allows(int s, int light_vertices) const {
    if (s > light_vertices + 1 || s > last()) return false;
    if (s == 0) return light_can_be_hit;
    return connects[std::size_t(s - 1)] && connects[std::size_t(s)];
  }
  /// Of strategy s, over that of strategy 0.
  double density(int s) const {
    double ratio = s == last() ? pixels : 1.0;
    for (int i = 0; i < s; ++i) ratio *= from_light[std::size_t(i)] / from_eye[std::size_t(i)];
    return ratio;
  }
  double weight(int s, int light_vertices) const {
    double sum = 0;
    for (int i = 0; i <= last(); ++i)
      if (allows(i, light_vertices)) sum += std::pow(density(i) / density(s), 2);
    return 1 / sum;
  }
};

class PairWeights : public test_support::StripFixture {
 protected:
  PairWeights() : StripFixture(8) {}

  Path random_path(int k) {
    const auto factor = [&] { return std::exp(std::uniform_real_distribution<double>(-2, 2)(random_)); };
    Path path;
    for (int i = 0; i <= k; ++i) {
      path.from_light.push_back(factor());
      path.from_eye.push_back(factor());
      path.squared_length.push_back(factor());
      path.connects.push_back(i == 0 || i == k || random_() % 4 != 0);
    }
    path.light_can_be_hit = random_() % 4 != 0;
    path.pixels = double(1 + random_() % 50);
    return path;
  }

  /// What a stage writes when the path has a vertex, and its next direction.
  void set_vertex(const PolyPointer<PairRecord>& pair, double inverse_pdf, double squared_length,
                  double reverse_pdf, double connects_before, double connects) {
    pair.set(&PairRecord::inverse_pdf, poly<double>(inverse_pdf));
    pair.set(&PairRecord::distance_squared, poly<double>(squared_length));
    pair.set(&PairRecord::reverse_pdf, poly<double>(reverse_pdf));
    pair.set(&PairRecord::connects_before, poly<double>(connects_before));
    pair.set(&PairRecord::connects, poly<double>(connects));
  }

  /// The sum over strategies that take more from the light than s, by an eye path down to x_s.
  double eye_side(const Path& path, int s, int light_vertices) {
    const path_tracer::PairSizes sizes(path_tracer::Features{}, light_vertices);
    const PolyPointer<PairRecord> pair(0);
    PerPe<double> result = per_pe<double>();
    run([&] {
      const int k = path.last();
      const Window window(pair, sizes, light_vertices);
      window.clear();
      set_vertex(pair, 0, 1, 0, 0, path.pixels * path.pixels);
      double connects = path.pixels * path.pixels;  // of the vertex before
      for (int i = k - 1; i >= s; --i) {
        window.advance(pair);
        const double squared = path.squared_length[std::size_t(i)];
        const double inverse = 1 / path.from_eye[std::size_t(i)];
        const double reverse = path.from_light[std::size_t(i) + 1] * squared;
        if (i == s) {
          const int strategies = light_vertices + 1 - s;
          const bool sees_lens = s == 0 && k == 1;
          const poly<double> sum =
              path_tracer::squared(poly<double>(path.from_light[std::size_t(s)])) *
              path_tracer::sum_from(inverse, connects, reverse, squared,
                                    s == 0 ? window.whole() : window.sum(poly<std::int32_t>(strategies - 1)));
          test_support::store(result, strategies > 0 && !sees_lens ? sum : poly<double>(0.0));
          return;
        }
        const double here = path.connects[std::size_t(i)] ? 1 : 0;
        set_vertex(pair, inverse, squared, reverse, connects, here);
        connects = here;
      }
      test_support::store(result, poly<double>(0.0));
    });
    return result[0];
  }

  /// The sum over strategies that take less from the light than s, by a light path up to x_(s-1).
  double light_side(const Path& path, int s) {
    if (s == 0) return 0;
    const double hit = path.light_can_be_hit ? 1 / path.from_light[0] : 0;
    if (s == 1) return std::pow(hit * path.from_eye[0], 2);
    const PolyPointer<PairRecord> pair(0);
    PerPe<double> result = per_pe<double>();
    run([&] {
      pair.set(&PairRecord::light_sum, poly<double>(0.0));
      set_vertex(pair, 1, 1, 0, hit * hit, 1);
      double connects = 1;
      for (int i = 1;; ++i) {
        pair.set(&PairRecord::light_sum, path_tracer::advanced_light_sum(pair));
        const double squared = path.squared_length[std::size_t(i) - 1];
        const double inverse = 1 / path.from_light[std::size_t(i)];
        const double reverse = path.from_eye[std::size_t(i) - 1] * squared;
        if (i == s - 1) {
          const double to_lens = s == path.last() ? 1 / path.pixels : 1;
          test_support::store(result,
                              path_tracer::squared(poly<double>(path.from_eye[std::size_t(i)] * to_lens)) *
                                  path_tracer::sum_from(inverse, connects, reverse, squared,
                                                        pair.get(&PairRecord::light_sum)));
          return;
        }
        const double here = path.connects[std::size_t(i)] ? 1 : 0;
        set_vertex(pair, inverse, squared, reverse, connects, here);
        connects = here;
      }
    });
    return result[0];
  }

  std::mt19937_64 random_{7};
};

TEST_F(PairWeights, AreThoseOfTheDensitiesOfWholePaths) {
  int allowed = 0;
  for (int k = 2; k <= 9; ++k)
    for (int light_vertices = 1; light_vertices <= 6; ++light_vertices)
      for (int repeat = 0; repeat < 20; ++repeat) {
        const Path path = random_path(k);
        double sum = 0;
        for (int s = 0; s <= k; ++s) {
          if (!path.allows(s, light_vertices)) continue;
          ++allowed;
          const double weight = 1 / (1 + eye_side(path, s, light_vertices) + light_side(path, s));
          sum += weight;
          EXPECT_NEAR(weight, path.weight(s, light_vertices), 1e-12)
              << "strategy " << s << " of a path of " << k << " segments, " << light_vertices
              << " light vertices";
        }
        if (sum > 0) {
          EXPECT_NEAR(sum, 1, 1e-12);
        }
      }
  EXPECT_GT(allowed, 1000);
}

TEST_F(PairWeights, ALightInViewOfTheLensBelongsToTheEyePath) {
  const Path path = random_path(1);
  EXPECT_EQ(eye_side(path, 0, 4), 0);
}

}  // namespace pair_weights_test
