#include "firmware/path_tracer/stages/hit_bins.hpp"

#include <algorithm>

namespace path_tracer {
namespace {

/// The bin of a kind begins at this record.
std::uint64_t first_of_kind(const StageContext& context, int kind) {
  return std::uint64_t(kind) * std::uint64_t(context.config.bin_blocks) *
         std::uint64_t(context.machine.num_pes());
}

LaneMask pes_of(const HitBins::Run& run) {
  return LaneMask::first(run.first_pe + run.hits).without(LaneMask::first(run.first_pe));
}

}  // namespace

void HitBins::add_group(const std::vector<Run>& runs) {
  Group group;
  group.runs = runs;
  for (const Run& run : runs) {
    const LaneMask pes = pes_of(run);
    group.rays.live = group.rays.live.with(pes);
    if (run.kind == kShadowRayKind) group.rays.shadow = group.rays.shadow.with(pes);
    if (run.kind >= kFirstMaterialKind) group.rays.hit_something = group.rays.hit_something.with(pes);
  }
  groups.push_back(std::move(group));
}

void HitBins::group(int num_pes) {
  std::vector<Run> mixed;
  int pes_used = 0;
  for (int kind = 0; kind < static_cast<int>(hits.size()); ++kind) {
    const int of_kind = hits[std::size_t(kind)];
    int first = 0;
    for (; of_kind - first >= num_pes; first += num_pes) add_group({{kind, first, 0, num_pes}});
    if (kind == kShadowRayKind && first < of_kind) {
      add_group({{kind, first, 0, of_kind - first}});  // shadow rays share no kernel with other kinds
      continue;
    }
    while (first < of_kind) {
      const int taken = std::min(of_kind - first, num_pes - pes_used);
      mixed.push_back({kind, first, pes_used, taken});
      first += taken;
      pes_used += taken;
      if (pes_used < num_pes) continue;
      add_group(mixed);
      mixed.clear();
      pes_used = 0;
    }
  }
  if (!mixed.empty()) add_group(mixed);
}

BinHitsStage::BinHitsStage(const StageContext& context, HitBins& bins)
    : Stage(context),
      bins_(bins),
      number_{context.machine.poly_memory().allocate("numbers of hits", sizeof(std::int32_t)).offset_bytes} {}

BinHitsStage::Saves BinHitsStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  const auto hit = cutter.take<BinnedHit>();
  return {hit, cutter.take_place()};
}

void BinHitsStage::load(std::uint64_t step, int block) {
  if (context_.config.features.shading_kinds == 1) return;
  const Bins::Block& bin = bin_block(block);
  const PolyPointer<ShadingKindRecord> kind(context_.loads.buffer(step));
  context_.loads.copy_m2p(
      step, block, kind.span(),
      context_.machine.places_in(bin.surface_place, std::uint64_t(context_.layout.sizes.shading_kind)),
      bin.hit_something.without(bin.shadow));
}

void BinHitsStage::process(std::uint64_t step, int block) {
  const Bins::Block& bin = bin_block(block);
  BinHitArguments arguments;
  arguments.surface_place = bin.surface_place;
  arguments.light_place = bin.light_place;
  arguments.first_slot = static_cast<int>(first_slot(block));
  arguments.hit_something = &bin.hit_something;
  arguments.hit = saves(step).hit;
  context_.machine.run(context_.kernels.bin_hit, arguments, bin.live);

  const LaneMask hits = bin.hit_something.without(bin.shadow);
  append(step, kShadowRayKind, bin.shadow);
  append(step, kMissKind, bin.segments().without(hits));
  const int kinds = context_.config.features.shading_kinds;
  if (kinds == 1) return append(step, kFirstMaterialKind, hits);
  const PolyPointer<ShadingKindRecord> record(context_.loads.buffer(step));
  for (int kind = 0; kind < kinds; ++kind) {
    LaneMask of_kind;
    EqualArguments equal;
    equal.value = record.field(&ShadingKindRecord::kind);
    equal.wanted = kind;
    equal.equal = &of_kind;
    context_.machine.run(context_.kernels.traversal().equal, equal, hits);
    append(step, kFirstMaterialKind + kind, of_kind);
  }
}

void BinHitsStage::append(std::uint64_t step, int kind, const LaneMask& of_kind) {
  if (!of_kind.any()) return;
  int& hits = bins_.hits[std::size_t(kind)];
  const int count = context_.machine.number_ascending(of_kind, number_);
  NumberedPlaceArguments arguments;
  arguments.number = number_;
  arguments.records = {
      (context_.layout.binned_hits + first_of_kind(context_, kind) + std::uint64_t(hits)).address,
      int{sizeof(BinnedHit)}};
  arguments.place = saves(step).place;
  context_.machine.run(context_.kernels.binned_hit_place, arguments, of_kind);
  hits += count;
}

void BinHitsStage::save(std::uint64_t step, int block) {
  const Saves from = saves(step);
  context_.saves.copy_p2m(step, TransferRing::kNoBlock, context_.machine.places_in(from.place),
                          from.hit.span(), bin_block(block).live);
  bins_.last_binned_step = step;
}

BinnedIntersectionStage::BinnedIntersectionStage(const StageContext& context, RayStore& rays, HitBins& bins)
    : IntersectionStage(context, rays),
      bins_(bins),
      hits_(context.machine, "binned hit",
            {record_steps(context.config), int{sizeof(BinnedHit)} + 2 * int{sizeof(MonoAddress)},
             !context.config.buffers_loads()}) {}

int BinnedIntersectionStage::save_bytes(const ProgramConfig& config) {
  return IntersectionStage::save_bytes(config) + 5 * int{sizeof(MonoAddress)};
}

BinnedIntersectionStage::Loads BinnedIntersectionStage::binned_loads(std::uint64_t step) const {
  BufferCutter cutter(hits_.buffer(step));
  const auto hit = cutter.take<BinnedHit>();
  const auto hit_place = cutter.take_place();
  return {hit, hit_place, cutter.take_place()};
}

BinnedIntersectionStage::Saves BinnedIntersectionStage::binned_saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  cutter.take_bytes<BinnedHit>(IntersectionStage::save_bytes(context_.config));
  Saves saves;
  for (PolyField<MonoAddress>* const field :
       {&saves.casts, &saves.casts_place, &saves.result_place, &saves.lighting_place, &saves.ray_place})
    *field = cutter.take_place();
  return saves;
}

cn::MonoPlaces BinnedIntersectionStage::places(SlotRecord record, std::uint64_t step, int /*group*/) {
  switch (record) {
    case SlotRecord::hit:
      return context_.machine.places_in(binned_loads(step).hit_place);
    case SlotRecord::path:
    case SlotRecord::lighting:
      return context_.machine.places_in(binned_loads(step).path_place);
    case SlotRecord::new_lighting:
      return context_.machine.places_in(binned_saves(step).lighting_place);
    case SlotRecord::scatter:
    case SlotRecord::direct_light:
      break;
  }
  return context_.machine.places_in(binned_saves(step).result_place);
}

RaySlots BinnedIntersectionStage::slots(std::uint64_t step, int /*group*/) {
  return {TransferRing::kNoBlock, binned_loads(step).hit.field(&BinnedHit::slot),
          binned_saves(step).ray_place};
}

void BinnedIntersectionStage::load(std::uint64_t step, int group) {
  context_.saves.wait_until(bins_.last_binned_step);
  HitBins::Group& hits = bins_.groups[std::size_t(group)];
  const PolyPointer<BinnedHit> to = binned_loads(step).hit;
  for (const HitBins::Run& run : hits.runs) {
    const cn::MonoAddress first =
        context_.layout.binned_hits.address +
        (first_of_kind(context_, run.kind) + std::uint64_t(run.first)) * sizeof(BinnedHit);
    hits_.copy_m2p(
        step, TransferRing::kNoBlock, to.span(),
        cn::MonoPlaces::array(first - std::uint64_t(run.first_pe) * sizeof(BinnedHit), sizeof(BinnedHit)),
        pes_of(run));
  }
  hits.rays.surface_place = to.field(&BinnedHit::surface_place);
  hits.rays.light_place = to.field(&BinnedHit::light_place);
}

void BinnedIntersectionStage::locate_loads(std::uint64_t step, int group) {
  const Loads to = binned_loads(step);
  const Layout& layout = context_.layout;
  LocateSlotArguments arguments;
  arguments.slot = to.hit.field(&BinnedHit::slot);
  arguments.records[0] = {layout.intersection_bin.address, layout.sizes.hit};
  arguments.place[0] = to.hit_place;
  arguments.records[1] = has_shadow_rays(group)
                             ? MonoRecords{layout.lighting_bin.address, layout.sizes.lighting}
                             : MonoRecords{layout.path_bin.address, layout.sizes.path};
  arguments.place[1] = to.path_place;
  arguments.places = 2;
  context_.machine.run(context_.kernels.locate_slot, arguments, rays(group).live);
}

void BinnedIntersectionStage::prepare(std::uint64_t step, int group) {
  hits_.wait(step);
  locate_loads(step, group);
  Bins::Block& hits = rays(group);
  if (has_shadow_rays(group))
    context_.machine.run(context_.kernels.traversal().recall,
                         RecallArguments{hits.surface_place, &hits.hit_something}, hits.live);
  load_records(step, group);
  const Features& features = context_.config.features;
  const bool shadow_rays_look_up = features.lights.environment || features.textures.any_for_shadow_rays();
  if (!has_shadow_rays(group) || shadow_rays_look_up) IntersectionStage::prepare(step, group);
}

void BinnedIntersectionStage::locate_saves(std::uint64_t step, int group) {
  const Saves to = binned_saves(step);
  const Layout& layout = context_.layout;
  LocateSlotArguments arguments;
  arguments.slot = binned_loads(step).hit.field(&BinnedHit::slot);
  const auto locate = [&](MonoRecords records, PolyField<MonoAddress> place) {
    arguments.records[arguments.places] = records;
    arguments.place[arguments.places++] = place;
  };
  locate(has_shadow_rays(group) ? MonoRecords{layout.direct_light_bin.address, int{sizeof(DirectLightRecord)}}
                                : MonoRecords{layout.scatter_bin.address, layout.sizes.scatter},
         to.result_place);
  if (context_.config.casts_shadow_rays()) {
    locate({layout.casts_bin.address, int{sizeof(MonoAddress)}}, to.casts_place);
    locate({layout.lighting_bin.address, layout.sizes.lighting}, to.lighting_place);
    if (!context_.config.uses_tree()) locate({layout.ray_bin.address, int{sizeof(RayRecord)}}, to.ray_place);
  }
  context_.machine.run(context_.kernels.locate_slot, arguments, rays(group).live);
}

void BinnedIntersectionStage::process(std::uint64_t step, int group) {
  locate_saves(step, group);
  const Bins::Block& hits = rays(group);
  if (has_shadow_rays(group)) {
    process_shadow_rays(step, group);
  } else {
    process_segments(step, group);
  }
  if (context_.config.casts_shadow_rays())
    context_.machine.run(context_.kernels.flag, FlagArguments{&hits.casts, binned_saves(step).casts},
                         hits.live);
}

void BinnedIntersectionStage::save(std::uint64_t step, int group) {
  IntersectionStage::save(step, group);
  bins_.last_shaded_step = step;
  if (!context_.config.casts_shadow_rays()) return;
  const Saves from = binned_saves(step);
  context_.saves.copy_p2m(step, TransferRing::kNoBlock, context_.machine.places_in(from.casts_place),
                          {from.casts.offset_bytes, sizeof(MonoAddress)}, rays(group).live);
}

void RecallCastsStage::load(std::uint64_t step, int block) {
  context_.saves.wait_until(bins_.last_shaded_step);
  context_.loads.copy_m2p(step, block, {context_.loads.buffer(step).offset_bytes, sizeof(MonoAddress)},
                          block_of(context_.layout.casts_bin, block), bin_block(block).live);
}

void RecallCastsStage::process(std::uint64_t step, int block) {
  Bins::Block& bin = bin_block(block);
  bin.casts = LaneMask{};
  const PolyField<MonoAddress> casts{context_.loads.buffer(step).offset_bytes};
  context_.machine.run(context_.kernels.traversal().recall, RecallArguments{casts, &bin.casts}, bin.live);
}

}  // namespace path_tracer
