#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>

/// The layout of a node of the tree in mono memory and, once loaded, in a PE's SRAM. A node holds the boxes
/// and references of all its children, so that one load answers which of them a ray meets.
namespace path_tracer {

inline constexpr int kAxes = 3;

/// Number format of a child's box. Narrow formats are rounded outwards: a ray that meets the box meets the
/// stored one.
enum class NodeFormat : std::uint8_t {
  fp64,
  fp32,
  /// Steps, each a power of two, from an origin for each axis (Ylitie, Karras, Laine, "Efficient Incoherent
  /// Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017).
  quantised8,
};
inline constexpr int kNodeFormats = 3;

/// Factor of coordinates in nodes, a power of two. In single precision, coordinates are in a unit in which
/// `reach`, the longest distance in the scene, is 1 to 2 (less for a reach below 2^-1000). So floats serve
/// scenes of every size.
inline double to_node_unit(NodeFormat format, double reach) {
  const bool in_scenes_unit = format == NodeFormat::fp64 || !(reach > 0) || !std::isfinite(reach);
  return in_scenes_unit ? 1.0 : std::scalbn(1.0, std::min(-std::ilogb(reach), 1000));
}

/// The maximum number of children of a node is one of these.
inline constexpr int kNodeWidth[] = {2, 4, 8};
inline constexpr std::size_t kNodeWidths = std::size(kNodeWidth);
inline constexpr int kMaxNodeWidth = kNodeWidth[kNodeWidths - 1];

/// Where a child leads: to `count` triangles from `first` on; if count is 0, to the node in slot `first`; if
/// it is kNowhere, to none.
struct ChildReference {
  static constexpr std::int32_t kNowhere = -1;
  std::int32_t first = 0;
  std::int32_t count = kNowhere;
};

/// A ChildReference in 4 bytes, as nodes hold it. The top bit is free for flags of the reader.
struct PackedReference {
  static constexpr int kFirstBits = 26;
  static constexpr std::uint32_t kFirstMask = (1u << kFirstBits) - 1;
  static constexpr std::uint32_t kCountMask = 31;  ///< mask of the bits above `first`
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

/// The frame of quantised8: coordinate = origin + step * 2^exponent as floats; the product is exact, the sum
/// rounded.
struct QuantisedFrame {
  float origin[kAxes];
  std::uint8_t exponent[kAxes];  ///< biased by 127, as in a float; of a normal number
  std::uint8_t unused;
};

inline float quantised_coordinate(const QuantisedFrame& frame, int axis, int step) {
  return frame.origin[axis] + std::ldexp(static_cast<float>(step), frame.exponent[axis] - 127);
}

/// Byte offsets within a node of `width` children: boxes first, then `width` packed references. Boxes lie
/// component by component (lower x, y, z, upper x, y, z), each with all children side by side. The box of a
/// child that leads nowhere is empty, from infinity to -infinity; in quantised8, whose steps cannot express
/// that, it is all 0.
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

  /// Index of the width in kNodeWidth; kNodeWidths if the width is not in it.
  constexpr std::size_t width_number() const {
    std::size_t number = 0;
    while (number < kNodeWidths && kNodeWidth[number] != width) ++number;
    return number;
  }

  /// Whether there is a kernel for the layout. There is none for two children in quantised8, whose steps
  /// would not fill whole words.
  constexpr bool has_kernel() const {
    return width_number() < kNodeWidths && (width > 2 || format != NodeFormat::quantised8);
  }
};

}  // namespace path_tracer
