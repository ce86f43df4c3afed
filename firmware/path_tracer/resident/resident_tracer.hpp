#pragma once

#include <vector>

#include "firmware/path_tracer/pipeline/tracer.hpp"
#include "firmware/path_tracer/program/run_counts.hpp"
#include "firmware/path_tracer/resident/resident_results.hpp"
#include "firmware/path_tracer/stages/camera_rays.hpp"

namespace path_tracer {

/// A main program without bins: paths stay in the PEs' SRAM (ProgramConfig::resident_paths), and so does the
/// scene. In each round every path gets the shadow ray of its last vertex and its next segment searched for,
/// is shaded, and gives its place to a new path where it ended.
///
/// It is for plain scenes that fit. Its paths are those of the bins to the bit. Radiance is summed from the
/// path's start, so that nothing of a path need be kept; that rounds differently in the last digits.
class ResidentTracer : public Tracer {
 public:
  /// `machine` has the scene image of `layout` in mono memory. Throws ProgramError for a scene or work that
  /// has more than this program knows, and cn::PolyMemoryOverflow for one that does not fit.
  ResidentTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                 const Layout& layout, const Work& work);

  void run(const Progress& progress) override;

  const RunCounts& counts() const override { return counts_; }

 private:
  void load_scene();
  void load(cn::PolySpan to, cn::MonoAddress from);
  void start_paths();
  void search();
  void search(PolyPointer<ResidentRay> rays, const PathMasks& wanted);
  void shade();
  void count_searched();
  void count_ended();
  bool is_anything_left() const;
  cn::LaneMask all_pes() const { return cn::LaneMask::first(machine_.num_pes()); }
  cn::LaneMask pes_with(const PathMasks& masks) const;

  cn::Machine& machine_;
  const ResidentKernels& kernels_;
  const ProgramConfig config_;
  const Layout layout_;
  RunCounts counts_;
  CameraRays camera_rays_;
  const int paths_;  ///< of a PE
  cn::PolySpan surfaces_;
  cn::PolySpan lights_;
  PolyPointer<ResidentPath> path_records_;
  cn::PolySpan vectors_{};
  PolyField<std::int32_t> number_;
  ResidentResults results_;
  cn::Semaphore loaded_;
  PathMasks live_;   ///< paths with a segment
  PathMasks casts_;  ///< paths with a shadow ray
  PathMasks ended_;  ///< places of paths that ended in this round
  cn::LaneMask nearly_full_;
  std::vector<std::uint32_t> segments_;  ///< of the path in each place; for RunCounts only
};

}  // namespace path_tracer
