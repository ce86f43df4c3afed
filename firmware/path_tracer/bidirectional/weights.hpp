#pragma once

#include "firmware/cn/language/indexed.hpp"
#include "firmware/cn/language/poly_pointer.hpp"
#include "firmware/path_tracer/records/pair_records.hpp"
#include "firmware/path_tracer/sampling/sampling.hpp"

/// How the strategies that can find a path share its light: the power heuristic with exponent 2 (Veach and
/// Guibas, SIGGRAPH 1995) by sums that grow with the paths (Georgiev, "Implementing Vertex Connection and
/// Merging", technical report, Saarland University, 2012, without merging).
///
/// A path x_0 on a light, x_1, ..., x_k on the lens can be found by strategy s, which takes s vertices from
/// the light path and the others from the eye path, where
///   - 0 <= s <= light_vertices + 1, since a slot keeps so many vertices of a light path and the path ends
///     there;
///   - s <= k, since the lens is a point and no light path hits it; of the path from a light straight to the
///     lens only s = 0;
///   - the vertices x_(s-1) and x_s scatter otherwise than into single directions; for s = 0, segments can
///     hit the light.
/// All others have weight 0, and the weights of these are w_s = 1 / sum_i (p_i / p_s)^2. With P(l, x_i) the
/// density of x_i from the light's side and P(e, x_i) that from the lens's, p_(i+1) / p_i = P(l, x_i) /
/// P(e, x_i). Both are densities by area of one surface, so the cosine at x_i cancels: here a density is
/// that of the direction over the squared distance. For parallel light and orthographic lenses the squared
/// distance is 1 and the direction's density that of the ray in its cross section. Roulette is left out, and
/// a single direction has density 1 both ways: weights need be no more than a function of the path.
///
/// For an eye vertex z_j with the vertex z_(j-1) before it, let a_j = 1 / P(e, z_j), d_j their distance, q_j
/// the density at z_j of the direction back to z_(j-1), and c_j 1 where z_j connects, else 0. The sum over
/// the first m of the strategies that take z_j and more from the light is P(l, z_j)^2 T_j(m), with
///   T_j(m) = a_j^2 (c_(j-1) + (q_j / d_j^2)^2 S_(j-1)(m - 1)),   T_j(0) = 0
///   S_j(m) = a_j^2 (c_j c_(j-1) + (q_j / d_j^2)^2 S_(j-1)(m - 1)),   S_j(0) = 0,   S_0 = 0.
/// An eye path of any length so needs S(1) to S(light_vertices) only, its window: the strategies beyond have
/// weight 0 in every sum, which is exact and no cut. The light path's sums have the same form with the sides
/// exchanged and no limit m; S_0 = (cosine / P(l, x_0))^2 where the light can be hit, else 0. A lens sends
/// one path for each sample of a pixel, but all light paths may end in the pixel: c_0 of the lens is the
/// squared number of pixels.
namespace path_tracer {

/// Keeps products of sums finite: c (q / d^2)^2 S must not become 0 * infinity.
inline poly<double> bounded(const poly<double>& a) {
  return cn::min(a, poly<double>(1e60));
}

inline poly<double> squared(const poly<double>& a) {
  return a * a;
}

/// The bracket of T_j with the sum behind it.
/// @param sum S_(j-1)(m - 1)
inline poly<double> sum_from(const poly<double>& inverse_pdf, const poly<double>& connects,
                             const poly<double>& reverse_pdf, const poly<double>& distance_squared,
                             const poly<double>& sum) {
  return bounded(squared(inverse_pdf) * (connects + squared(reverse_pdf / distance_squared) * sum));
}

/// The window of an eye path.
class Window {
 public:
  Window(const cn::PolyPointer<PairRecord>& pair, const PairSizes& sizes, int light_vertices)
      : first_(pair.span().offset_bytes + sizes.window), light_vertices_(light_vertices) {}

  /// S(m). @param m from 0 to light_vertices
  poly<double> sum(const poly<std::int32_t>& m) const {
    const poly<std::int32_t> place = cn::max(m - 1, poly<std::int32_t>(0));
    return cn::select(m > 0, cn::load_at<double>((place << 3) + first_), poly<double>(0.0));
  }
  /// S(light_vertices)
  poly<double> whole() const { return entry(light_vertices_ - 1).read(); }

  void clear() const {
    for (int i = 0; i < light_vertices_; ++i) entry(i).write(poly<double>(0.0));
  }
  /// S_(j-1) becomes S_j.
  void advance(const cn::PolyPointer<PairRecord>& pair) const {
    const poly<double> both = pair.get(&PairRecord::connects) * pair.get(&PairRecord::connects_before);
    const poly<double> inverse_pdf = pair.get(&PairRecord::inverse_pdf);
    const poly<double> reverse_pdf = pair.get(&PairRecord::reverse_pdf);
    const poly<double> distance_squared = pair.get(&PairRecord::distance_squared);
    for (int i = light_vertices_ - 1; i >= 0; --i) {
      const poly<double> before = i > 0 ? entry(i - 1).read() : poly<double>(0.0);
      entry(i).write(sum_from(inverse_pdf, both, reverse_pdf, distance_squared, before));
    }
  }

 private:
  cn::PolyField<double> entry(int i) const { return {first_ + i * int{sizeof(double)}}; }

  int first_;
  int light_vertices_;
};

/// S_(j-1) of a light path becomes S_j.
inline poly<double> advanced_light_sum(const cn::PolyPointer<PairRecord>& pair) {
  return sum_from(pair.get(&PairRecord::inverse_pdf),
                  pair.get(&PairRecord::connects) * pair.get(&PairRecord::connects_before),
                  pair.get(&PairRecord::reverse_pdf), pair.get(&PairRecord::distance_squared),
                  pair.get(&PairRecord::light_sum));
}

}  // namespace path_tracer
