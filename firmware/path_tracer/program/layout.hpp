#pragma once

#include <cstdint>
#include <vector>

#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/path_tracer/program/program_config.hpp"
#include "firmware/path_tracer/records/pair_records.hpp"
#include "firmware/path_tracer/records/slot_state.hpp"
#include "firmware/path_tracer/records/tails.hpp"

namespace path_tracer {

/// Numbers that decide how much mono memory a scene takes.
struct SceneCounts {
  int triangles = 0;
  int lights = 0;
  int tree_slots = 0;  ///< nodes; 0 without a tree
  bool has_layers = false;
  std::uint64_t texture_bytes = 0;
  std::uint64_t environment_texels = 0;
  int suns = 0;
  int light_classes = 0;  ///< 0 if each light has a probability of its own
};

/// Addresses in mono memory.
struct Layout {
  // The host writes the scene before the run.
  cn::MonoPointer<CameraRecord> camera;
  cn::MonoPointer<TriangleRecord> triangles;  ///< in a layered scene of LayeredTriangleRecords
  cn::MonoPointer<SurfaceRecord> surfaces;
  cn::MonoPointer<LightRecord> lights;
  cn::MonoPointer<double> light_cdf;  ///< entry i: probability of lights 0..i, or of classes 0..i
  cn::MonoPointer<LightClass> light_classes;
  cn::MonoPointer<LightCandidate> light_candidates;  ///< one for each light, where vertices resample lights
  cn::MonoPointer<std::uint64_t> nodes;
  cn::MonoPointer<std::uint64_t> textures;             ///< footprints of texels (records/tails.hpp)
  cn::MonoPointer<CameraSampleRecord> camera_samples;  ///< behind everything else, of a run with a list
  int triangle_count =
      0;  ///< with a tree, in order of leaves; behind them lie kLightRun triangles for each light
  int light_count = 0;
  int light_class_count = 0;  ///< 0 if each light has a probability of its own
  int tree_slots = 0;
  int treelet_pool_blocks = 0;
  Features features;  ///< of the scene; the firmware is built for them
  RecordSizes sizes{
      Features{}};             ///< of records with tails: surfaces, intersection_bin, scatter_bin, path_bin
  vec3<double> environment{};  ///< radiance that arrives from outside the scene
  EnvironmentImage environment_image;
  cn::MonoPointer<SunRecord> suns;
  int sun_count = 0;
  double reach = 0;  ///< no ray starts farther from a vertex (triangle_record.hpp)
  Layers layers;
  // Of bidirectional paths: what lights emit, and a sphere around the scene.
  cn::MonoPointer<LightEmissionRecord> light_emission;
  cn::MonoPointer<double> sun_pdfs;  ///< by which connections find the suns' disks
  bool has_silent_lights = false;    ///< lights from which no light path begins
  vec3<double> centre{};
  double radius = 0;

  // Bins: one record for each slot, slot_vertices for `vertices`.
  cn::MonoPointer<RayRecord> ray_bin;    ///< of brute force
  cn::MonoPointer<QueuedRay> ray_queue;  ///< of tree traversals
  cn::MonoPointer<std::uint64_t> traversal_bin;
  cn::MonoPointer<std::uint64_t> treelet_pool;
  cn::MonoPointer<HitRecord> intersection_bin;
  cn::MonoPointer<cn::MonoAddress> surface_place_bin;  ///< of tree traversals; otherwise PEs keep the places
  cn::MonoPointer<ScatterRecord> scatter_bin;
  cn::MonoPointer<LightingRecord> lighting_bin;
  cn::MonoPointer<DirectLightRecord> direct_light_bin;
  cn::MonoPointer<PathRecord> path_bin;
  // Of bins of hits (Shading::material_bins): BinnedHits of each kind, and which slots cast a shadow ray.
  cn::MonoPointer<BinnedHit> binned_hits;
  cn::MonoPointer<cn::MonoAddress> casts_bin;
  // Of stream execution: for each slot its state and the record of the path that it had; words of ScanLevels.
  cn::MonoPointer<SlotState> slot_states;
  cn::MonoPointer<FinishedRecord> finished_bin;
  cn::MonoPointer<std::uint64_t> path_numbers;
  cn::MonoPointer<VertexRecord> vertices;
  cn::MonoPointer<FoldRecord> folds;
  cn::MonoPointer<FinishedRecord> finished;
  // Bins of bidirectional paths, in place of the path bin and those behind it (PairSizes).
  cn::MonoPointer<PairRecord> pair_bin;
  cn::MonoPointer<PathVertexRecord> path_vertices;  ///< light_vertices + 1 for each slot
  cn::MonoPointer<LightHeadRecord> light_heads;     ///< light_vertices for each slot

  // The host reads the results. It reads one half while the firmware fills the other.
  cn::MonoPointer<ResultsHeader> results_header[2];
  cn::MonoPointer<RadianceRecord> results[2];

  std::uint64_t scene_bytes = 0;  ///< the host writes [0, scene_bytes)
  std::uint64_t total_bytes = 0;

  /// All addresses above by name, for messages.
  struct Region {
    const char* name;
    cn::MonoAddress first;
    std::uint64_t bytes;
  };
  std::vector<Region> regions;
};

Layout make_layout(const SceneCounts& scene, int num_pes, const ProgramConfig& config);

/// Kinds of hits that wait in bins of their own: shadow rays, misses and the materials'.
inline constexpr int kShadowRayKind = 0;
inline constexpr int kMissKind = 1;
inline constexpr int kFirstMaterialKind = 2;
inline int hit_kinds(const Features& features) {
  return kFirstMaterialKind + features.shading_kinds;
}

/// Moves bins and results, which begin behind the scene, so that they begin at `first`: those of a second
/// array that shares the memory and the scene. To be called before add_camera_samples().
void place_bins(Layout& layout, cn::MonoAddress first);

/// Adds room for a list of camera samples (Work).
void add_camera_samples(Layout& layout, std::uint64_t count);

/// Blocks of the traversal bin's ring: enough for all rays and for blocks that are being loaded or saved.
int traversal_bin_blocks(const ProgramConfig& config);

/// Number of steps whose rays' records may be under way, from their load to the step's turn.
int record_steps(const ProgramConfig& config);

}  // namespace path_tracer
