#include "testbench/sweep/replay.hpp"

#include "model/time/run_until_idle.hpp"
#include "testbench/run/host_pc.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/simulator_time.hpp"

namespace testbench {

Recording record_render(const Scene& scene, const RenderOptions& options) {
  RenderOptions with_image = options;
  with_image.image = make_image(scene, options);
  TimingStream stream;
  RenderResult result = render_natively(scene, with_image, {}, &stream);
  return {*with_image.image, std::move(stream), std::move(result)};
}

RenderResult replay_on_chip(const Recording& recording, const RenderOptions& options) {
  const SimulatorTimer timer;
  require_mono_memory(recording.image, options.chip);
  RenderResult result = recording.result;
  // The host fetches as many results as in a full run and drops them.
  Film nobody_looks_at(result.film.size(), result.film.scale(), FilmSums::means);
  model::Csx600 chip("csx600", options.chip, options.timing);
  HostPc host("host", chip, recording.image, nobody_looks_at);
  chip.pio_engine.leave_data(true);
  chip.control_unit.load([&](cn::Machine& machine) { recording.stream.replay(machine); });
  try {
    model::run_until_idle();
    chip.control_unit.require_finished();
  } catch (const cn::MachineFault& fault) {
    throw RunError(fault.what());
  }
  if (!host.finished()) throw RunError("the replayed firmware has ended, but the host has not");
  result.chip = collect_statistics(chip, host.finished_cycle());
  result.cpu_seconds = timer.cpu_seconds();
  result.wall_seconds = timer.wall_seconds();
  return result;
}

}  // namespace testbench
