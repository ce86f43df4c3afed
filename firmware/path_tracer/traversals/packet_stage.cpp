#include "firmware/path_tracer/traversals/packet_stage.hpp"

#include <algorithm>

namespace path_tracer {
namespace {

// Instructions of the control unit (assumed): the stack's two words and its pointer, the parts of a
// reference, and a branch. The order of children is a network of comparisons, four instructions each.
constexpr std::uint64_t kPushInstructions = 5;
constexpr std::uint64_t kPopInstructions = 8;
constexpr std::uint64_t kComparisonInstructions = 4;

/// Comparisons of SortingNetwork (node_visitor.hpp).
constexpr int merge_comparisons(int width) {
  return width == 2 ? 1 : 2 * merge_comparisons(width / 2) + width / 2 - 1;
}
constexpr int sort_comparisons(int width) {
  return width < 2 ? 0 : 2 * sort_comparisons(width / 2) + merge_comparisons(width);
}
static_assert(sort_comparisons(8) == 19);

}  // namespace

PacketStage::PacketStage(const StageContext& context, TreeContext& tree)
    : TreeStage(context, tree), packet_kernels_(context.kernels.packet()) {
  cn::PolyMemory& memory = context.machine.poly_memory();
  BufferCutter cutter(memory.allocate("packet", int{sizeof(TraversalRecord)} + int{sizeof(PacketRecord)}));
  record_ = cutter.take<TraversalRecord>();
  packet_ = cutter.take<PacketRecord>();
  const NodeLayout& layout = tree.tree.shape.layout;
  nodes_ = {context.layout.nodes, layout, 1.0 / to_node_unit(layout.format, tree.reach)};
  const int width = layout.width;
  keys_ = PacketKeys(memory.allocate("packet's keys", PacketKeys::bytes(width)), width);
}

void PacketStage::load(std::uint64_t step, int block) {
  load_packed_rays(step, block);
}

void PacketStage::process(std::uint64_t step, int block) {
  rays_ = packed_rays(block);
  enter(step, record_, rays_);
  count_pass(0, rays_);
  test_lights(begin(step));
  walk();
  finish(step, record_, rays_);
}

/// Begins the rays of the packet. Returns the shadow rays.
LaneMask PacketStage::begin(std::uint64_t step) {
  LaneMask seeks_light;
  BeginPacketArguments arguments;
  arguments.ray = loads(step).ray;
  arguments.record = record_;
  arguments.packet = packet_;
  arguments.keys = keys_;
  arguments.seeks_light = &seeks_light;
  context_.machine.run(packet_kernels_.begin, arguments, rays_);
  return seeks_light;
}

/// Tests light by light: a block has few of them, and triangles as mono operands cost no PE a load.
void PacketStage::test_lights(LaneMask seeks_light) {
  while (context_.machine.count(seeks_light) > 0) {
    const std::int32_t light = least_light(seeks_light);
    const LaneMask rays = rays_with_light(light, seeks_light);
    test_leaf(context_.layout.triangle_count + light * kLightRun, kLightRun, rays);
    seeks_light = seeks_light.without(rays);
  }
}

std::int32_t PacketStage::least_light(const LaneMask& rays) {
  std::int32_t least = context_.layout.light_count;
  LeastArguments arguments;
  arguments.value = packet_.field(&PacketRecord::light);
  arguments.bits = bits_of(context_.layout.light_count);
  arguments.least = &least;
  context_.machine.run(kernels_.least, arguments, rays);
  return least;
}

LaneMask PacketStage::rays_with_light(std::int32_t light, const LaneMask& rays) {
  LaneMask equal;
  context_.machine.run(kernels_.equal, EqualArguments{packet_.field(&PacketRecord::light), light, &equal},
                       rays);
  return equal;
}

void PacketStage::walk() {
  stack_.assign(1, {{0, 0}, 0, PacketKeys::kRoot});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    context_.machine.issue_mono(kPopInstructions);
    const LaneMask rays = rays_that_want(entry);
    if (context_.machine.count(rays) == 0) continue;
    if (entry.reference.count > 0) {
      test_leaf(entry.reference.first, entry.reference.count, rays);
    } else {
      visit(entry, rays);
    }
  }
}

/// Asks the rays again, because a ray's limit may have decreased since its key was made.
LaneMask PacketStage::rays_that_want(const Entry& entry) {
  LaneMask wanting;
  WantArguments arguments;
  arguments.packet = packet_;
  arguments.keys = keys_;
  arguments.place = entry.place;
  arguments.is_node = entry.reference.count == 0;
  arguments.level = entry.level;
  arguments.wanting = &wanting;
  context_.machine.run(packet_kernels_.want, arguments, rays_);
  return wanting;
}

void PacketStage::visit(const Entry& entry, const LaneMask& rays) {
  const MonoNode node = read_node(context_.machine, nodes_, entry.reference.first);
  LaneMask enters_first[kMaxNodeWidth];
  VisitArguments arguments;
  arguments.record = record_;
  arguments.packet = packet_;
  arguments.node = &node;
  arguments.keys = keys_;
  arguments.level = entry.level;
  arguments.enters_first = enters_first;
  context_.machine.run(packet_kernels_.visit, arguments, rays);
  push_children(node, entry.level, enters_first);
}

/// Pushes children in the order in which most rays need them: the child that most rays enter first comes
/// first. An order by the signs of most directions needs no votes, but visits so many more nodes that it is
/// no faster. Without a vote, no ray meets any child.
void PacketStage::push_children(const MonoNode& node, int level, const LaneMask* enters_first) {
  int votes[kMaxNodeWidth] = {};
  int order[kMaxNodeWidth] = {};
  int all_votes = 0;
  for (int i = 0; i < node.children; ++i) {
    votes[i] = context_.machine.count(enters_first[i]);
    all_votes += votes[i];
    order[i] = i;
  }
  if (all_votes == 0) return;
  context_.machine.issue_mono(kComparisonInstructions * std::uint64_t(sort_comparisons(keys_.width())) +
                              kPushInstructions * std::uint64_t(node.children));
  std::stable_sort(order, order + node.children, [&](int a, int b) { return votes[a] < votes[b]; });
  for (int i = 0; i < node.children; ++i) {
    const int child = order[i];
    stack_.push_back({PackedReference::unpack(node.reference[child]), level + 1, keys_.place(level, child)});
  }
}

void PacketStage::test_leaf(std::int32_t first_triangle, std::int32_t count, const LaneMask& rays) {
  TestLeafArguments arguments;
  arguments.record = record_;
  arguments.packet = packet_;
  arguments.triangles = read_triangles(context_.machine, context_.layout, first_triangle, count);
  arguments.count = count;
  arguments.reach = tree_.reach;
  arguments.layers = context_.layout.layers;
  context_.machine.run(packet_kernels_.test_leaf, arguments, rays);
}

void PacketTraversal::plan_first(const Plan& plan) {
  for (int block = 0; block * num_pes_ < queue_.rays(); ++block) plan(stage_, block);
}

}  // namespace path_tracer
