#include "firmware/path_tracer/traversals/ray_unit_search.hpp"

#include <memory>
#include <string>

#include "firmware/path_tracer/traversals/ray_unit_function.hpp"

namespace path_tracer {
namespace {

// Instructions of the control unit that write the unit's registers (assumed): addresses and sizes of nodes,
// triangles and surfaces, the node's format, the scene's reach and anchor.
constexpr std::uint64_t kProgramInstructions = 40;

/// Points to the unit's buffer and programs the unit. Returns where rays are written.
cn::MonoAddress program_unit(const StageContext& context, Layout& layout) {
  cn::Machine& machine = context.machine;
  const cn::MonoRange buffer = machine.search_unit();
  if (buffer.bytes == 0)
    throw ProgramError(
        "traversal: found ray_unit, allowed is a way that the chip has: it is without a search unit "
        "(search_unit.units is 0)");
  const int most = RayUnitSearch::most_bin_blocks(buffer, layout.sizes, machine.num_pes());
  if (context.config.bin_blocks > most)
    throw ProgramError("bin_blocks: found " + std::to_string(context.config.bin_blocks) +
                       ", allowed is at most " + std::to_string(most) + " with traversal ray_unit: rays of " +
                       std::to_string(machine.num_pes()) +
                       " PEs a block in the search unit's buffer of search_unit.buffer_bytes (" +
                       std::to_string(buffer.bytes) + ")");
  auto function = std::make_shared<RayUnitFunction>(context.kernels.traversal(), context.config, layout);
  const cn::SearchPlaces places =
      cn::search_places(buffer, function->query_bytes(), function->answer_bytes());
  machine.issue_mono(kProgramInstructions);
  machine.program_search_unit(std::move(function));
  layout.intersection_bin.address = places.answers[0];
  layout.surface_place_bin.address = places.answers[1];
  return places.queries;
}

}  // namespace

UnitRays::UnitRays(const StageContext& context, cn::MonoAddress first)
    : machine_(context.machine),
      kernels_(context.kernels),
      first_(first),
      lights_(context.layout.lights.address),
      number_{machine_.poly_memory().allocate("numbers of PEs", sizeof(std::int32_t)).offset_bytes},
      last_writer_(std::size_t(context.config.bin_blocks)) {
  machine_.number_ascending(LaneMask::first(machine_.num_pes()), number_);
}

RayRoom UnitRays::take_room(BufferCutter& cutter) const {
  const PolyPointer<QueuedRay> queued = cutter.take<QueuedRay>();
  return {queued.part(&QueuedRay::ray), queued, cutter.take_place()};
}

void UnitRays::save(TransferRing& saves, std::uint64_t step, const RaySlots& slots, const RayRoom& from,
                    PolyField<MonoAddress> light_place, const LaneMask& with_ray) {
  if (!with_ray.any()) return;
  const std::uint64_t first_slot =
      slots.is_block() ? std::uint64_t(slots.block) * std::uint64_t(machine_.num_pes()) : 0;
  EnqueueArguments arguments;
  arguments.number = slots.is_block() ? number_ : slots.slot;
  arguments.ray = from.queued;
  arguments.light_place = light_place;
  arguments.lights = lights_;
  arguments.first_slot = static_cast<int>(first_slot);
  if (!slots.is_block()) arguments.slots = &slots.slot;
  arguments.first_place = first_ + first_slot * sizeof(QueuedRay);
  arguments.place = from.place;
  machine_.run(kernels_.traversal().enqueue, arguments, with_ray);
  const cn::MonoPlaces places = slots.is_block()
                                    ? cn::MonoPlaces::array(arguments.first_place, sizeof(QueuedRay))
                                    : machine_.places_in(from.place);
  saves.copy_p2m(step, slots.block, places, from.queued.span(), with_ray);
  if (slots.is_block()) {
    last_writer_[std::size_t(slots.block)] = step;
  } else {
    last_writer_.assign(last_writer_.size(), step);
  }
}

RayUnitSearch::RayUnitSearch(const StageContext& context, Layout& layout)
    : rays_(context, program_unit(context, layout)),
      recall_(context, [this](int block) { return rays_.last_writer(block); }) {}

int RayUnitSearch::most_bin_blocks(const cn::MonoRange& buffer, const RecordSizes& sizes, int num_pes) {
  return cn::search_places(buffer, RayUnitFunction::query_bytes_of_ray(),
                           RayUnitFunction::answer_bytes_of_ray(sizes))
             .entries /
         num_pes;
}

}  // namespace path_tracer
