#pragma once

#include "firmware/path_tracer/stages/ray_store.hpp"
#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// Intersection stage. A segment gets its shading details, roulette, new direction and shadow ray; a shadow
/// ray gets its light. A PE holds one or the other, so their records share SRAM.
///
/// Shadow rays go round the circular buffer like segments (paper, figure 1): a slot alternates between the
/// two, and every block is full of whichever.
class IntersectionStage : public Stage {
 public:
  /// @param rays where shadow rays go
  IntersectionStage(const StageContext& context, RayStore& rays) : Stage(context), ray_store_(rays) {}
  static int load_bytes(const ProgramConfig& config);
  static int save_bytes(const ProgramConfig& config);

  const char* name() const override { return "intersection stage"; }
  void load(std::uint64_t step, int block) override;
  bool prepares() const override {
    return context_.config.features.looks_up() || context_.config.resamples_lights();
  }
  /// Surfaces with their tails take too much SRAM for buffers of their own.
  bool loads_early() const override { return false; }
  /// Loads texels, and lights that are chosen by what was hit.
  void prepare(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

 protected:
  /// Records that belong to slots.
  enum class SlotRecord : std::uint8_t { hit, path, lighting, scatter, new_lighting, direct_light };

  /// The rays of a step: of a block of slots, or of others in PEs that are not their slots'.
  virtual Bins::Block& rays(int block) { return bin_block(block); }
  virtual cn::MonoPlaces places(SlotRecord record, std::uint64_t step, int block);
  /// The slots' block, for TransferRing::wait_block().
  virtual int block_of_slots(int block) const { return block; }
  virtual RaySlots slots(std::uint64_t /*step*/, int block) { return {block}; }

  /// Loads all that does not depend on textures.
  void load_records(std::uint64_t step, int block);
  void process_segments(std::uint64_t step, int block);
  void process_shadow_rays(std::uint64_t step, int block);

 private:
  struct Loads {
    PolyPointer<HitRecord> hit;
    PolyPointer<SurfaceRecord> surface;
    PolyPointer<TextureLookUp> look_ups;
    PolyPointer<PathRecord> path;  // segments
    PolyPointer<LightRecord> light;
    PolyPointer<LightResampling> resampling;
    PolyPointer<CandidateLookUp> candidates;
    PolyPointer<LightingRecord> lighting;  // shadow rays
  };
  struct Saves {
    PolyPointer<ScatterRecord> scatter;  // segments
    PolyPointer<LightingRecord> lighting;
    RayRoom shadow_ray;
    PolyPointer<DirectLightRecord> direct_light;  // shadow rays
  };
  Loads loads(std::uint64_t step) const;
  Saves saves(std::uint64_t step) const;
  void load_slots(SlotRecord record, std::uint64_t step, int block, cn::PolySpan to,
                  const LaneMask& enabled) {
    context_.loads.copy_m2p(step, block_of_slots(block), to, places(record, step, block), enabled);
  }
  void save_slots(SlotRecord record, std::uint64_t step, int block, cn::PolySpan from,
                  const LaneMask& enabled) {
    context_.saves.copy_p2m(step, block_of_slots(block), places(record, step, block), from, enabled);
  }
  void load_all_texels(std::uint64_t step, int block);
  /// Takes one of several candidates as the light of each vertex, and loads it.
  void load_resampled_lights(std::uint64_t step, int block);
  void load_environment(std::uint64_t step, int block);
  /// @return segments that passed what they hit
  LaneMask shade(const Loads& from, const ScatterArguments& arguments, const LaneMask& segments);

  RayStore& ray_store_;
};

}  // namespace path_tracer
