#include "firmware/path_tracer/traversals/packet_rays.hpp"

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

PacketBase::PacketBase(const StageContext& context, TreeContext& tree)
    : TreeStage(context, tree), packet_kernels_(context.kernels.packet()) {
  const NodeLayout& layout = tree.tree.shape.layout;
  nodes_ = {context.layout.nodes, layout, 1.0 / to_node_unit(layout.format, tree.reach)};
}

MonoNode PacketBase::read(std::int32_t slot) {
  return read_node(context_.machine, nodes_, slot);
}

void PacketBase::charge_pop() {
  context_.machine.issue_mono(kPopInstructions);
}

void PacketBase::charge_push(int entries) {
  context_.machine.issue_mono(kPushInstructions * std::uint64_t(entries));
}

void PacketBase::sort_children(std::vector<VotedChild>& children) {
  context_.machine.issue_mono(kComparisonInstructions * std::uint64_t(sort_comparisons(width())));
  std::stable_sort(children.begin(), children.end(),
                   [](const VotedChild& a, const VotedChild& b) { return a.votes < b.votes; });
}

void PacketBase::begin(std::uint64_t step, const PacketBlock& block, const PacketKeys* keys) {
  LaneMask seeks_light;
  BeginPacketArguments arguments;
  arguments.ray = loads(step).ray;
  arguments.record = block.record;
  arguments.packet = block.packet;
  arguments.has_keys = keys != nullptr;
  if (keys != nullptr) arguments.keys = *keys;
  arguments.seeks_light = &seeks_light;
  context_.machine.run(packet_kernels_.begin, arguments, block.rays);
  test_lights(block, seeks_light);
}

/// Tests light by light: a block has few of them, and triangles as mono operands cost no PE a load.
void PacketBase::test_lights(const PacketBlock& block, LaneMask seeks_light) {
  while (context_.machine.count(seeks_light) > 0) {
    const std::int32_t light = least_light(block, seeks_light);
    const LaneMask rays = rays_with_light(light, block, seeks_light);
    test_leaf(context_.layout.triangle_count + light * kLightRun, kLightRun, block, rays);
    seeks_light = seeks_light.without(rays);
  }
}

std::int32_t PacketBase::least_light(const PacketBlock& block, const LaneMask& rays) {
  std::int32_t least = context_.layout.light_count;
  LeastArguments arguments;
  arguments.value = block.packet.field(&PacketRecord::light);
  arguments.bits = bits_of(context_.layout.light_count);
  arguments.least = &least;
  context_.machine.run(kernels_.least, arguments, rays);
  return least;
}

LaneMask PacketBase::rays_with_light(std::int32_t light, const PacketBlock& block, const LaneMask& rays) {
  LaneMask equal;
  context_.machine.run(kernels_.equal,
                       EqualArguments{block.packet.field(&PacketRecord::light), light, &equal}, rays);
  return equal;
}

void PacketBase::test_leaf(std::int32_t first_triangle, std::int32_t count, const PacketBlock& block,
                           const LaneMask& rays) {
  TestLeafArguments arguments;
  arguments.record = block.record;
  arguments.packet = block.packet;
  arguments.triangles = triangles(first_triangle, count);
  arguments.count = count;
  arguments.reach = tree_.reach;
  arguments.layers = context_.layout.layers;
  context_.machine.run(packet_kernels_.test_leaf, arguments, rays);
}

}  // namespace path_tracer
