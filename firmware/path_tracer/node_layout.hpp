#pragma once

#include <cstddef>
#include <cstdint>

/// How a node of the tree of boxes lies in mono memory and, once loaded, in a PE's SRAM. All children of a
/// node are in it, so that one load answers which of them a ray meets.
namespace path_tracer {

/// Of a child's box. The narrow ones are rounded outwards: a ray that meets the box meets what is stored.
enum class NodeFormat : std::uint8_t {
  fp64,
  fp32,
  /// Steps of a power of two from an origin for each axis (Ylitie, Karras, Laine, "Efficient Incoherent Ray
  /// Traversal on GPUs Through Compressed Wide BVHs", HPG 2017).
  quantised8,
};
inline constexpr int kNodeFormats = 3;

/// A node has 2, 4 or 8 children at most.
inline constexpr int kNodeWidths = 3;
inline constexpr int kMaxNodeWidth = 8;

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

/// Of quantised8: coordinate = origin + step * 2^exponent, exact in double precision but for its sum.
struct QuantisedFrame {
  double origin[3];
  std::int16_t exponent[3];
  std::int16_t unused;
};

/// Byte offsets within a node of `width` children: its boxes first, then width packed references. Boxes lie
/// component by component (lower x, y, z, upper x, y, z), each of all children side by side.
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

  /// 0, 1 or 2.
  constexpr std::size_t width_number() const { return width == 8 ? 2 : width == 4 ? 1 : 0; }

  /// Of quantised8, two children and the frame take what they take as fp32, so there is no such kernel.
  constexpr bool has_kernel() const {
    return width == 4 || width == 8 || (width == 2 && format != NodeFormat::quantised8);
  }
};

}  // namespace path_tracer
