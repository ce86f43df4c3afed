// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/kernels/large_packet_kernels.hpp"

#include "firmware/cn/language/exact.hpp"
#include "firmware/cn/language/least.hpp"
#include "firmware/path_tracer/tree/mono_slabs.hpp"

namespace path_tracer {
namespace {

constexpr std::int32_t kTopBound = 0x7fffffff;

/// Returns the upper kBoundBits of a double, so that greater numbers have greater ones: a negative number's
/// bits are inverted, a positive number's sign is set.
poly<std::int32_t> bound_of(const poly<double>& a) {
  const poly<std::int32_t> high = signed_high_word(a);
  const poly<std::int32_t> inverted =
      (high >> 31) | poly<std::int32_t>(std::numeric_limits<std::int32_t>::min());
  return ((high ^ inverted) >> 1) & poly<std::int32_t>(kTopBound);
}

PolyField<std::int32_t> bound_field(PolyField<std::int32_t> first, int number) {
  return {first.offset_bytes + number * int{sizeof(std::int32_t)}};
}

void lower_bound(const BoundArguments& arguments, int number, const poly<std::int32_t>& value) {
  const PolyField<std::int32_t> field = bound_field(arguments.bounds, number);
  field.write(arguments.is_first ? value : cn::min(field.read(), value));
}

void bound(const BoundArguments& arguments) {
  const Point3 origin = arguments.record.get(&TraversalRecord::origin);
  const Direction3 minus_inverse = arguments.packet.get(&PacketRecord::minus_inverse);
  for (int axis = 0; axis < kAxes; ++axis) {
    const poly<std::int32_t> from = bound_of(component(origin, axis));
    const poly<std::int32_t> scale = bound_of(component(minus_inverse, axis));
    lower_bound(arguments, 4 * axis, from);
    lower_bound(arguments, 4 * axis + 1, kTopBound - from);
    lower_bound(arguments, 4 * axis + 2, scale);
    lower_bound(arguments, 4 * axis + 3, kTopBound - scale);
  }
}

void keep_bounds(const KeepBoundsArguments& arguments) {
  for (int i = 0; i < kPacketBounds; ++i)
    cn::keep_least(bound_field(arguments.bounds, i).read(), kBoundBits, arguments.least[i]);
}

void meet(const MeetArguments& arguments) {
  const MonoNode& node = *arguments.node;
  const Point3 origin = arguments.record.get(&TraversalRecord::origin);
  const Direction3 minus_inverse = arguments.packet.get(&PacketRecord::minus_inverse);
  const poly<std::int32_t> limit = arguments.packet.get(&PacketRecord::limit);
  poly<std::int32_t> key[kMaxNodeWidth];
  poly<std::int32_t> first = kNotMet;
  for (int four = 0; four < node.children; four += 4) {
    const Slabs4 slabs(node.four[four / 4], origin, minus_inverse);
    for (int i = 0; i < 4 && four + i < node.children; ++i) {
      const Slabs box = slabs_of(slabs, std::size_t(i));
      const poly<std::int32_t> entry = signed_high_word(box.entry);
      const mask met = (box.entry <= box.exit) & (entry <= limit);
      key[four + i].assign_all_lanes(cn::select(met, entry, poly<std::int32_t>(kNotMet)));
      first.assign_all_lanes(cn::min(first, key[four + i]));
      cn::keep(met, arguments.meets[four + i]);
    }
  }
  const mask meets_any = first != poly<std::int32_t>(kNotMet);
  for (int i = 0; i < node.children; ++i) cn::keep((key[i] == first) & meets_any, arguments.enters_first[i]);
}

/// The same numbers as in `meet`, the axes side by side.
void meet_child(const MeetChildArguments& arguments) {
  const auto side_by_side = [](const vec3<poly<double>>& v) { return poly4<double>{v.x, v.y, v.z, v.z}; };
  const poly4<double> origin = side_by_side(arguments.record.get(&TraversalRecord::origin));
  const poly4<double> scale = side_by_side(arguments.packet.get(&PacketRecord::minus_inverse));
  const poly4<double> a = (origin - arguments.lower) * scale;
  const poly4<double> b = (origin - arguments.upper) * scale;
  const poly<double> entry = from_origin(cn::min(a[0], b[0]), cn::min(a[1], b[1]), cn::min(a[2], b[2]));
  const poly<double> exit = cn::min(cn::min(cn::max(a[0], b[0]), cn::max(a[1], b[1])), cn::max(a[2], b[2]));
  cn::keep((entry <= exit) & (signed_high_word(entry) <= arguments.packet.get(&PacketRecord::limit)),
           *arguments.meets);
}

}  // namespace

inline namespace CN_LEVEL {

const LargePacketKernels& large_packet_kernel_table() {
  static constexpr LargePacketKernels table{
      cn::kernel<BoundArguments, bound>("bound_packet"),
      cn::kernel<KeepBoundsArguments, keep_bounds>("keep_bounds"),
      cn::kernel<MeetArguments, meet>("meet"),
      cn::kernel<MeetChildArguments, meet_child>("meet_child"),
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
