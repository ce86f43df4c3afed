#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/cn/machine.hpp"
#include "firmware/path_tracer/records/records.hpp"
#include "firmware/path_tracer/records/traversal_record.hpp"

namespace path_tracer {

/// What is timed, as the columns of the paper's tables.
enum class Program : std::uint8_t {
  segments,  ///< path segments only; light is found by hitting it
  direct,    ///< plus one shadow ray a segment
  full,      ///< plus the radiance of finished paths
};

/// Where random numbers come from.
enum class Sampler : std::uint8_t {
  philox,  ///< independent
  sobol,   ///< Owen-scrambled Sobol points: the samples of a pixel are stratified
};

/// How a point on a light is chosen.
enum class LightSampling : std::uint8_t {
  area,         ///< uniform on its surface
  solid_angle,  ///< uniform in the solid angle it takes, warped to the cosine at the lit surface
};

/// How a ray finds the triangles that it may hit.
enum class Traversal : std::uint8_t {
  brute_force,  ///< it is tested against every one
  // A tree, of which each PE loads the piece that its ray asks for:
  temporary_bin,  ///< rays wait in a bin between two pieces (paper, section 5)
  refill,         ///< rays stay in their PE; idle PEs load new ones
  lock_step,      ///< the same without: new rays are loaded when all PEs are idle
  /// A tree that the control unit walks through for a block of rays at once.
  packets,
  /// A tree, of which a block of rays shares the piece that all of them ask for.
  shared_treelets,
};

inline constexpr int kMaxBuffers = 8;

/// Far beyond what fits the chip; so that slot numbers stay within 32 bits.
inline constexpr int kMaxBinBlocks = 65536;
inline constexpr int kMaxSlotVertices = 4096;

/// Vertices that one step of the radiance stage loads a path.
inline constexpr int kVerticesPerLoad = 4;

/// How the firmware is built and run; independent of the scene.
struct ProgramConfig {
  Program program = Program::full;
  int n = 1;  ///< blocks loaded ahead and saved behind, 0 to kMaxBuffers
  bool buffer_loads = true;
  bool buffer_saves = true;
  int bin_blocks = 8;            ///< length of each bin in blocks of one SIMD width
  int slot_vertices = 16;        ///< vertices a path slot holds; a multiple of kVerticesPerLoad
  int roulette_start = 0;        ///< segments a path lives without roulette
  double max_survival = 0.95;    ///< so that paths between white surfaces end
  bool cull_shadow_rays = true;  ///< none where surface or light turns its back on the other
  Sampler sampler = Sampler::philox;
  LightSampling light_sampling = LightSampling::area;
  std::uint64_t seed = 1;
  /// Pixels from one camera ray to the next, round and round the film; without a common divisor with their
  /// number. The image is the same; what changes is how far rays of one block are from each other.
  int pixel_stride = 1;
  Traversal traversal = Traversal::brute_force;
  TreeShape tree;

  bool uses_tree() const { return traversal != Traversal::brute_force; }
  bool casts_shadow_rays() const { return program != Program::segments; }
  bool buffers_loads() const { return buffer_loads && n > 0; }
  bool buffers_saves() const { return buffer_saves && n > 0; }
  int load_buffers() const { return buffers_loads() ? n + 1 : 1; }
  int save_buffers() const { return buffers_saves() ? n + 1 : 1; }
};

/// The work: samples [first_sample, first_sample + samples) of every pixel.
struct Work {
  int first_sample = 0;
  int samples = 1;
};

/// Thrown for a configuration that the bins cannot hold; one line.
class ProgramError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws ProgramError that names the option, the value and what is allowed. A tree's options are looked at
/// only where there is a tree.
void validate(const ProgramConfig& config);

/// What decides how much mono memory a scene takes.
struct SceneCounts {
  int triangles = 0;
  int lights = 0;
  int tree_slots = 0;  ///< of nodes; 0 without a tree
};

/// Where everything lies in mono memory.
struct Layout {
  // Written by the host before the run.
  cn::MonoPointer<CameraRecord> camera;
  cn::MonoPointer<TriangleRecord> triangles;
  cn::MonoPointer<SurfaceRecord> surfaces;
  cn::MonoPointer<LightRecord> lights;
  cn::MonoPointer<double> light_cdf;  ///< probability of light 0..i, one a light
  cn::MonoPointer<std::uint64_t> nodes;
  int triangle_count = 0;  ///< with a tree, triangles lie leaf by leaf, and behind them kLightRun a light
  int light_count = 0;
  int tree_slots = 0;
  int treelet_pool_blocks = 0;
  double reach = 0;  ///< no ray starts farther from a vertex (triangle_record.hpp)

  // Bins, one record a slot (vertices: slot_vertices a slot).
  cn::MonoPointer<RayRecord> ray_bin;
  cn::MonoPointer<QueuedRay> ray_queue;  ///< the ray bin with a tree
  cn::MonoPointer<std::uint64_t> traversal_bin;
  cn::MonoPointer<std::uint64_t> treelet_pool;
  cn::MonoPointer<HitRecord> intersection_bin;
  cn::MonoPointer<cn::MonoAddress> surface_place_bin;  ///< with a tree, or PEs keep them
  cn::MonoPointer<ScatterRecord> scatter_bin;
  cn::MonoPointer<LightingRecord> lighting_bin;
  cn::MonoPointer<DirectLightRecord> direct_light_bin;
  cn::MonoPointer<PathRecord> path_bin;
  cn::MonoPointer<VertexRecord> vertices;
  cn::MonoPointer<FoldRecord> folds;
  cn::MonoPointer<FinishedRecord> finished;

  // Read by the host; two halves, taken in turn, so that one can be read while the other is filled.
  cn::MonoPointer<ResultsHeader> results_header[2];
  cn::MonoPointer<RadianceRecord> results[2];

  std::uint64_t scene_bytes = 0;  ///< the host writes [0, scene_bytes)
  std::uint64_t total_bytes = 0;

  /// All of the above by name, for messages.
  struct Region {
    const char* name;
    cn::MonoAddress first;
    std::uint64_t bytes;
  };
  std::vector<Region> regions;
};

Layout make_layout(const SceneCounts& scene, int num_pes, const ProgramConfig& config);

/// Blocks of the traversal bin's ring: all rays at once, and room for blocks that are being loaded or saved.
int traversal_bin_blocks(const ProgramConfig& config);

/// Steps whose rays come from mono memory that are under way, from the load of their records to their turn.
int record_steps(const ProgramConfig& config);

/// A count by pass, in at most kMaxIntervals intervals of as many passes each; the last one may be shorter.
/// Two intervals become one when there are too many.
class PassCounts {
 public:
  static constexpr std::size_t kMaxIntervals = 64;

  void add(std::uint64_t count);

  std::uint64_t passes() const { return passes_; }
  std::uint64_t passes_per_interval() const { return passes_per_interval_; }
  const std::vector<std::uint64_t>& intervals() const { return intervals_; }

 private:
  std::uint64_t passes_ = 0;
  std::uint64_t passes_per_interval_ = 1;
  std::vector<std::uint64_t> intervals_;
};

/// Of the traversal bin.
struct TraversalCounts {
  std::uint64_t leaf_loads = 0;     ///< rays that loaded a leaf
  std::uint64_t treelet_loads = 0;  ///< rays that loaded a treelet
  std::vector<std::uint64_t> rays;  ///< by pass or turn, from the one that takes rays out of the ray bin
  std::vector<std::uint64_t>
      lanes;  ///< by pass: PEs of the blocks that they filled; with refill all as pass 0
  /// Until 95 % of the rays of a bin were through:
  std::uint64_t rays_before_tail = 0;
  std::uint64_t lanes_before_tail = 0;
};

/// Counts that belong to the firmware, not to the chip.
struct RunCounts {
  std::uint64_t paths = 0;
  std::uint64_t segments = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t folds = 0;           ///< paths flushed because their slot was full
  std::uint64_t blocks = 0;          ///< blocks of the ray bin processed
  std::uint64_t skipped_blocks = 0;  ///< empty blocks of the ray bin that were not
  std::uint64_t steps = 0;
  std::vector<std::uint64_t> paths_by_segments;  ///< [s]: paths that ended with s segments
  PassCounts rays;                               ///< in the ray bin, segments and shadow rays, by pass
  TraversalCounts traversal;
};

}  // namespace path_tracer
