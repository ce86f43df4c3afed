#pragma once

#include <cstdint>
#include <stdexcept>

#include "firmware/path_tracer/program/built_for.hpp"
#include "firmware/path_tracer/records/features.hpp"
#include "firmware/path_tracer/records/traversal_record.hpp"

/// The firmware's options and their ranges.
namespace path_tracer {

/// What is timed; the columns of the paper's tables.
enum class Program : std::uint8_t {
  segments,  ///< path segments only; light is found by hitting it
  direct,    ///< plus one shadow ray a segment
  full,      ///< plus the radiance of finished paths
};

/// Where paths begin.
enum class Paths : std::uint8_t {
  unidirectional,  ///< at the lens
  bidirectional,   ///< at the lens and at a light; vertices of both are joined (paper, section 5)
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

/// How the light of emitting triangles reaches a path in the programs with shadow rays.
enum class Estimator : std::uint8_t {
  light,     ///< by shadow rays; by hits only where no shadow ray can, behind mirrors and glass
  mis,       ///< by both, weighed against each other (Veach and Guibas, SIGGRAPH 1995; power heuristic)
  per_lobe,  ///< diffuse surfaces by shadow rays, glossy ones by both
};

/// Which hits are shaded together, and which lobes they are charged for.
enum class Shading : std::uint8_t {
  every_lobe,     ///< a block of slots; every lobe of the scene is issued
  present_lobes,  ///< a block of slots; a lobe that no hit of the block has is skipped
  material_bins,  ///< hits whose materials have the same lobes; shadow rays and misses apart
  texture_bins,   ///< the same, and whose materials use the same texture images
};

/// How a ray finds the triangles that it may hit.
enum class Traversal : std::uint8_t {
  brute_force,  ///< by a test of every triangle
  // Through a tree of which each PE loads the piece that its ray needs:
  temporary_bin,  ///< rays wait in a bin between two pieces (paper, section 5)
  refill,         ///< rays stay in their PE; idle PEs load new ones
  lock_step,      ///< like refill, but waits until all PEs are idle
  /// Through a tree that the control unit traverses for a block of rays at once.
  packets,
  /// Through a tree of which a block of rays shares the piece that all of them need.
  shared_treelets,
  // Through a tree that the control unit traverses for several blocks of rays at once:
  large_packets,  ///< culled by the interval of all rays, then tested from the first active block on
  ray_streams,    ///< of which each PE filters the rays that are active in a node
  /// Through a tree that the chip's search unit walks; PEs hand it their rays and load their hits.
  ray_unit,
};

/// How a stage's data go from one kernel to the next.
enum class Execution : std::uint8_t {
  mtap,  ///< PEs keep what the next kernel needs; the PE-to-PE path numbers and compacts (paper, section 4)
  /// As on a stream processor (Purcell, "Ray Tracing on a Stream Processor", PhD thesis, Stanford 2004): each
  /// kernel reads its streams from mono memory and writes all results back.
  stream,
};

/// Which arrays of the scene the firmware copies to the memory on the chip, as it starts.
enum class Scratchpad : std::uint8_t {
  none,
  nodes,      ///< of the tree
  triangles,  ///< their records for the intersection test
  fitting,    ///< nodes, triangles, surfaces and lights, in this order, each as a whole if it fits
};

inline constexpr int kMaxBuffers = 8;
inline constexpr int kMaxResidentPaths = 4;  ///< as many as a vector instruction has elements
inline constexpr int kResidentResults = 8;   ///< that a PE collects until they are copied to mono memory
inline constexpr int kMaxLightCandidates = 8;
inline constexpr int kMaxPacketBlocks = 16;
inline constexpr int kMaxLightVertices = 16;

/// Limits far beyond what fits the chip; they keep slot numbers within 32 bits.
inline constexpr int kMaxBinBlocks = 65536;
inline constexpr int kMaxSlotVertices = 4096;

/// Vertices of a path that one step of the radiance stage loads.
inline constexpr int kVerticesPerLoad = 4;

/// How the firmware is built and run.
struct ProgramConfig {
  Features features;  ///< of the scene; PathTracer takes them from the layout
  Program program = Program::full;
  Execution execution = Execution::mtap;
  Paths paths = Paths::unidirectional;
  int light_vertices = 2;  ///< of a light path that a slot keeps, at most; of bidirectional paths
  int n = 1;               ///< blocks loaded ahead and saved behind, 0 to kMaxBuffers
  bool buffer_loads = true;
  bool buffer_saves = true;
  int bin_blocks = 8;      ///< length of each bin in blocks of one SIMD width
  int slot_vertices = 16;  ///< vertices a path slot holds; a multiple of kVerticesPerLoad
  int roulette_start = 0;  ///< segments a path lives without roulette
  /// Below 1, so that paths between white surfaces end. Where it is below an albedo, weights grow from bounce
  /// to bounce by albedo / max_survival; above the albedo's square, their variance stays finite.
  double max_survival = 0.999999;
  bool skips_empty_blocks = true;
  bool cull_shadow_rays = true;  ///< leave out those whose surface or light faces away
  Sampler sampler = Sampler::philox;
  LightSampling light_sampling = LightSampling::area;
  Estimator estimator = Estimator::per_lobe;
  int light_candidates = 1;  ///< lights of which a vertex takes one by its estimated effect
  /// A texture whose texels are all equal is a factor of its material, which nobody looks up.
  bool folds_constant_textures = true;
  int built_for = kBuiltForScene;  ///< a row of kBuiltForTable: the scene alone, or with more features
  Shading shading = Shading::present_lobes;
  int resident_paths = 0;  ///< paths that each PE keeps in its SRAM, beside the whole scene; 0: bins
  std::uint64_t seed = 1;
  /// Pixels from one camera ray to the next, cyclic over the film; must have no common divisor with the
  /// number of pixels. The image is the same; only the distance between rays of one block changes.
  int pixel_stride = 1;
  Scratchpad scratchpad = Scratchpad::none;
  Traversal traversal = Traversal::brute_force;
  int packet_blocks = 8;  ///< blocks of rays in a large packet or a ray stream
  TreeShape tree;

  bool is_bidirectional() const { return paths == Paths::bidirectional; }
  bool uses_tree() const { return traversal != Traversal::brute_force; }
  bool is_stream() const { return execution == Execution::stream; }
  /// Whether the control unit traverses the tree, so that PEs load none of it.
  bool uses_packets() const {
    return traversal == Traversal::packets || traversal == Traversal::large_packets ||
           traversal == Traversal::ray_streams;
  }
  bool hands_rays_to_unit() const { return traversal == Traversal::ray_unit; }
  /// Whether PEs take rays through the tree, or the control unit does for them.
  bool walks_tree() const { return uses_tree() && !hands_rays_to_unit(); }
  /// Whether hits wait in bins of their kind, instead of in their slots.
  bool bins_hits() const { return shading == Shading::material_bins || shading == Shading::texture_bins; }
  /// Whether paths stay in the PEs' SRAM, instead of going round bins in mono memory.
  bool keeps_paths_in_sram() const { return resident_paths > 0; }
  bool casts_shadow_rays() const { return program != Program::segments && features.lights.any(); }
  bool buffers_loads() const { return buffer_loads && n > 0; }
  bool buffers_saves() const { return buffer_saves && n > 0; }
  bool resamples_lights() const { return casts_shadow_rays() && light_candidates > 1; }
  int load_buffers() const { return buffers_loads() ? n + 1 : 1; }
  int save_buffers() const { return buffers_saves() ? n + 1 : 1; }
};

/// Thrown for a configuration that is out of range or that the bins cannot hold; one line.
class ProgramError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws ProgramError that names the option, the value and what is allowed. The options of a tree are
/// checked only if the traversal uses one.
void validate(const ProgramConfig& config);

}  // namespace path_tracer
