#include "firmware/path_tracer/make_tracer.hpp"

#include "firmware/path_tracer/bidirectional/bidirectional_tracer.hpp"
#include "firmware/path_tracer/path_tracer.hpp"
#include "firmware/path_tracer/resident/resident_tracer.hpp"

namespace path_tracer {

std::unique_ptr<Tracer> make_tracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                                    const Layout& layout, const Work& work) {
  if (config.is_bidirectional())
    return std::make_unique<BidirectionalTracer>(machine, kernels, config, layout, work);
  if (config.keeps_paths_in_sram())
    return std::make_unique<ResidentTracer>(machine, kernels, config, layout, work);
  return std::make_unique<PathTracer>(machine, kernels, config, layout, work);
}

}  // namespace path_tracer
