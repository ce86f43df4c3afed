#pragma once

#include <vector>

#include "firmware/path_tracer/stages/camera_rays.hpp"
#include "firmware/path_tracer/stages/ray_store.hpp"
#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// Path stage: appends the vertex, and generates the next camera ray in the slot of each path that ended
/// (kernels/camera_rays.hpp). Lists the paths that wait for their radiance, packed by ascending numbers. A
/// slot whose shadow ray is still to be cast, or goes on behind a surface that let it through, waits
/// unchanged.
class PathStage : public Stage {
 public:
  /// @param rays where camera rays and segments go
  PathStage(const StageContext& context, RayStore& rays, const Work& work);
  static int load_bytes(const ProgramConfig& config) {
    const RecordSizes sizes(config.features);
    return sizes.path + sizes.scatter + int{sizeof(DirectLightRecord)};
  }
  static int save_bytes(const ProgramConfig& config) {
    return int{sizeof(VertexRecord)} + RecordSizes(config.features).path + int{sizeof(FinishedRecord)} +
           2 * int{sizeof(MonoAddress)} + RayStore::room_bytes(config);
  }

  const char* name() const override { return "path stage"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

  /// Fills an empty block with camera rays; replaces load and process.
  void fill(std::uint64_t step, int block);

  /// Paths listed since the last clear_finished().
  int finished_count() const { return finished_count_; }
  void clear_finished() { finished_count_ = 0; }

  const CameraRays& camera_rays() const { return camera_rays_; }

 private:
  struct Loads {
    PolyPointer<PathRecord> path;
    PolyPointer<ScatterRecord> scatter;
    PolyPointer<DirectLightRecord> direct_light;
  };
  struct Saves {
    PolyPointer<VertexRecord> vertex;
    PolyPointer<PathRecord> path;
    PolyPointer<FinishedRecord> finished;
    PolyField<MonoAddress> vertex_place;
    PolyField<MonoAddress> finished_place;
    RayRoom ray;
  };
  Loads loads(std::uint64_t step) const;
  Saves saves(std::uint64_t step) const;
  void append_vertices(std::uint64_t step, int block);
  void list_finished(std::uint64_t step);
  void load_listed(std::uint64_t step, int block, std::int32_t started);
  void continue_paths(std::uint64_t step, int block, int ended_count);
  void count_segments(int block);

  RayStore& rays_;
  CameraRays camera_rays_;
  bool is_listed_;  ///< camera rays follow a list (Work)
  PolyField<std::int32_t> number_;
  // The current block, from process to save:
  LaneMask appended_;
  LaneMask ended_;
  LaneMask finished_;
  LaneMask continued_;  ///< slots with a new ray
  int finished_count_ = 0;
  std::vector<std::uint32_t> segments_;  ///< segments of the path in each slot; for RunCounts only
};

}  // namespace path_tracer
