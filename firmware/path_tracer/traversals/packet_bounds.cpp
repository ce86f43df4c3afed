#include "firmware/path_tracer/traversals/packet_bounds.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

namespace path_tracer {
namespace {

/// The double whose bits, in the order of kernel `bound_packet`, are these.
double of_ordered(std::uint64_t ordered) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  const std::uint64_t bits = (ordered & kSign) != 0 ? ordered ^ kSign : ~ordered;
  double value;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

constexpr int kDroppedBits = 64 - kBoundBits;
constexpr std::int32_t kTopBound = std::numeric_limits<std::int32_t>::max();

double least_of(std::int32_t bound) {
  return of_ordered(std::uint64_t(bound) << kDroppedBits);
}
double greatest_of(std::int32_t bound) {
  return of_ordered(std::uint64_t(bound) << kDroppedBits | ((std::uint64_t{1} << kDroppedBits) - 1));
}

}  // namespace

PacketBounds::PacketBounds(const std::array<std::int32_t, kPacketBounds>& least) {
  for (std::size_t i = 0; i < axis_.size(); ++i) {
    const std::int32_t* const of_axis = &least[4 * i];
    axis_[i].origin = {least_of(of_axis[0]), greatest_of(kTopBound - of_axis[1])};
    axis_[i].scale = {least_of(of_axis[2]), greatest_of(kTopBound - of_axis[3])};
    axes_ += axis_[i].has_sign() ? 1 : 0;
  }
}

PacketBounds::Interval PacketBounds::distances(const Axis& axis, double plane) {
  const double low = axis.origin.low - plane;
  const double high = axis.origin.high - plane;
  const auto [least, greatest] = std::minmax(
      {low * axis.scale.low, low * axis.scale.high, high * axis.scale.low, high * axis.scale.high});
  return {least, greatest};
}

bool PacketBounds::misses(const MonoNode& node, int child) const {
  const MonoNode::Four& four = node.four[child / 4];
  const auto i = static_cast<std::size_t>(child % 4);
  double entry = 0;
  double exit = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < axis_.size(); ++axis) {
    if (!axis_[axis].has_sign()) continue;
    const bool backward = axis_[axis].scale.low > 0;
    const double near = backward ? four.upper[axis][i] : four.lower[axis][i];
    const double far = backward ? four.lower[axis][i] : four.upper[axis][i];
    entry = std::max(entry, distances(axis_[axis], near).low);
    exit = std::min(exit, distances(axis_[axis], far).high);
  }
  return entry > exit;
}

}  // namespace path_tracer
