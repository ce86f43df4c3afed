#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "testbench/mono_image/mono_image.hpp"

/// Searches for hits of rays with the firmware's kernels alone: against every triangle, or through a tree
/// whose data the test loads into each PE in place of the pipeline.
namespace test_support {

/// The data of a scene that the kernels read.
struct SearchScene {
  int triangle_count = 0;
  path_tracer::Layers layers;
  std::vector<char> triangles;  ///< records in the scene's order
  // The tree:
  path_tracer::TreeShape shape;
  std::vector<char> leaves;  ///< records leaf by leaf, then those of the lights, then room for one more load
  std::vector<std::uint8_t> nodes;
  double reach = 0;
  std::vector<std::int32_t> light_of;  ///< for each triangle the number of its light, or kNoLight

  const path_tracer::TriangleRecord* records() const {
    return reinterpret_cast<const path_tracer::TriangleRecord*>(triangles.data());
  }
};

/// Triangles and tree as the host writes them to mono memory.
SearchScene search_scene(const testbench::Scene& scene, const path_tracer::TreeShape& shape);
/// A search scene without triangles. No scene is like this, because it would have no light.
SearchScene empty_search_scene(const path_tracer::TreeShape& shape);

struct SearchHit {
  std::int32_t number = -1;
  path_tracer::HitRecord record;
};
/// Whether two hits are equal to the last bit.
bool same(const SearchHit& a, const SearchHit& b);

class TestRays;

/// The triangles of each light of scene_of(), in the order of its lights.
std::vector<std::vector<std::size_t>> lights_of(const testbench::Scene& scene);

/// Whether a shadow ray towards a light that hit this sees it.
bool sees_light(const SearchScene& scene, const TestRays& source, const SearchHit& hit,
                std::int32_t light_face, std::int32_t light);

class RaySearch {
 public:
  static constexpr int kPes = 64;

  explicit RaySearch(cn::Level level);

  /// @param rays at most one per PE
  /// @param prefilter prefilter of the scene's triangles; nullptr for none
  std::vector<SearchHit> brute_force(const SearchScene& scene,
                                     const std::vector<path_tracer::RayRecord>& rays,
                                     const path_tracer::Prefilter* prefilter = nullptr,
                                     const path_tracer::SearchTree* tree = nullptr);

  /// Half of the rays enter the tree after the others have begun. With `move`, every ray continues in another
  /// PE after each turn, as rays from a bin do.
  std::vector<SearchHit> through_tree(const SearchScene& scene,
                                      const std::vector<path_tracer::QueuedRay>& rays, bool move);

  /// The instructions that the latest kernel issued.
  const cn::IssueTree& issued() const { return issued_; }
  std::uint64_t turns() const { return turns_; }  ///< total of all rays so far

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

/// Searches for rays of all kinds, with as many PEs as there may be, by brute force and by
/// `search_for(rays)`: expects the same hits to the bit, and that a twentieth of the rays hits something. The
/// search's issued() is that of brute force when `search_for` is called.
void expect_hits_of_brute_force(
    const testbench::Scene& scene, const SearchScene& searched, RaySearch& search, unsigned seed,
    const std::function<std::vector<SearchHit>(const std::vector<path_tracer::RayRecord>&)>& search_for);

}  // namespace test_support
