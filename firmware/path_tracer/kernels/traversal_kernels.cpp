// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/kernels/traversal_kernels.hpp"

#include "firmware/cn/language/exact.hpp"
#include "firmware/cn/language/indexed.hpp"
#include "firmware/cn/language/least.hpp"
#include "firmware/path_tracer/geometry/nearest_face.hpp"
#include "firmware/path_tracer/kernels/places.hpp"
#include "firmware/path_tracer/kernels/traverse_kernels.hpp"

namespace path_tracer {
namespace {

void enqueue(const EnqueueArguments& arguments) {
  arguments.ray.set(&QueuedRay::slot, arguments.slots != nullptr ? arguments.slots->read()
                                                                 : cn::pe_num() + arguments.first_slot);
  arguments.ray.set(&QueuedRay::light, light_number(arguments.light_place.read(), arguments.lights));
  arguments.place.write(place_of(arguments.first_place, arguments.number.read(), sizeof(QueuedRay)));
}

void take_rays(const TakeRaysArguments& arguments) {
  const poly<std::int32_t> number = arguments.number.read();
  arguments.place.write(place_of(arguments.first_place, number, sizeof(QueuedRay)));
  cn::keep(number < poly<std::int32_t>(arguments.rays), *arguments.takes);
}

void enter(const EnterArguments& arguments) {
  const PolyPointer<RayRecord> ray = arguments.ray.part(&QueuedRay::ray);
  const PolyPointer<TraversalRecord>& record = arguments.record;
  const poly<std::int32_t> light_face = ray.get(&RayRecord::light_face);
  const mask seeks_light = light_face != poly<std::int32_t>(kNoFace);
  record.set(&TraversalRecord::origin, ray.get(&RayRecord::origin));
  record.set(&TraversalRecord::direction, ray.get(&RayRecord::direction));
  record.set(&TraversalRecord::left_face, ray.get(&RayRecord::left_face));
  record.set(&TraversalRecord::light_face, light_face);
  record.set(&TraversalRecord::slot, arguments.ray.get(&QueuedRay::slot));
  record.set(&TraversalRecord::leaf,
             arguments.ray.get(&QueuedRay::light) * kLightRun + arguments.first_light_run);
  record.set(&TraversalRecord::leaf_count,
             cn::select(seeks_light, poly<std::int32_t>(kLightRun), poly<std::int32_t>(0)));
  const Nearest none;
  record.set(&TraversalRecord::distance, none.distance);
  record.set(&TraversalRecord::determinant, none.determinant);
  record.set(&TraversalRecord::number, none.number);
  const poly<std::int32_t> zero = 0;
  record.set(&TraversalRecord::node, zero);
  record.set(&TraversalRecord::level, zero);
  record.set(&TraversalRecord::trail, poly<std::uint64_t>(0u));
  record.set(&TraversalRecord::more, poly<std::uint32_t>(0u));
  record.set(&TraversalRecord::stack, zero);
  arguments.treelet.write(poly<std::int32_t>(kNoTreelet));
}

/// Returns the node that a ray is likely to need next; a node on the stack may still be culled.
poly<std::int32_t> next_node(const LocateArguments& arguments, const poly<std::int32_t>& node) {
  const PolyPointer<TraversalRecord>& record = arguments.record;
  poly<std::int32_t> next(node.lanes());
  cn::poly_if(node == kNextOnStack, [&] {
    next = cn::select(record.get(&TraversalRecord::more) == poly<std::uint32_t>(0u),
                      poly<std::int32_t>(kTraversalOver), poly<std::int32_t>(0));
    const int entries = arguments.shape.stack_entries;
    if (entries == 0) return;
    const poly<std::int32_t> stack = record.get(&TraversalRecord::stack);
    cn::poly_if((stack >> 16) > 0, [&] {
      const poly<std::int32_t> place = (stack - 1) & poly<std::int32_t>(entries - 1);
      const poly<std::uint32_t> reference = cn::low_word(cn::load_at<std::uint64_t>(
          (place << 3) + (record.span().offset_bytes + int{sizeof(TraversalRecord)})));
      constexpr std::uint32_t kCount = PackedReference::kCountMask << PackedReference::kFirstBits;
      const mask is_node = (reference & poly<std::uint32_t>(kCount)) == poly<std::uint32_t>(0u);
      next = cn::select(
          is_node,
          cn::reinterpret_word<std::int32_t>(reference & poly<std::uint32_t>(PackedReference::kFirstMask)),
          poly<std::int32_t>(kTraversalOver));
    });
  });
  return next;
}

void locate(const LocateArguments& arguments) {
  const PolyPointer<TraversalRecord>& record = arguments.record;
  const TreeShape& shape = arguments.shape;
  const mask has_leaf = record.get(&TraversalRecord::leaf_count) > 0;
  arguments.leaf_place.write(place_of(arguments.triangles, record.get(&TraversalRecord::leaf),
                                      static_cast<std::size_t>(arguments.triangle_bytes)));

  const poly<std::int32_t> next = next_node(arguments, record.get(&TraversalRecord::node));
  const mask elsewhere = next >= poly<std::int32_t>(shape.resident_nodes);
  const poly<double> beyond = cn::convert<double>(next - shape.resident_nodes) + 0.5;
  const poly<std::int32_t> treelet = cn::convert<std::int32_t>(beyond * (1.0 / shape.treelet_nodes));
  const poly<std::int32_t> first = treelet * shape.treelet_nodes + shape.resident_nodes;
  arguments.treelet.write(cn::select(elsewhere, first, poly<std::int32_t>(kNoTreelet)));
  arguments.treelet_place.write(
      place_of(arguments.nodes, first, static_cast<std::size_t>(shape.layout.node_bytes())));
  cn::keep(has_leaf, *arguments.needs_leaf);
  cn::keep(elsewhere, *arguments.needs_treelet);
}

void finish(const FinishArguments& arguments) {
  const PolyPointer<TraversalRecord>& record = arguments.record;
  Nearest nearest;
  nearest.distance.assign_all_lanes(record.get(&TraversalRecord::distance));
  nearest.determinant.assign_all_lanes(record.get(&TraversalRecord::determinant));
  nearest.number.assign_all_lanes(record.get(&TraversalRecord::number));
  write_hit(nearest, record.get(&TraversalRecord::origin), record.get(&TraversalRecord::direction),
            arguments.hit, arguments.hit_has_tail);
  const poly<MonoAddress> place = place_of(arguments.surfaces, nearest.number);
  arguments.surface_place.write(cn::select(nearest.number >= 0, place, poly<MonoAddress>(0u)));
  const poly<std::int32_t> slot = record.get(&TraversalRecord::slot);
  arguments.hit_to.write(place_of(arguments.hits, slot));
  arguments.surface_place_to.write(place_of(arguments.surface_places, slot, sizeof(MonoAddress)));
}

void append_rays(const AppendRaysArguments& arguments) {
  const poly<std::int32_t> behind = arguments.number.read() + arguments.tail;
  const mask wraps = behind >= poly<std::int32_t>(arguments.capacity);
  arguments.place.write(place_of(arguments.bin, cn::select(wraps, behind - arguments.capacity, behind),
                                 static_cast<std::size_t>(arguments.record_bytes)));
}

void recall(const RecallArguments& arguments) {
  cn::keep(arguments.surface_place.read() != poly<MonoAddress>(0u), *arguments.hit_something);
}

void least(const LeastArguments& arguments) {
  cn::keep_least(arguments.value.read(), arguments.bits, *arguments.least);
}

void equal(const EqualArguments& arguments) {
  cn::keep(arguments.value.read() == poly<std::int32_t>(arguments.wanted), *arguments.equal);
}

/// Each word is fetched as an operand, brought into a register and stored.
void broadcast(const BroadcastArguments& arguments) {
  for (int i = 0; i < arguments.words; ++i) {
    cn::issue(cn::InstructionClass::mono, 2);
    cn::issue(cn::InstructionClass::move);
    const PolyField<std::uint64_t> to{arguments.to_offset + i * int{sizeof(std::uint64_t)}};
    to.write(poly<std::uint64_t>(arguments.word[i]));
  }
}

void append_to_blocks(const AppendToBlocksArguments& arguments) {
  if (arguments.rays == 1) {
    arguments.place.write(poly<MonoAddress>(arguments.address));
    return;
  }
  const auto record_bytes = static_cast<std::size_t>(arguments.record_bytes);
  const poly<std::int32_t> number = arguments.number.read();
  const poly<MonoAddress> place = place_of(arguments.address, number, record_bytes);
  if (arguments.room >= arguments.rays) {
    arguments.place.write(place);
  } else {
    const mask fits = number < poly<std::int32_t>(arguments.room);
    arguments.place.write(
        cn::select(fits, place, place_of(arguments.next_address, number - arguments.room, record_bytes)));
  }
}

}  // namespace

inline namespace CN_LEVEL {

const TraversalKernels& traversal_kernel_table() {
  static const TraversalKernels table{
      cn::kernel<EnqueueArguments, enqueue>("enqueue"),
      cn::kernel<TakeRaysArguments, take_rays>("take_rays"),
      cn::kernel<EnterArguments, enter>("enter"),
      cn::kernel<LocateArguments, locate>("locate"),
      {traverse_kernel_table<2>(), traverse_kernel_table<4>(), traverse_kernel_table<8>()},
      cn::kernel<FinishArguments, finish>("finish"),
      cn::kernel<AppendRaysArguments, append_rays>("append_rays"),
      cn::kernel<RecallArguments, recall>("recall"),
      cn::kernel<LeastArguments, least>("least"),
      cn::kernel<EqualArguments, equal>("equal"),
      cn::kernel<BroadcastArguments, broadcast>("broadcast"),
      cn::kernel<AppendToBlocksArguments, append_to_blocks>("append_to_blocks"),
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
