#pragma once

#include <algorithm>
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
  virtual void fill(std::uint64_t step, int block);

  /// Paths listed since the last clear_finished().
  int finished_count() const { return finished_count_; }
  void clear_finished() { finished_count_ = 0; }

  const CameraRays& camera_rays() const { return camera_rays_; }
  void stop_camera_rays() { camera_rays_.stop(); }

 protected:
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
  /// Writes the vertices, the entries of the list and which paths ended or fill their slots.
  void append_vertices(std::uint64_t step, int block);
  void load_paths(std::uint64_t step, int block, const LaneMask& enabled);
  PolyPointer<FinishedRecord> finished_entry(std::uint64_t step) const { return saves(step).finished; }
  PolyField<MonoAddress> finished_place(std::uint64_t step) const { return saves(step).finished_place; }
  void save_vertices(std::uint64_t step, int block);
  void save_finished(std::uint64_t step, int block);
  void save_paths(std::uint64_t step, int block);
  /// Camera rays for that many ended paths, or all that are left.
  std::int32_t paths_to_start(int ended) const {
    return static_cast<std::int32_t>(std::min<std::uint64_t>(camera_rays_.remaining(), std::uint64_t(ended)));
  }
  /// @param number ascending numbers of the lanes whose path ended; those below `started` start a path
  void continue_paths(std::uint64_t step, int block, PolyField<std::int32_t> number, std::int32_t started);
  void count_segments(int block);

  RayStore& rays_;
  CameraRays camera_rays_;
  bool is_listed_;  ///< camera rays follow a list (Work)
  // The current block, from process to save:
  LaneMask appended_;
  LaneMask ended_;
  LaneMask finished_;
  LaneMask continued_;  ///< slots with a new ray
  int finished_count_ = 0;

 private:
  void list_finished(std::uint64_t step);
  void load_listed(std::uint64_t step, int block, PolyField<std::int32_t> number, std::int32_t started);

  PolyField<std::int32_t> number_;
  std::vector<std::uint32_t> segments_;  ///< segments of the path in each slot; for RunCounts only
};

}  // namespace path_tracer
