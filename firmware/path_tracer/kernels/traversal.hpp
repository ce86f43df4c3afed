#pragma once

#include "firmware/path_tracer/kernels/traversal_kernels.hpp"
#include "firmware/path_tracer/tree/node_visitor.hpp"

namespace path_tracer {

/// The part of a TraversalRecord that says where a ray continues, held in registers during a turn.
struct TraversalState {
  poly<std::int32_t> node;
  poly<std::int32_t> level;
  poly<std::int32_t> leaf;
  poly<std::int32_t> leaf_count;
  poly<std::uint64_t> trail;
  poly<std::uint32_t> more;
  poly<std::int32_t> stack_top;
  poly<std::int32_t> stack_count;

  explicit TraversalState(const PolyPointer<TraversalRecord>& record)
      : node(record.get(&TraversalRecord::node)),
        level(record.get(&TraversalRecord::level)),
        leaf(record.get(&TraversalRecord::leaf)),
        leaf_count(record.get(&TraversalRecord::leaf_count)),
        trail(record.get(&TraversalRecord::trail)),
        more(record.get(&TraversalRecord::more)) {
    const poly<std::int32_t> stack = record.get(&TraversalRecord::stack);
    stack_top.assign_all_lanes(stack & poly<std::int32_t>(0xffff));
    stack_count.assign_all_lanes(stack >> 16);
  }

  void write(const PolyPointer<TraversalRecord>& record) const {
    record.set(&TraversalRecord::node, node);
    record.set(&TraversalRecord::level, level);
    record.set(&TraversalRecord::leaf, leaf);
    record.set(&TraversalRecord::leaf_count, leaf_count);
    record.set(&TraversalRecord::trail, trail);
    record.set(&TraversalRecord::more, more);
    record.set(&TraversalRecord::stack, (stack_count << 16) + stack_top);
  }

  mask is_over() const { return (node == kTraversalOver) & (leaf_count == 0); }
};

/// Takes rays from node to node through the nodes in SRAM. TraversalRecord describes the method.
template <NodeFormat format, int width>
class TreeWalker {
 public:
  /// @param treelet first slot of the loaded treelet
  TreeWalker(const TreeInSram& tree, const PolyPointer<TraversalRecord>& record, const NodeRay<format>& ray,
             const poly<std::int32_t>& treelet, TraversalState& state)
      : tree_(tree),
        stack_offset_(record.span().offset_bytes + int{sizeof(TraversalRecord)}),
        visitor_(ray, tree.shape.layout),
        treelet_(treelet),
        state_(state) {}

  /// Walks to the next leaf, to a node that is not in SRAM, to the end, or to the end of the turn.
  void walk() {
    if (tree_.shape.visits == 0) {
      cn::poly_while([&] { return can_step(); }, [&] { step(); });
    } else {
      for (int visit = 0; visit < tree_.shape.visits; ++visit) step();
    }
  }

 private:
  void step() {
    cn::poly_if_any((state_.node == kNextOnStack) & (state_.leaf_count == 0), [&] { pop(); });
    cn::poly_if_any(is_here(state_.node) & (state_.leaf_count == 0), [&] { visit(); });
  }

  mask is_resident(const poly<std::int32_t>& node) const { return node < tree_.shape.resident_nodes; }
  mask is_here(const poly<std::int32_t>& node) const {
    const poly<std::int32_t> in_treelet = node - treelet_;
    return (node >= 0) & (is_resident(node) |
                          ((in_treelet >= 0) & (in_treelet < poly<std::int32_t>(tree_.shape.treelet_nodes))));
  }
  mask can_step() const {
    return (state_.leaf_count == 0) & ((state_.node == kNextOnStack) | is_here(state_.node));
  }
  PolyAddress address(const poly<std::int32_t>& node) const {
    const mask resident = is_resident(node);
    const poly<std::int32_t> index = cn::select(resident, node, node - treelet_);
    const poly<std::int32_t> start = cn::select(resident, poly<std::int32_t>(tree_.resident_offset),
                                                poly<std::int32_t>(tree_.treelet_offset));
    return index * tree_.shape.layout.node_bytes() + start;
  }
  PolyAddress stack_address(const poly<std::int32_t>& place) const { return (place << 3) + stack_offset_; }

  /// Makes the child of `reference` the next.
  void enter(const poly<std::uint32_t>& reference) {
    const poly<std::int32_t> count = cn::reinterpret_word<std::int32_t>(
        (reference >> PackedReference::kFirstBits) & poly<std::uint32_t>(PackedReference::kCountMask));
    const poly<std::int32_t> first =
        cn::reinterpret_word<std::int32_t>(reference & poly<std::uint32_t>(PackedReference::kFirstMask));
    state_.leaf = first;
    state_.leaf_count = count;
    state_.node = cn::select(count > 0, poly<std::int32_t>(kNextOnStack), first);
  }

  void push(const poly<std::uint64_t>& entry) {
    const int wrap = tree_.shape.stack_entries - 1;
    cn::store_at(stack_address(state_.stack_top), entry);
    state_.stack_top = (state_.stack_top + 1) & poly<std::int32_t>(wrap);
    state_.stack_count = cn::min(state_.stack_count + 1, poly<std::int32_t>(wrap + 1));
  }

  void visit() {
    const VisitOrder<width> order = visitor_.visit(address(state_.node));
    poly<std::uint64_t> entry[width];
    for (int i = 0; i < width; ++i) entry[i].assign_all_lanes(order.entry[i]);
    const poly<std::int32_t> trail_shift = state_.level * kTrailBits;
    const poly<std::int32_t> left_behind =
        cn::reinterpret_word<std::int32_t>(cn::low_word(cn::shift_right(state_.trail, trail_shift)) &
                                           poly<std::uint32_t>((1u << kTrailBits) - 1));
    cn::poly_if_any(left_behind > 0, [&] { skip(left_behind, entry); });

    const poly<std::uint64_t> none = NodeRay<format>::kNoEntry;
    const mask has_siblings = entry[1] != none;
    const poly<std::uint32_t> level_bit = cn::low_word(cn::shift_left(poly<std::uint64_t>(1), state_.level));
    state_.more = state_.more | cn::select(has_siblings, level_bit, poly<std::uint32_t>(0u));
    if (tree_.shape.stack_entries > 0) {
      cn::poly_if_any(has_siblings, [&] {
        for (int i = width - 1; i > 0; --i) {
          const mask is_last = i + 1 < width ? entry[i + 1] == none : entry[i] == entry[i];
          const poly<std::uint64_t> flag =
              cn::select(is_last, poly<std::uint64_t>(PackedReference::kFlag), poly<std::uint64_t>(0u));
          cn::poly_if(entry[i] != none, [&] { push(entry[i] | flag); });
        }
      });
    }
    const mask goes_down = entry[0] != none;
    cn::poly_if(
        goes_down,
        [&] {
          enter(cn::low_word(entry[0]));
          state_.level = state_.level + 1;
        },
        [&] { state_.node = kNextOnStack; });
  }

  /// Removes the children that the trail has passed.
  static void skip(const poly<std::int32_t>& left_behind, poly<std::uint64_t> (&entry)[width]) {
    for (int skipped = 0; skipped < width; ++skipped)
      cn::poly_if(left_behind > skipped, [&] {
        for (int i = 0; i + 1 < width; ++i) entry[i] = entry[i + 1];
        entry[width - 1] = NodeRay<format>::kNoEntry;
      });
  }

  /// Continues with the next sibling on the deepest level that has one: from the short stack, or again from
  /// the root.
  void pop() {
    cn::poly_if(
        state_.more == poly<std::uint32_t>(0u), [&] { state_.node = kTraversalOver; },
        [&] {
          const poly<std::int32_t> level = cn::highest_bit(state_.more);
          const poly<std::uint64_t> one = cn::shift_left(poly<std::uint64_t>(1), level * kTrailBits);
          state_.trail = (state_.trail & ((one << kTrailBits) - std::uint64_t{1})) + one;
          cn::poly_if(
              state_.stack_count > 0, [&] { take_from_stack(level); },
              [&] {
                state_.node = 0;
                state_.level = 0;
                state_.more = 0u;
              });
        });
  }

  void take_from_stack(const poly<std::int32_t>& level) {
    const poly<std::int32_t> wrap = tree_.shape.stack_entries - 1;
    state_.stack_top = (state_.stack_top - 1) & wrap;
    state_.stack_count = state_.stack_count - 1;
    state_.level = level + 1;
    const poly<std::uint64_t> entry = cn::load_at<std::uint64_t>(stack_address(state_.stack_top));
    const poly<std::uint32_t> reference = cn::low_word(entry);
    const mask is_last = (reference & poly<std::uint32_t>(PackedReference::kFlag)) != poly<std::uint32_t>(0u);
    const poly<std::uint32_t> level_bit = cn::low_word(cn::shift_left(poly<std::uint64_t>(1), level));
    state_.more = state_.more - cn::select(is_last, level_bit, poly<std::uint32_t>(0u));
    cn::poly_if(visitor_.reaches(entry), [&] { enter(reference); });
  }

  static constexpr int kTrailBits = trail_bits(width);

  const TreeInSram& tree_;
  int stack_offset_;
  NodeVisitor<format, width> visitor_;
  poly<std::int32_t> treelet_;
  TraversalState& state_;
};

}  // namespace path_tracer
