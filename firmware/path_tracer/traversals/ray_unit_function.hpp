#pragma once

#include "firmware/cn/chip/search_unit.hpp"
#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/program/layout.hpp"

namespace path_tracer {

/// What the chip's search unit does with a QueuedRay: the tests of boxes and triangles are those of the
/// kernels, so hits are theirs to the bit. An answer is a HitRecord with its tail, and the place of the
/// surface that was hit.
class RayUnitFunction : public cn::SearchFunction {
 public:
  RayUnitFunction(const TraversalKernels& kernels, const ProgramConfig& config, const Layout& layout);

  static int query_bytes_of_ray() { return int{sizeof(QueuedRay)}; }
  static std::vector<int> answer_bytes_of_ray(const RecordSizes& sizes) {
    return {sizes.hit, int{sizeof(MonoAddress)}};
  }

  int query_bytes() const override { return query_bytes_of_ray(); }
  std::vector<int> answer_bytes() const override { return answer_bytes_of_ray(sizes_); }
  void answer(const Read& mono, const std::vector<Query>& queries) override;

 private:
  /// As many rays as the simulator's vectors have lanes.
  void answer_strip(const Read& mono, const Query* queries, int count);
  void enter(const Query* queries, const LaneMask& rays);
  /// Fetches what the step of a ray needs. Returns whether it is a leaf.
  bool fetch(const Read& mono, int lane, std::vector<cn::SearchStep>& steps);
  /// Takes each ray a step on. Returns those that go on.
  LaneMask step(const LaneMask& rays, const LaneMask& with_leaf);
  void finish(const Query* queries, const LaneMask& rays);

  void copy_in(int lane, int offset_bytes, const std::uint8_t* from, int bytes);
  void copy_out(int lane, int offset_bytes, std::uint8_t* to, int bytes) const;
  std::int32_t value(int lane, PolyField<std::int32_t> field) const;

  const TraversalKernels& kernels_;
  TreeShape shape_;
  RecordSizes sizes_;
  double reach_;
  Layers layers_;
  MonoAddress nodes_;
  MonoAddress triangles_;
  int first_light_run_;
  MonoRecords surfaces_;

  cn::PolyMemory memory_;
  PolyPointer<QueuedRay> ray_;
  PolyPointer<TraversalRecord> record_;
  PolyPointer<TriangleRecord> leaf_;
  int node_offset_;
  PolyField<std::int32_t> node_;  ///< the slot that was fetched
  PolyPointer<HitRecord> hit_;
  PolyField<MonoAddress> surface_place_;
  PolyField<MonoAddress> unused_place_;
  std::vector<std::uint8_t> piece_;
};

}  // namespace path_tracer
