#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "testbench/mono_image/mono_image.hpp"

/// Rays through a scene by the firmware's kernels alone: tested against every triangle, or through a tree of
/// which a host in the place of the pipeline brings each PE what it asks for.
namespace test_support {

/// What the kernels want of a scene.
struct SearchScene {
  std::vector<path_tracer::TriangleRecord> triangles;  ///< in the scene's order
  // Of the tree:
  path_tracer::TreeShape shape;
  std::vector<path_tracer::TriangleRecord> leaves;  ///< behind them those of the lights, and room for a load
  std::vector<std::uint8_t> nodes;
  double reach = 0;
};

/// Both as the host writes them to mono memory.
SearchScene search_scene(const testbench::Scene& scene, const path_tracer::TreeShape& shape);
/// Of no triangles, which no scene can have, as there is no light.
SearchScene empty_search_scene(const path_tracer::TreeShape& shape);

struct SearchHit {
  std::int32_t number = -1;
  path_tracer::HitRecord record;
};
/// To the last bit.
bool same(const SearchHit& a, const SearchHit& b);

class RaySearch {
 public:
  static constexpr int kPes = 64;

  explicit RaySearch(path_tracer::Level level);

  /// @param rays as many as there are PEs, or fewer
  /// @param sieve of the scene's triangles, or nothing
  std::vector<SearchHit> brute_force(const SearchScene& scene,
                                     const std::vector<path_tracer::RayRecord>& rays,
                                     const path_tracer::TriangleSieve* sieve = nullptr);

  /// Half of the rays enter when the others are on their way. After each turn every ray goes on in another
  /// PE, as from a bin, if they `move`.
  std::vector<SearchHit> through_tree(const SearchScene& scene,
                                      const std::vector<path_tracer::QueuedRay>& rays, bool move);

  /// By the latest kernel.
  const cn::IssueTree& issued() const { return issued_; }
  std::uint64_t turns() const { return turns_; }  ///< of all rays so far

 private:
  struct Offsets;

  void scramble(int used_bytes);
  void write(int pe, int offset_bytes, const void* from, std::size_t bytes);
  void read(int pe, int offset_bytes, void* to, std::size_t bytes) const;
  void load_tree(const SearchScene& scene, const Offsets& at, const cn::LaneMask& rays,
                 cn::LaneMask& has_leaf);
  cn::LaneMask traverse(const SearchScene& scene, const Offsets& at, const cn::LaneMask& rays,
                        const cn::LaneMask* has_leaf);
  void finish(const Offsets& at, const cn::LaneMask& rays, std::vector<SearchHit>& hits);
  cn::LaneMask move_on(const SearchScene& scene, const Offsets& at, const cn::LaneMask& rays);
  SearchHit hit_of(int pe, const Offsets& at) const;

  const path_tracer::Kernels& kernels_;
  cn::PolyMemory memory_;
  cn::IssueTree issued_;
  std::uint64_t turns_ = 0;
};

}  // namespace test_support
