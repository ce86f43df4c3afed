#include "firmware/path_tracer/stages/slot_states.hpp"

#include "firmware/path_tracer/kernels/stream_kernels.hpp"

namespace path_tracer {
namespace {

std::array<LaneMask*, kSlotConditions> conditions_of(Bins::Block& slots) {
  return {&slots.live, &slots.shadow, &slots.hit_something, &slots.casts, &slots.ended, &slots.finished};
}

}  // namespace

SlotStates::SlotStates(const StageContext& context)
    : machine_(context.machine),
      kernels_(context.kernels),
      bins_(context.bins),
      first_(context.layout.slot_states),
      buffers_loads_(context.config.buffers_loads()),
      buffers_saves_(context.config.buffers_saves()),
      ring_(
          machine_, "slot state",
          {record_steps(context.config) + context.config.save_buffers() - 1, int{sizeof(SlotState)}, false}) {
}

cn::MonoPlaces SlotStates::places(int block) const {
  const auto first_slot = std::uint64_t(block) * std::uint64_t(machine_.num_pes());
  return cn::MonoPlaces::array((first_ + first_slot).address, sizeof(SlotState));
}

void SlotStates::point_to(std::uint64_t step, int block) {
  slots(block).surface_place = state(step).field(&SlotState::surface_place);
  slots(block).light_place = state(step).field(&SlotState::light_place);
}

void SlotStates::load(std::uint64_t step, int block) {
  for (LaneMask* const condition : conditions_of(slots(block))) *condition = LaneMask{};
  ring_.wait(step);
  ring_.wait_block(block);
  ring_.copy_m2p(step, block, state(step).span(), places(block), LaneMask::first(machine_.num_pes()));
  if (!buffers_loads_) ring_.wait(step);
}

void SlotStates::recall(std::uint64_t step, int block) {
  ring_.wait(step);
  point_to(step, block);
  machine_.run(kernels_.stream().recall_slots, RecallSlotsArguments{state(step), conditions_of(slots(block))},
               LaneMask::first(machine_.num_pes()));
}

void SlotStates::claim(std::uint64_t step, int block) {
  ring_.wait(step);
  point_to(step, block);
}

void SlotStates::save(std::uint64_t step, int block) {
  KeepSlotsArguments arguments;
  arguments.state = state(step);
  const auto conditions = conditions_of(slots(block));
  std::copy(conditions.begin(), conditions.end(), arguments.conditions.begin());
  machine_.run(kernels_.stream().keep_slots, arguments, LaneMask::first(machine_.num_pes()));
  ring_.copy_p2m(step, block, places(block), state(step).span(), LaneMask::first(machine_.num_pes()));
  if (!buffers_saves_) ring_.wait(step);
}

}  // namespace path_tracer
