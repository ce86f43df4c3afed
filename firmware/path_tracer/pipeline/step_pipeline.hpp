#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>

#include "firmware/path_tracer/stages/slot_states.hpp"
#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// A stage on one block.
struct Step {
  Stage* stage;
  int block;
  std::uint64_t number = 0;  ///< in the order of loading, which is that of processing
  bool just_loaded = true;   ///< its loads were begun after the last step was processed
  bool is_prepared = false;  ///< Stage::prepare()
};

/// The n-buffer (paper, section 3.3): runs steps one after the other. While step m is processed, the loads of
/// steps m+1..m+n and the saves of steps m-1..m-n are under way, across the borders between stages.
///
///     plan() -> planned -> load_ahead() -> loaded -> run_next(): wait, process, save
class StepPipeline {
 public:
  /// The rings of its stages, and the number of steps that may be loaded at a time, the one to be processed
  /// included.
  struct Buffers {
    TransferRing& loads;
    TransferRing& saves;
    int steps;
    SlotStates* slot_states = nullptr;  ///< of stream execution
  };

  StepPipeline(cn::Machine& machine, const Buffers& buffers) : machine_(machine), buffers_(buffers) {}

  /// Puts a step behind those that are planned.
  void plan(Stage& stage, int block) { planned_.push_back({&stage, block}); }
  bool has_planned() const { return !planned_.empty(); }

  /// Begins the loads of as many planned steps as the buffers hold.
  void load_ahead();
  /// The loaded step that is processed next; nullptr when none is loaded.
  const Step* next() const { return loaded_.empty() ? nullptr : &loaded_.front(); }

  /// Processes and saves the next step.
  Step run_next();
  /// Runs a step that loads nothing, at once. `process` takes the place of Stage::process().
  void run_without_loads(Stage& stage, int block, const std::function<void(std::uint64_t step)>& process);

  /// Steps whose loads were begun.
  std::uint64_t steps() const { return next_number_; }
  /// Waits until the saves of all steps are over.
  void wait_for_saves();

 private:
  /// Whether the step's first loads bring the state of its slots, which tells what else to load.
  bool loads_slot_states(const Step& step) const {
    return buffers_.slot_states != nullptr && step.stage->works_on_slots();
  }
  bool prepares(const Step& step) const { return loads_slot_states(step) || step.stage->prepares(); }
  bool loads_early(const Step& step) const { return loads_slot_states(step) || step.stage->loads_early(); }
  void load(const Step& step);
  void prepare(const Step& step);
  void save(const Step& step);
  std::size_t look_ahead(const Step& step) const;
  bool can_load(const Step& step) const;
  void prepare_steps();
  void label(const Stage& stage, int block) { machine_.set_label({stage.name(), block}); }

  cn::Machine& machine_;
  Buffers buffers_;
  std::deque<Step> planned_;
  std::deque<Step> loaded_;  ///< loads under way or over
  std::uint64_t next_number_ = 0;
};

}  // namespace path_tracer
