// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/kernels/packet_kernels.hpp"

#include "firmware/path_tracer/geometry/nearest_face.hpp"
#include "firmware/path_tracer/tree/mono_slabs.hpp"

namespace path_tracer {
namespace {

void begin(const BeginPacketArguments& arguments) {
  const PolyPointer<TraversalRecord>& record = arguments.record;
  const BoxRay box_ray(record.get(&TraversalRecord::origin), record.get(&TraversalRecord::direction));
  arguments.packet.set(&PacketRecord::minus_inverse, box_ray.minus_inverse());
  arguments.packet.set(&PacketRecord::limit,
                       signed_high_word(poly<double>(std::numeric_limits<double>::infinity())));
  arguments.packet.set(&PacketRecord::light, arguments.ray.get(&QueuedRay::light));
  if (arguments.has_keys) arguments.keys[PacketKeys::kRoot].write(poly<std::int32_t>(0));
  cn::keep(record.get(&TraversalRecord::light_face) != poly<std::int32_t>(kNoFace), *arguments.seeks_light);
}

void want(const WantArguments& arguments) {
  cn::keep(arguments.keys[arguments.place].read() <= arguments.packet.get(&PacketRecord::limit),
           *arguments.wanting);
  if (!arguments.is_node) return;
  for (int i = 0; i < arguments.keys.width(); ++i)
    arguments.keys[arguments.keys.place(arguments.level, i)].write(poly<std::int32_t>(kNotMet));
}

void visit(const VisitArguments& arguments) {
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
      const int child = four + i;
      key[child].assign_all_lanes(
          cn::select((box.entry <= box.exit) & (entry <= limit), entry, poly<std::int32_t>(kNotMet)));
      first.assign_all_lanes(cn::min(first, key[child]));
      arguments.keys[arguments.keys.place(arguments.level, child)].write(key[child]);
    }
  }
  const mask meets_any = first != poly<std::int32_t>(kNotMet);
  for (int i = 0; i < node.children; ++i) cn::keep((key[i] == first) & meets_any, arguments.enters_first[i]);
}

/// Writes what a leaf changed. A shadow ray is finished when something is nearer than its light
/// (traverse.hpp).
void write_nearest(const TestLeafArguments& arguments, const NearestFace& nearest,
                   const poly<std::int32_t>& light_face) {
  const PolyPointer<TraversalRecord>& record = arguments.record;
  record.set(&TraversalRecord::distance, nearest.distance);
  record.set(&TraversalRecord::determinant, nearest.determinant);
  record.set(&TraversalRecord::number, nearest.number);
  const poly<std::int32_t> limit =
      signed_high_word(latest_entry(nearest.distance / cn::abs(nearest.determinant)));
  const mask occluded = (light_face != poly<std::int32_t>(kNoFace)) & (nearest.face != light_face);
  arguments.packet.set(&PacketRecord::limit, cn::select(occluded, poly<std::int32_t>(kNoMore), limit));
}

void test_leaf(const TestLeafArguments& arguments) {
  const PolyPointer<TraversalRecord>& record = arguments.record;
  const RayOperands ray = ray_of(record, arguments.layers);
  const poly<std::int32_t> light_face = record.get(&TraversalRecord::light_face);
  NearestFace nearest;
  nearest.distance.assign_all_lanes(record.get(&TraversalRecord::distance));
  nearest.determinant.assign_all_lanes(record.get(&TraversalRecord::determinant));
  const poly<std::int32_t> number = record.get(&TraversalRecord::number);
  nearest.number.assign_all_lanes(number);
  nearest.face.assign_all_lanes(light_face);
  search(ray, arguments.reach,
         MonoTriangles{arguments.triangles, arguments.count, arguments.layers.record_bytes()}, nearest);
  // A shadow ray that missed its light finds what else it hits, because the light's face may have other
  // triangles.
  record.set(&TraversalRecord::light_face,
             cn::select(nearest.number < 0, poly<std::int32_t>(kNoFace), light_face));
  cn::poly_if_any(nearest.number != number, [&] { write_nearest(arguments, nearest, light_face); });
}

}  // namespace

inline namespace CN_LEVEL {

const PacketKernels& packet_kernel_table() {
  static constexpr PacketKernels table{
      cn::kernel<BeginPacketArguments, begin>("begin_packet"),
      cn::kernel<WantArguments, want>("want"),
      cn::kernel<VisitArguments, visit>("visit"),
      cn::kernel<TestLeafArguments, test_leaf>("test_leaf"),
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
