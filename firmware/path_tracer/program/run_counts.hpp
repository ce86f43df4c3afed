#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace path_tracer {

/// A count by pass, in at most kMaxIntervals intervals of equally many passes; the last interval may be
/// shorter. When there are too many intervals, two become one.
class PassCounts {
 public:
  static constexpr std::size_t kMaxIntervals = 64;

  void add(std::uint64_t count);
  /// Adds the counts of another run: those of its first pass to those of the first pass here, and so on.
  void merge(PassCounts other);

  std::uint64_t passes() const { return passes_; }
  std::uint64_t passes_per_interval() const { return passes_per_interval_; }
  const std::vector<std::uint64_t>& intervals() const { return intervals_; }

 private:
  /// Two intervals become one.
  void coarsen();

  std::uint64_t passes_ = 0;
  std::uint64_t passes_per_interval_ = 1;
  std::vector<std::uint64_t> intervals_;
};

/// Counts of a tree traversal.
struct TraversalCounts {
  std::uint64_t leaf_loads = 0;     ///< rays that loaded a leaf
  std::uint64_t treelet_loads = 0;  ///< rays that loaded a treelet
  std::vector<std::uint64_t> rays;  ///< by pass or turn, from the one that takes rays out of the ray queue
  std::vector<std::uint64_t>
      lanes;  ///< by pass: PEs of the blocks that its rays filled; with refill all count as pass 0
  /// Counts until 95 % of the rays in the ray queue were finished:
  std::uint64_t rays_before_tail = 0;
  std::uint64_t lanes_before_tail = 0;

  void merge(const TraversalCounts& other);
};

/// How well a lobe filled the PEs that were given its instructions, in kernel `shade`.
struct LobeCount {
  std::uint64_t blocks = 0;        ///< for which the part of the kernel with the lobe was issued
  std::uint64_t issued_lanes = 0;  ///< PEs of these blocks
  std::uint64_t wanted_lanes = 0;  ///< of these, PEs at a hit whose material has the lobe

  double simd_efficiency() const { return double(wanted_lanes) / double(issued_lanes); }
};

/// Rays of bidirectional paths. Connections are shadow rays too.
struct ConnectionCounts {
  std::uint64_t light_segments = 0;  ///< segments of light paths
  std::uint64_t to_lens = 0;         ///< connections from vertices of light paths to the lens
  std::uint64_t to_lights = 0;       ///< from vertices of eye paths to points of lights
  std::uint64_t to_light_vertices = 0;

  std::uint64_t all() const { return to_lens + to_lights + to_light_vertices; }
};

/// Counts of the firmware; the chip has its own.
struct RunCounts {
  std::uint64_t paths = 0;
  std::uint64_t segments = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t culled_shadow_rays = 0;  ///< hits without one: dark, or the light and the surface face away
  std::uint64_t folds = 0;               ///< times that a full slot was flushed
  std::uint64_t blocks = 0;              ///< blocks of slots processed, over all passes
  std::uint64_t skipped_blocks = 0;      ///< empty blocks of slots that were skipped
  std::uint64_t steps = 0;
  std::vector<std::uint64_t> paths_by_segments;  ///< [s]: paths that ended with s segments
  PassCounts rays;                               ///< segments and shadow rays by pass
  std::vector<LobeCount> lobes;                  ///< [i]: of lobe i of kLobeTable; empty in plain scenes
  TraversalCounts traversal;
  ConnectionCounts connections;

  /// Adds the counts of a run beside this one, on another array or chip.
  void merge(const RunCounts& other);
};

}  // namespace path_tracer
