// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/kernels/ray_stream_kernels.hpp"

#include <cstddef>

#include "firmware/cn/language/exact.hpp"
#include "firmware/cn/language/indexed.hpp"
#include "firmware/path_tracer/geometry/nearest_face.hpp"
#include "firmware/path_tracer/tree/mono_slabs.hpp"

namespace path_tracer {
namespace {

using Set = poly<std::uint32_t>;

PolyField<std::uint32_t> set_at(const StreamRays& rays, int place) {
  return {rays.sets[place].offset_bytes};
}

constexpr int kOrigin = offsetof(StreamRay, record.origin);
constexpr int kDirection = offsetof(StreamRay, record.direction);
constexpr int kDistance = offsetof(StreamRay, record.distance);
constexpr int kDeterminant = offsetof(StreamRay, record.determinant);
constexpr int kNumberAndLeftFace = offsetof(StreamRay, record.number);
constexpr int kLightFace = offsetof(StreamRay, record.light_face);
constexpr int kMinusInverse = offsetof(StreamRay, packet.minus_inverse);
constexpr int kLimitAndLight = offsetof(StreamRay, packet.limit);
static_assert(offsetof(StreamRay, record.left_face) == kNumberAndLeftFace + 4 && kNumberAndLeftFace % 8 == 0);
static_assert(offsetof(StreamRay, packet.light) == kLimitAndLight + 4 && kLimitAndLight % 8 == 0);
static_assert(kLightFace % 8 == 0, "the lower half of its word");

/// A PE's own ray: that of the lowest bit of a set.
class OwnRay {
 public:
  OwnRay(const StreamRays& rays, const Set& bit)
      : address_(cn::highest_bit(bit) * int{sizeof(StreamRay)} + rays.offset_bytes), record_(address_) {}

  vec3<poly<double>> vector(int offset_bytes) const {
    return {record_.load<double>(offset_bytes), record_.load<double>(offset_bytes + 8),
            record_.load<double>(offset_bytes + 16)};
  }
  poly<double> number(int offset_bytes) const { return record_.load<double>(offset_bytes); }
  poly<std::uint64_t> word(int offset_bytes) const { return record_.load<std::uint64_t>(offset_bytes); }
  poly<std::int32_t> low(int offset_bytes) const {
    return cn::reinterpret_word<std::int32_t>(cn::low_word(word(offset_bytes)));
  }
  void store(int offset_bytes, const poly<std::uint64_t>& word) const {
    cn::store_at(address_ + offset_bytes, word);
  }
  void store(int offset_bytes, const poly<double>& number) const {
    store(offset_bytes, cn::reinterpret<std::uint64_t>(number));
  }
  /// Replaces the lower half of a word.
  void store_low(int offset_bytes, const poly<std::int32_t>& half) const {
    store(offset_bytes,
          cn::join_words({cn::high_word(word(offset_bytes)), cn::reinterpret_word<std::uint32_t>(half)}));
  }

 private:
  poly<std::int32_t> address_;
  cn::IndexedRecord record_;
};

/// Calls `visit(ray, bit)` for the rays of a set: in each pass each PE takes its own next one.
template <class Visit>
void for_each_ray(const StreamRays& rays, const Set& set, Visit&& visit) {
  Set left = set;
  cn::poly_while([&] { return left != Set(0u); },
                 [&] {
                   const Set bit = left & (Set(0u) - left);
                   left = left ^ bit;
                   visit(OwnRay(rays, bit), bit);
                 });
}

void fill_set(const FillSetArguments& arguments) {
  const PolyField<std::uint32_t> root = set_at(arguments.rays, PacketKeys::kRoot);
  const Set bit(1u << arguments.block);
  root.write(arguments.is_first ? bit : root.read() | bit);
}

void filter(const FilterArguments& arguments) {
  const MonoNode& node = *arguments.node;
  const Set set = set_at(arguments.rays, arguments.place).read();
  const Set leader = set & (Set(0u) - set);
  Set child_set[kMaxNodeWidth];
  Set leads[kMaxNodeWidth];
  for (int i = 0; i < node.children; ++i) {
    child_set[i].assign_all_lanes(Set(0u));
    leads[i].assign_all_lanes(Set(0u));
  }
  for_each_ray(arguments.rays, set, [&](const OwnRay& ray, const Set& bit) {
    const Point3 origin = ray.vector(kOrigin);
    const Direction3 minus_inverse = ray.vector(kMinusInverse);
    const poly<std::int32_t> limit = ray.low(kLimitAndLight);
    poly<std::int32_t> key[kMaxNodeWidth];
    poly<std::int32_t> first = kNotMet;
    for (int four = 0; four < node.children; four += 4) {
      const Slabs4 slabs(node.four[four / 4], origin, minus_inverse);
      for (int i = 0; i < 4 && four + i < node.children; ++i) {
        const int child = four + i;
        const Slabs box = slabs_of(slabs, std::size_t(i));
        const poly<std::int32_t> entry = signed_high_word(box.entry);
        const mask met = (box.entry <= box.exit) & (entry <= limit);
        key[child].assign_all_lanes(cn::select(met, entry, poly<std::int32_t>(kNotMet)));
        first.assign_all_lanes(cn::min(first, key[child]));
        child_set[child] = child_set[child] | cn::select(met, bit, Set(0u));
      }
    }
    cn::poly_if_any(bit == leader, [&] {
      for (int i = 0; i < node.children; ++i)
        leads[i] = cn::select((key[i] == first) & (first != poly<std::int32_t>(kNotMet)), bit, Set(0u));
    });
  });
  for (int i = 0; i < node.children; ++i) {
    set_at(arguments.rays, arguments.rays.sets.place(arguments.level, i)).write(child_set[i]);
    cn::keep(child_set[i] != Set(0u), arguments.active[i]);
    cn::keep(leads[i] != Set(0u), arguments.enters_first[i]);
  }
}

/// Writes what a leaf changed, as packets do.
void store_nearest(const OwnRay& ray, const NearestFace& nearest, const poly<std::int32_t>& light_face) {
  ray.store(kDistance, nearest.distance);
  ray.store(kDeterminant, nearest.determinant);
  ray.store_low(kNumberAndLeftFace, nearest.number);
  const poly<std::int32_t> limit =
      signed_high_word(latest_entry(nearest.distance / cn::abs(nearest.determinant)));
  const mask occluded = (light_face != poly<std::int32_t>(kNoFace)) & (nearest.face != light_face);
  ray.store_low(kLimitAndLight, cn::select(occluded, poly<std::int32_t>(kNoMore), limit));
}

/// Rays that have ended since they were filtered take no part.
void test_set(const TestSetArguments& arguments) {
  const Set set = set_at(arguments.rays, arguments.place).read();
  for_each_ray(arguments.rays, set, [&](const OwnRay& own, const Set&) {
    const poly<std::uint64_t> number_and_face = own.word(kNumberAndLeftFace);
    RayOperands ray{own.vector(kOrigin), own.vector(kDirection),
                    cn::reinterpret_word<std::int32_t>(cn::high_word(number_and_face))};
    ray.measure_from_anchor(arguments.layers);
    const poly<std::int32_t> light_face = own.low(kLightFace);
    const poly<std::int32_t> number = cn::reinterpret_word<std::int32_t>(cn::low_word(number_and_face));
    NearestFace nearest;
    nearest.distance.assign_all_lanes(own.number(kDistance));
    nearest.determinant.assign_all_lanes(own.number(kDeterminant));
    nearest.number.assign_all_lanes(number);
    nearest.face.assign_all_lanes(light_face);
    search(ray, arguments.reach,
           MonoTriangles{arguments.triangles, arguments.count, arguments.layers.record_bytes()}, nearest);
    cn::poly_if_any(nearest.number != number, [&] { store_nearest(own, nearest, light_face); });
  });
}

}  // namespace

inline namespace CN_LEVEL {

const RayStreamKernels& ray_stream_kernel_table() {
  static constexpr RayStreamKernels table{
      cn::kernel<FillSetArguments, fill_set>("fill_set"),
      cn::kernel<FilterArguments, filter>("filter"),
      cn::kernel<TestSetArguments, test_set>("test_set"),
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
