#include "testbench/validation/example_runs.hpp"

#include <cstring>
#include <limits>

#include "firmware/examples/firmwares.hpp"
#include "testbench/plug_in/buffer_places.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using plug_in::Memory;
using plug_in::MonoBufferBase;

/// Throws InputError and RunError for what the firmware throws.
template <class Work>
void with_run_errors(const plug_in::Firmware& firmware, Work&& work) {
  try {
    work();
  } catch (const plug_in::OptionError& error) {
    throw InputError(firmware.name() + ": " + error.what());
  } catch (const plug_in::CheckFailed& error) {
    throw RunError(firmware.name() + ": " + error.what());
  }
}

void download(const plug_in::Firmware& firmware, const std::uint8_t* mono) {
  for (MonoBufferBase* const buffer : firmware.buffers())
    if (buffer->is_downloaded())
      std::memcpy(buffer->host_bytes(), mono + buffer->address(), buffer->size_bytes());
}

}  // namespace

ExampleRun example_run(std::shared_ptr<plug_in::Firmware> firmware, int num_pes,
                       const cn::MonoRange& scratchpad) {
  with_run_errors(*firmware, [&] { firmware->prepare(num_pes); });
  constexpr std::uint64_t kUnbounded = std::numeric_limits<std::uint64_t>::max();
  const BufferBytes bytes = place_buffers(*firmware, kUnbounded, scratchpad);
  ExampleRun run;
  run.mono.resize(bytes.ddr);
  run.scratchpad.resize(bytes.on_chip_sram);
  for (MonoBufferBase* const buffer : firmware->buffers()) {
    if (!buffer->is_uploaded()) continue;
    const bool on_chip = buffer->memory() == Memory::on_chip_sram;
    std::uint8_t* const to = on_chip ? run.scratchpad.data() + (buffer->address() - scratchpad.first)
                                     : run.mono.data() + buffer->address();
    std::memcpy(to, buffer->host_bytes(), buffer->size_bytes());
  }
  run.firmware = [firmware](cn::Machine& machine) { firmware->run(machine); };
  run.check = [firmware](const std::uint8_t* mono) {
    download(*firmware, mono);
    with_run_errors(*firmware, [&] { firmware->check(); });
  };
  run.work = firmware->work().amount;
  return run;
}

ExampleRun dgemm_run(const examples::Dgemm::Problem& problem, int num_pes, cn::Level level,
                     const cn::MonoRange& scratchpad) {
  const bool b_on_chip = scratchpad.bytes > 0;
  return example_run(examples::make_dgemm(examples::kernels(level), problem, b_on_chip), num_pes, scratchpad);
}

ExampleRun monte_carlo_run(const examples::MonteCarlo::Problem& problem, int num_pes, cn::Level level) {
  return example_run(examples::make_monte_carlo(examples::kernels(level), problem), num_pes);
}

ExampleRun fft_run(int images, int num_pes, cn::Level level) {
  return example_run(examples::make_fft(examples::kernels(level), images), num_pes);
}

}  // namespace testbench
