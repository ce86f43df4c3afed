#pragma once

#include <algorithm>
#include <cstring>
#include <iterator>

#include "firmware/cn/language/shortcut.hpp"
#include "firmware/path_tracer/prefilter/prefilter_ray.hpp"

/// Brute force as the simulator executes it: each lane tests only the few triangles that its ray may cross.
/// The PEs test all of them. The result is the same to the bit, and the charge is that of testing all.
namespace path_tracer {

/// Collects bit `bit` of each byte; the first byte's becomes the lowest bit.
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

/// The triangles that remain to be tested, up to 64: one bit a triangle, for each lane.
class Candidates {
 public:
  static constexpr int kTriangles = 64;

  /// @param lanes for each triangle the lanes that may cross it, in the order of floats; 0 behind the last
  /// triangle
  explicit Candidates(const std::uint8_t (&lanes)[kTriangles]) {
    for (int lane = 0; lane < cn::kStripLanes; ++lane)
      of_lane_[lane] = bit_of_each(lanes, cn::place_of_lane<float>(lane));
  }
  bool any() const {
    std::uint64_t all = 0;
    for (const std::uint64_t triangles : of_lane_) all |= triangles;
    return all != 0;
  }
  /// Lanes with a triangle left.
  mask left() const {
    const auto triangles = cn::load_lanes<std::uint64_t>(of_lane_);
    return mask(cn::compare_lanes<cn::Comparison::not_equal>(triangles, cn::broadcast(std::uint64_t{0})));
  }
  /// Takes the lane's first triangle. Without one left, returns any of the triangles.
  int take(int lane) {
    std::uint64_t& triangles = of_lane_[lane];
    const int first = triangles != 0 ? __builtin_ctzll(triangles) : 0;
    triangles &= triangles - 1;
    return first;
  }

 private:
  std::uint64_t of_lane_[cn::kStripLanes];
};

/// One triangle for each lane.
class LaneTriangles {
 public:
  /// @param first index of the candidates' first triangle
  LaneTriangles(const MonoTriangles& triangles, int first, Candidates& candidates) {
    for (int lane = 0; lane < cn::kStripLanes; ++lane) at_[lane] = &triangles(first + candidates.take(lane));
  }
  explicit LaneTriangles(const TriangleRecord* const (&at)[cn::kStripLanes]) {
    std::copy(std::begin(at), std::end(at), at_);
  }
  /// Loads all members but the face.
  PolyTriangle load(bool is_in_layers) const {
    PolyTriangle triangle{vector(&TriangleRecord::vertex), vector(&TriangleRecord::edge1),
                          vector(&TriangleRecord::edge2),  vector(&TriangleRecord::back),
                          poly<std::int32_t>(kNoFace),     integer(&TriangleRecord::number)};
    if (is_in_layers) {
      triangle.plane_offset.assign_all_lanes(number_in_layers(&LayeredTriangleRecord::plane_offset));
      triangle.area_ratio.assign_all_lanes(number_in_layers(&LayeredTriangleRecord::area_ratio));
    }
    return triangle;
  }

 private:
  /// Gathers chunk by chunk, so that values go from memory to a register without a detour through memory.
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
  poly<double> number_in_layers(double LayeredTriangleRecord::*field) const {
    return poly<double>(gather<double>([&](std::size_t lane) { return layered(*at_[lane]).*field; }));
  }
  poly<std::int32_t> integer(std::int32_t TriangleRecord::*field) const {
    return poly<std::int32_t>(
        gather<std::int64_t>([&](std::size_t lane) { return std::int64_t{at_[lane]->*field}; }));
  }

  const TriangleRecord* at_[cn::kStripLanes];
};

/// The triangles that each lane's ray may cross.
/// @param count at most Candidates::kTriangles
inline Candidates prefilter_candidates(const PrefilterRay& ray, const PrefilterTriangle* first, int count) {
  const unsigned enabled = prefilter_detail::in_order_of_floats(cn::mask_bits(cn::strip.enabled));
  std::uint8_t lanes[Candidates::kTriangles];
  for (int i = 0; i < count; ++i) lanes[i] = std::uint8_t(ray.may_cross(first[i]) & enabled);
  std::memset(lanes + count, 0, std::size_t(Candidates::kTriangles - count));
  return Candidates(lanes);
}

/// What search_fast() finds, from the tests whose triangles may be crossed.
template <class Found>
mask search_candidates(const RayOperands& ray, const MonoTriangles& triangles, const Prefilter& prefilter,
                       Found& nearest) {
  const PrefilterRay prefilter_ray(ray, prefilter);
  mask tied(cn::mask_from_bits(0));
  for (int first = 0; first < triangles.count; first += Candidates::kTriangles) {
    Candidates candidates = prefilter_candidates(prefilter_ray, prefilter.triangles.data() + first,
                                                 std::min(Candidates::kTriangles, triangles.count - first));
    while (candidates.any()) {
      const mask left = candidates.left();
      const PolyTriangle triangle = LaneTriangles(triangles, first, candidates).load(ray.is_in_layers);
      const Crossing crossing(ray, triangle);
      tied = tied | take_nearer(crossing, triangle, left & crossing.inside, nearest);
    }
  }
  return tied;
}

/// FastSearch by way of the prefilter: the same result, and the charge of testing every triangle.
struct PrefilteredSearch {
  const Prefilter* prefilter;  ///< of the triangles; nullptr to test each of them

  template <class Found>
  mask operator()(const RayOperands& ray, const MonoTriangles& triangles, Found& nearest) const {
    if (prefilter == nullptr || triangles.count == 0) return search_fast(ray, triangles, nearest);
    const auto charge_every_test = [&] {
      if (cn::is_charged()) return;
      cn::charge_times(std::uint64_t(triangles.count), [&] {
        Found unused = nearest;
        search_fast(ray, MonoTriangles{triangles.first, 1, triangles.record_bytes}, unused);
      });
    };
    return cn::found_another_way(charge_every_test,
                                 [&] { return search_candidates(ray, triangles, *prefilter, nearest); });
  }
};

}  // namespace path_tracer
