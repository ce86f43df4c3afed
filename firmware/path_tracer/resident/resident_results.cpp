#include "firmware/path_tracer/resident/resident_results.hpp"

namespace path_tracer {

ResidentResults::ResidentResults(cn::Machine& machine, const ResidentKernels& kernels, const Layout& layout)
    : machine_(machine),
      kernels_(kernels),
      ring_(machine, "results", {2, kResidentResults * int{sizeof(RadianceRecord)}, false}),
      handover_(machine, layout),
      count_{machine.poly_memory().allocate("number of results", sizeof(std::int32_t)).offset_bytes} {}

void ResidentResults::begin() {
  clear();
}

void ResidentResults::clear() {
  ClearResultsArguments arguments;
  arguments.results = buffer();
  arguments.result_count = count_;
  machine_.run(kernels_.clear_results, arguments, cn::LaneMask::first(machine_.num_pes()));
}

void ResidentResults::flush() {
  announce();
  const cn::PolySpan from = ring_.buffer(step_);
  const cn::MonoPlaces to = cn::MonoPlaces::array(handover_.half().address, std::uint64_t(from.size_bytes));
  ring_.copy_p2m(step_, TransferRing::kNoBlock, to, from, cn::LaneMask::first(machine_.num_pes()));
  is_saving_ = true;
  ++step_;
  clear();
}

void ResidentResults::announce() {
  if (!is_saving_) return;
  ring_.wait(step_ - 1);
  handover_.announce(machine_.num_pes() * kResidentResults);
  is_saving_ = false;
}

}  // namespace path_tracer
