#pragma once

#include <algorithm>
#include <cstring>

#include "firmware/path_tracer/geometry/sieve_ray.hpp"

/// Brute force as the host carries it out: each lane tests the triangles that its ray may cross, which are a
/// few of all. What comes out is the same to the bit, and so is what the PEs issue, which test them all.
namespace path_tracer {

/// Bit `bit` of each byte, the first byte's lowest.
inline std::uint64_t bit_of_each(const std::uint8_t (&bytes)[64], int bit) {
  std::uint64_t bits = 0;
#if defined(__AVX2__)
  for (int half = 0; half < 2; ++half) {
    const __m256i from = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes) + half);
    bits |= std::uint64_t{unsigned(_mm256_movemask_epi8(_mm256_slli_epi16(from, 7 - bit)))} << (32 * half);
  }
#else
  for (int part = 0; part < 4; ++part) {
    const __m128i from = _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes) + part);
    bits |= std::uint64_t{unsigned(_mm_movemask_epi8(_mm_slli_epi16(from, 7 - bit)))} << (16 * part);
  }
#endif
  return bits;
}

/// Up to 64 triangles, a bit each, for every lane.
class Candidates {
 public:
  static constexpr int kTriangles = 64;

  /// @param lanes of each triangle, bits in the order of floats; of triangles that there are not, none
  explicit Candidates(const std::uint8_t (&lanes)[kTriangles]) {
    for (int lane = 0; lane < cn::kStripLanes; ++lane)
      of_lane_[lane] = bit_of_each(lanes, cn::place_of_lane<float>(lane));
  }
  bool any() const {
    std::uint64_t all = 0;
    for (const std::uint64_t triangles : of_lane_) all |= triangles;
    return all != 0;
  }
  /// Lanes that have one left.
  mask left() const {
    const auto triangles = cn::load_lanes<std::uint64_t>(of_lane_);
    return mask(cn::compare_lanes<cn::Comparison::not_equal>(triangles, cn::broadcast(std::uint64_t{0})));
  }
  /// Takes the lane's first; any of the triangles when it has none left.
  int take(int lane) {
    std::uint64_t& triangles = of_lane_[lane];
    const int first = triangles != 0 ? __builtin_ctzll(triangles) : 0;
    triangles &= triangles - 1;
    return first;
  }

 private:
  std::uint64_t of_lane_[cn::kStripLanes];
};

/// A triangle for each lane.
class LaneTriangles {
 public:
  LaneTriangles(const TriangleRecord* first, Candidates& candidates) {
    for (int lane = 0; lane < cn::kStripLanes; ++lane) at_[lane] = first + candidates.take(lane);
  }
  /// All but the face.
  PolyTriangle load() const {
    return {vector(&TriangleRecord::vertex), vector(&TriangleRecord::edge1),
            vector(&TriangleRecord::edge2),  vector(&TriangleRecord::back),
            poly<std::int32_t>(kNoFace),     integer(&TriangleRecord::number)};
  }

 private:
  /// Chunk by chunk, so that values go from memory to a register and not by way of another place in memory.
  template <class Lane, class Of>
  static cn::Lanes<Lane> gather(const Of& of) {
    return cn::each_chunk<Lane>(
        [&](int i) { return gather_chunk<Lane>(of, i, std::make_index_sequence<kInChunk>()); });
  }
  static constexpr std::size_t kInChunk = cn::Lanes<double>::kChunkBytes / sizeof(double);
  template <class Lane, class Of, std::size_t... lane>
  static typename cn::Lanes<Lane>::Chunk gather_chunk(const Of& of, int chunk, std::index_sequence<lane...>) {
    return typename cn::Lanes<Lane>::Chunk{of(std::size_t(chunk) * kInChunk + lane)...};
  }
  vec3<poly<double>> vector(vec3<double> TriangleRecord::*field) const {
    const auto component = [&](double vec3<double>::*of) {
      return poly<double>(gather<double>([&](std::size_t lane) { return at_[lane]->*field.*of; }));
    };
    return {component(&vec3<double>::x), component(&vec3<double>::y), component(&vec3<double>::z)};
  }
  poly<std::int32_t> integer(std::int32_t TriangleRecord::*field) const {
    return poly<std::int32_t>(
        gather<std::int64_t>([&](std::size_t lane) { return std::int64_t{at_[lane]->*field}; }));
  }

  const TriangleRecord* at_[cn::kStripLanes];
};

/// Triangles that the control unit hands to all PEs one after the other.
struct SiftedTriangles : MonoTriangles {
  const TriangleSieve* sieve;  ///< or nothing, then each is tested
};

/// Lanes whose rays may cross each of `count` triangles, at most Candidates::kTriangles.
inline Candidates sift(const SieveRay& ray, const SieveTriangle* first, int count) {
  const unsigned enabled = sieve_detail::in_order_of_floats(cn::mask_bits(cn::strip.enabled));
  std::uint8_t lanes[Candidates::kTriangles];
  for (int i = 0; i < count; ++i) lanes[i] = std::uint8_t(ray.may_cross(first[i]) & enabled);
  std::memset(lanes + count, 0, std::size_t(Candidates::kTriangles - count));
  return Candidates(lanes);
}

/// What search_fast() finds, by the tests that may matter.
template <class Found>
mask search_sifted(const RayOperands& ray, const SiftedTriangles& all, Found& nearest) {
  const SieveRay sieve_ray(ray, *all.sieve);
  mask tied(cn::mask_from_bits(0));
  for (int first = 0; first < all.count; first += Candidates::kTriangles) {
    Candidates candidates = sift(sieve_ray, all.sieve->triangles.data() + first,
                                 std::min(Candidates::kTriangles, all.count - first));
    while (candidates.any()) {
      const mask left = candidates.left();
      const PolyTriangle triangle = LaneTriangles(all.first + first, candidates).load();
      const Crossing crossing(ray, triangle);
      tied = tied | take_nearer(crossing, triangle, left & crossing.inside, nearest);
    }
  }
  return tied;
}

/// Each PE tests each triangle, which is issued for one of them as often as there are.
template <class Found>
mask search_fast(const RayOperands& ray, const SiftedTriangles& all, Found& nearest) {
  const MonoTriangles& triangles = all;
  if (all.sieve == nullptr || all.count == 0) return search_fast(ray, triangles, nearest);
  if (!cn::issue_is_known())
    cn::issue_times(std::uint64_t(all.count), [&] {
      Found unused = nearest;
      search_fast(ray, MonoTriangles{triangles.first, 1}, unused);
    });
  mask tied;
  cn::issue_nothing([&] { tied = search_sifted(ray, all, nearest); });
  return tied;
}

}  // namespace path_tracer
