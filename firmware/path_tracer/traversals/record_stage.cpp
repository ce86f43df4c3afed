#include "firmware/path_tracer/traversals/record_stage.hpp"

namespace path_tracer {

int RecordRing::buffers(const ProgramConfig& config) {
  return record_steps(config) + config.save_buffers() - 1;
}

RecordRing::RecordRing(cn::Machine& machine, const ProgramConfig& config)
    : machine_(machine),
      record_bytes_(config.tree.record_bytes()),
      buffers_loads_(config.buffers_loads()),
      buffers_saves_(config.buffers_saves()),
      ring_(machine, "traversal record", {buffers(config), record_bytes_ + int{sizeof(MonoAddress)}, false}) {
}

void RecordRing::load(std::uint64_t step, MonoAddress first, std::uint64_t last_writer,
                      const LaneMask& rays) {
  ring_.wait(step);
  ring_.wait_until(last_writer);
  ring_.copy_m2p(step, TransferRing::kNoBlock, span(step),
                 cn::MonoPlaces::array(first, std::uint64_t(record_bytes_)), rays);
  if (!buffers_loads_) ring_.wait(step);
}

void RecordRing::save(std::uint64_t step, const LaneMask& rays) {
  ring_.copy_p2m(step, TransferRing::kNoBlock, machine_.places_in(record_to(step)), span(step), rays);
  if (!buffers_saves_) ring_.wait(step);
}

void RecordStage::traverse_and_put_back(std::uint64_t step, const LaneMask& rays, const Needs& needs,
                                        std::size_t pass) {
  count_pass(pass, rays);
  alive_ = traverse(step, records_.record(step), rays, needs);
  put_back(step, rays, alive_, pass);
  finish(step, records_.record(step), rays.without(alive_));
}

void RecordStage::save(std::uint64_t step, int /*block*/) {
  records_.save(step, alive_);
  save_hits(step);
}

}  // namespace path_tracer
