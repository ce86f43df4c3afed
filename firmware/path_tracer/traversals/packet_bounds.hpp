#pragma once

#include <array>

#include "firmware/path_tracer/kernels/large_packet_kernels.hpp"

namespace path_tracer {

/// The intervals of the rays of a packet, by which the control unit culls a box that no ray of it meets
/// (Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005; Boulos et al., "Packet-
/// based Whitted and Distribution Ray Tracing", GI 2007). Rounding preserves order, so the ends of an
/// interval, computed as each ray computes its own numbers, bound those of all rays.
class PacketBounds {
 public:
  PacketBounds() = default;
  /// @param least kPacketBounds of KeepBoundsArguments
  explicit PacketBounds(const std::array<std::int32_t, kPacketBounds>& least);

  /// Whether it can cull: along some axis all directions have the same sign.
  bool culls() const { return axes_ > 0; }
  /// Whether no ray meets the child's box, as far as the intervals tell.
  bool misses(const MonoNode& node, int child) const;
  /// Instructions of the control unit for misses() (assumed: one for each operation on doubles).
  std::uint64_t instructions() const { return 8 * std::uint64_t(axes_) + 2; }

 private:
  struct Interval {
    double low = 0;
    double high = 0;
  };
  struct Axis {
    Interval origin;
    Interval scale;  ///< -1 / direction
    bool has_sign() const { return scale.low > 0 || scale.high < 0; }
  };
  static Interval distances(const Axis& axis, double plane);

  std::array<Axis, kAxes> axis_{};
  int axes_ = 0;  ///< along which all directions have the same sign
};

}  // namespace path_tracer
