#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>

/// How a node of the tree of boxes lies in mono memory and, once loaded, in a PE's SRAM. All children of a
/// node are in it, so that one load answers which of them a ray meets.
namespace path_tracer {

inline constexpr int kAxes = 3;

/// Of a child's box. The narrow ones are rounded outwards: a ray that meets the box meets what is stored.
enum class NodeFormat : std::uint8_t {
  fp64,
  fp32,
  /// Steps of a power of two from an origin for each axis (Ylitie, Karras, Laine, "Efficient Incoherent Ray
  /// Traversal on GPUs Through Compressed Wide BVHs", HPG 2017).
  quantised8,
};
inline constexpr int kNodeFormats = 3;

/// Factor of coordinates in nodes, a power of two. In single precision they are in such units that `reach`,
/// the longest way there is in the scene, is 1 to 2 (below 2^-1000 less): floats then serve scenes of every
/// size.
inline double to_node_unit(NodeFormat format, double reach) {
  const bool in_scenes_unit = format == NodeFormat::fp64 || !(reach > 0) || !std::isfinite(reach);
  return in_scenes_unit ? 1.0 : std::scalbn(1.0, std::min(-std::ilogb(reach), 1000));
}

/// A node has 2, 4 or 8 children at most.
inline constexpr int kNodeWidth[] = {2, 4, 8};
inline constexpr std::size_t kNodeWidths = std::size(kNodeWidth);
inline constexpr int kMaxNodeWidth = kNodeWidth[kNodeWidths - 1];

/// Where a child leads. `count` triangles from `first` on; or the node in slot `first`, when count is 0; or
/// nowhere.
struct ChildReference {
  static constexpr std::int32_t kNowhere = -1;
  std::int32_t first = 0;
  std::int32_t count = kNowhere;
};

/// A ChildReference as a node holds it, in 4 bytes. The top bit is free for those who keep references.
struct PackedReference {
  static constexpr int kFirstBits = 26;
  static constexpr std::uint32_t kFirstMask = (1u << kFirstBits) - 1;
  static constexpr std::uint32_t kCountMask = 31;  ///< of the bits above `first`
  static constexpr std::int32_t kMaxCount = 30;
  static constexpr std::uint32_t kNowhere = kCountMask << kFirstBits;
  static constexpr std::uint32_t kFlag = 1u << 31;

  static constexpr std::uint32_t pack(const ChildReference& reference) {
    if (reference.count == ChildReference::kNowhere) return kNowhere;
    return static_cast<std::uint32_t>(reference.count) << kFirstBits |
           static_cast<std::uint32_t>(reference.first);
  }
  static constexpr ChildReference unpack(std::uint32_t packed) {
    if (packed == kNowhere) return {};
    return {static_cast<std::int32_t>(packed & kFirstMask),
            static_cast<std::int32_t>(packed >> kFirstBits & kCountMask)};
  }
};

/// Of quantised8: coordinate = origin + step * 2^exponent as floats, the product exact and the sum rounded.
struct QuantisedFrame {
  float origin[kAxes];
  std::uint8_t exponent[kAxes];  ///< as a float has it, 127 above its value: a normal number's
  std::uint8_t unused;
};

inline float quantised_coordinate(const QuantisedFrame& frame, int axis, int step) {
  return frame.origin[axis] + std::ldexp(static_cast<float>(step), frame.exponent[axis] - 127);
}

/// Byte offsets within a node of `width` children: its boxes first, then width packed references. Boxes lie
/// component by component (lower x, y, z, upper x, y, z), each of all children side by side. The box of a
/// child that leads nowhere is empty, from infinity to -infinity, or all 0 where steps cannot say that.
struct NodeLayout {
  NodeFormat format = NodeFormat::fp32;
  int width = 4;

  constexpr int coordinate_bytes() const {
    return format == NodeFormat::fp64 ? 8 : format == NodeFormat::fp32 ? 4 : 1;
  }
  constexpr int frame_bytes() const {
    return format == NodeFormat::quantised8 ? static_cast<int>(sizeof(QuantisedFrame)) : 0;
  }
  constexpr int coordinate_offset(int component, int child) const {
    return frame_bytes() + (component * width + child) * coordinate_bytes();
  }
  constexpr int reference_offset(int child) const {
    const int boxes_end = coordinate_offset(6, 0);
    return (boxes_end + 7) / 8 * 8 + child * static_cast<int>(sizeof(std::uint32_t));
  }
  constexpr int node_bytes() const { return (reference_offset(width) + 7) / 8 * 8; }

  /// Place of the width in kNodeWidth; kNodeWidths if it is none.
  constexpr std::size_t width_number() const {
    std::size_t number = 0;
    while (number < kNodeWidths && kNodeWidth[number] != width) ++number;
    return number;
  }

  /// Of quantised8, two children's steps are no whole words, so there is no such kernel.
  constexpr bool has_kernel() const {
    return width_number() < kNodeWidths && (width > 2 || format != NodeFormat::quantised8);
  }
};

}  // namespace path_tracer
