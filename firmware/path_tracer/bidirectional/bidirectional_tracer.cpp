#include "firmware/path_tracer/bidirectional/bidirectional_tracer.hpp"

#include <algorithm>

namespace path_tracer {

BidirectionalTracer::BidirectionalTracer(cn::Machine& machine, const Kernels& kernels,
                                         const ProgramConfig& config, const Layout& layout, const Work& work)
    : machine_(with_semaphores_and_stack(machine)),
      kernels_(kernels),
      config_(built_for(layout, config)),
      layout_(layout),
      bins_(make_bins(machine.poly_memory(), config_)),
      rings_(make_rings(machine, config_, layout.layers,
                        std::max(VertexStage::load_bytes(config_), ConnectionStage::load_bytes(config_)),
                        std::max(VertexStage::save_bytes(config_), ConnectionStage::save_bytes(config_)))),
      scratchpad_(machine, rings_.loads, config_.scratchpad, layout_),
      search_(make_search(context(), layout_)),
      pairs_(context(), kernels.pair()),
      vertex_stage_(context(), pairs_, work),
      connection_stage_(context(), pairs_, search_->rays()),
      steps_(machine, {rings_.loads, rings_.saves, config_.load_buffers()}),
      results_(machine, layout_) {}

void BidirectionalTracer::run(const Progress& progress) {
  vertex_stage_.begin_results(results_.half());
  fill_bins();
  while (true) {
    steps_.load_ahead();
    if (steps_.next() == nullptr) break;
    if (progress && !progress(vertex_stage_.pairs().issued())) vertex_stage_.stop_pairs();
    run_next_step();
  }
  announce_results();
  steps_.wait_for_saves();
  counts_.paths = vertex_stage_.pairs().issued();
  counts_.steps = steps_.steps();
}

void BidirectionalTracer::fill_bins() {
  for (int block = 0; block < config_.bin_blocks && vertex_stage_.pairs().remaining() > 0; ++block) {
    steps_.run_without_loads(vertex_stage_, block,
                             [&](std::uint64_t step) { vertex_stage_.fill(step, block); });
    plan_connections(block);
  }
}

void BidirectionalTracer::run_next_step() {
  const Step step = steps_.run_next();
  if (step.stage == &vertex_stage_) {
    --vertex_steps_left_;
    plan_connections(step.block);
  } else if (step.stage == &connection_stage_) {
    after_connection_step(step.block);
  } else if (search_->has(*step.stage) && search_->after_step(steps_, step, blocks_)) {
    plan_vertex_stage();
  }
  if (vertex_steps_left_ == 0 && connection_steps_left_ == 0) begin_pass();
}

void BidirectionalTracer::plan_connections(int block) {
  if (!pairs_.block(block).occupied.any()) {
    bins_.blocks[std::size_t(block)].live = LaneMask{};
    machine_.report_fill(block, LaneMask{});
    return;
  }
  steps_.plan(connection_stage_, block);
  ++connection_steps_left_;
}

void BidirectionalTracer::after_connection_step(int block) {
  --connection_steps_left_;
  machine_.report_fill(block, bins_.blocks[std::size_t(block)].live);
  next_blocks_.push_back(block);
  search_->add_block(steps_, block);
}

void BidirectionalTracer::begin_pass() {
  announce_results();
  blocks_.swap(next_blocks_);
  next_blocks_.clear();
  vertex_steps_left_ = blocks_.size();
  count_pass(blocks_, bins_, counts_);
  if (search_->begin_pass(steps_, blocks_)) plan_vertex_stage();
}

void BidirectionalTracer::plan_vertex_stage() {
  for (const int block : blocks_) steps_.plan(vertex_stage_, block);
}

/// The results of a pass, if it has any. Their saves have ended long ago.
void BidirectionalTracer::announce_results() {
  if (vertex_stage_.results() == 0) return;
  rings_.saves.wait_until(vertex_stage_.last_result_step());
  results_.announce(vertex_stage_.results());
  vertex_stage_.begin_results(results_.half());
}

}  // namespace path_tracer
