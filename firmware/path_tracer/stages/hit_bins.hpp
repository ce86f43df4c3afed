#pragma once

#include <vector>

#include "firmware/path_tracer/stages/intersection_stage.hpp"

namespace path_tracer {

/// Bins of hits of one kind each: shadow rays, misses, and hits of materials that have the same lobes
/// (Shading::material_bins; Laine, Karras and Aila, "Megakernels Considered Harmful", HPG 2013). Hits that
/// are shaded together issue the lobes of their kind only. What is left of kinds after full groups is shaded
/// in groups of several kinds, since a group costs as much as a full one.
struct HitBins {
  /// Hits of one kind that follow each other in its bin, and in a group's PEs.
  struct Run {
    int kind;
    int first;  ///< in the kind's bin
    int first_pe;
    int hits;
  };
  /// Hits that are shaded in one step, one in each PE.
  struct Group {
    std::vector<Run> runs;
    Bins::Block rays;

    bool has_shadow_rays() const { return runs.front().kind == kShadowRayKind; }
  };
  std::vector<int> hits;  ///< of each kind
  std::vector<Group> groups;
  std::uint64_t last_binned_step = 0;  ///< whose save brought hits
  std::uint64_t last_shaded_step = 0;  ///< whose save brought what follows from a group

  /// Empty bins for so many kinds.
  void clear(int kinds) {
    hits.assign(std::size_t(kinds), 0);
    groups.clear();
  }
  /// Makes groups of all hits.
  void group(int num_pes);

 private:
  void add_group(const std::vector<Run>& runs);
};

/// Puts the hits of a block of slots into the bins of their kinds.
class BinHitsStage : public Stage {
 public:
  BinHitsStage(const StageContext& context, HitBins& bins);
  static int load_bytes() { return int{sizeof(ShadingKindRecord)}; }
  static int save_bytes() { return int{sizeof(BinnedHit)} + int{sizeof(MonoAddress)}; }

  const char* name() const override { return "bins of hits"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

 private:
  struct Saves {
    PolyPointer<BinnedHit> hit;
    PolyField<MonoAddress> place;
  };
  Saves saves(std::uint64_t step) const;
  void append(std::uint64_t step, int kind, const LaneMask& of_kind);

  HitBins& bins_;
  PolyField<std::int32_t> number_;
};

/// The intersection stage for a group of hits: their slots' records are gathered and scattered.
class BinnedIntersectionStage : public IntersectionStage {
 public:
  BinnedIntersectionStage(const StageContext& context, RayStore& rays, HitBins& bins);
  static int save_bytes(const ProgramConfig& config);

  bool works_on_slots() const override { return false; }
  void load(std::uint64_t step, int group) override;
  bool prepares() const override { return true; }
  bool loads_early() const override { return true; }
  /// Loads what the first load phase has the places of.
  void prepare(std::uint64_t step, int group) override;
  void process(std::uint64_t step, int group) override;
  void save(std::uint64_t step, int group) override;

 protected:
  Bins::Block& rays(int group) override { return bins_.groups[std::size_t(group)].rays; }
  cn::MonoPlaces places(SlotRecord record, std::uint64_t step, int group) override;
  int block_of_slots(int) const override { return TransferRing::kNoBlock; }
  RaySlots slots(std::uint64_t step, int group) override;

 private:
  struct Loads {
    PolyPointer<BinnedHit> hit;
    PolyField<MonoAddress> hit_place;
    PolyField<MonoAddress> path_place;  ///< a shadow ray's: of its LightingRecord
  };
  /// Behind the records of the intersection stage.
  struct Saves {
    PolyField<MonoAddress> casts;
    PolyField<MonoAddress> casts_place;
    PolyField<MonoAddress> result_place;  ///< of a ScatterRecord or DirectLightRecord
    PolyField<MonoAddress> lighting_place;
    PolyField<MonoAddress> ray_place;
  };
  Loads binned_loads(std::uint64_t step) const;
  Saves binned_saves(std::uint64_t step) const;
  bool has_shadow_rays(int group) const { return bins_.groups[std::size_t(group)].has_shadow_rays(); }
  void locate_loads(std::uint64_t step, int group);
  void locate_saves(std::uint64_t step, int group);

  HitBins& bins_;
  TransferRing hits_;  ///< of Loads
};

/// Tells the slots of a block which of them cast a shadow ray.
class RecallCastsStage : public Stage {
 public:
  RecallCastsStage(const StageContext& context, const HitBins& bins) : Stage(context), bins_(bins) {}

  const char* name() const override { return "bins of hits"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t, int) override {}

 private:
  const HitBins& bins_;
};

}  // namespace path_tracer
