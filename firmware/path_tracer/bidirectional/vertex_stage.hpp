#pragma once

#include <vector>

#include "firmware/path_tracer/bidirectional/pair_context.hpp"
#include "firmware/path_tracer/stages/camera_rays.hpp"
#include "firmware/path_tracer/stages/surface_loads.hpp"

namespace path_tracer {

/// Vertex stage: a segment's hit becomes a vertex of its path, a connection whose ray was not blocked adds
/// its light, and each slot decides what its next ray is. The light of complete pairs, and what light paths
/// bring to the lens, is a result; a new pair begins in a slot whose pair is complete.
class VertexStage : public Stage {
 public:
  VertexStage(const StageContext& context, PairContext& pairs, const Work& work);
  static int load_bytes(const ProgramConfig& config);
  static int save_bytes(const ProgramConfig& config);

  const char* name() const override { return "vertex stage"; }
  void load(std::uint64_t step, int block) override;
  bool prepares() const override { return context_.config.features.looks_up(); }
  bool loads_early() const override { return false; }
  void prepare(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

  /// Begins pairs in an empty block; replaces load and process.
  void fill(std::uint64_t step, int block);

  /// Results since the last begin_results().
  int results() const { return results_; }
  std::uint64_t last_result_step() const { return last_result_step_; }
  void begin_results(cn::MonoPointer<RadianceRecord> half) {
    half_ = half;
    results_ = 0;
  }

  const CameraRays& pairs() const { return camera_rays_; }
  void stop_pairs() { camera_rays_.stop(); }

 private:
  struct Loads {
    PolyPointer<HitRecord> hit;
    PolyPointer<SurfaceRecord> surface;
    PolyPointer<TextureLookUp> look_ups;
    PolyPointer<PairRecord> pair;
    PolyPointer<LightHeadRecord> heads;
  };
  struct Saves {
    PolyPointer<PairRecord> pair;
    PolyPointer<PathVertexRecord> vertex;
    PolyPointer<LightHeadRecord> head;
    PolyPointer<RadianceRecord> result;
    PolyField<MonoAddress> vertex_place;
    PolyField<MonoAddress> head_place;
    PolyField<MonoAddress> result_place;
  };
  Loads loads(std::uint64_t step) const;
  Saves saves(std::uint64_t step) const;
  MonoAddress block_vertices(int block) const;
  MonoAddress block_heads(int block) const;
  LaneMask eye_hits(int block) const;
  void load_hit_surfaces(std::uint64_t step, int block);
  void look_up_sky(std::uint64_t step, int block);
  void reach(std::uint64_t step, int block);
  void see(std::uint64_t step, int block);
  void decide(std::uint64_t step, int block);
  void list_results(std::uint64_t step);
  void begin_pairs(std::uint64_t step, int block);
  void load_listed(std::uint64_t step, int block, std::int32_t begun);
  void locate_far(std::uint64_t step, int block);
  void count_segments(int block);
  void count_ended(int block);

  PairContext& pairs_;
  CameraRays camera_rays_;
  bool is_listed_;
  PolyField<std::int32_t> number_;
  cn::MonoPointer<RadianceRecord> half_;
  int results_ = 0;
  std::uint64_t last_result_step_ = 0;
  // The current block, from process to save:
  LaneMask vertices_;
  LaneMask light_vertices_;
  LaneMask reached_lens_;
  LaneMask ended_;
  LaneMask reached_;  ///< slots whose path goes on from a segment that was traced
  LaneMask result_lanes_;
  std::vector<std::uint32_t> segments_;  ///< of the eye path in each slot; for RunCounts only
};

}  // namespace path_tracer
