#include "testbench/plug_in/plug_in_run.hpp"

#include <cstring>
#include <systemc>

#include "model/csx600.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/observe/observation.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using plug_in::Firmware;
using plug_in::MonoBufferBase;

/// Buffers start on a multiple of this, so that a PE's pieces are aligned if the firmware's sizes are.
constexpr std::uint64_t kBufferAlignment = 256;

/// Returns how many bytes of mono memory the buffers take.
std::uint64_t place_buffers(const Firmware& firmware, std::uint64_t available_bytes) {
  std::uint64_t next = 0;
  for (MonoBufferBase* const buffer : firmware.buffers()) {
    buffer->place_at(next);
    next += (buffer->size_bytes() + kBufferAlignment - 1) / kBufferAlignment * kBufferAlignment;
  }
  if (next > available_bytes)
    throw InputError(firmware.name() + ": buffers need " + std::to_string(next) +
                     " bytes of mono memory, ddr.size_bytes allows " + std::to_string(available_bytes));
  return next;
}

/// What a plug-in throws, as errors of the input or of the run.
template <class Work>
auto with_plug_in_errors(const Firmware& firmware, Work&& work) {
  try {
    return work();
  } catch (const plug_in::OptionError& error) {
    throw InputError(firmware.name() + ": " + error.what());
  } catch (const cn::PolyMemoryOverflow& error) {
    const std::string map = error.map().substr(0, error.map().find_last_not_of('\n') + 1);
    throw InputError(std::string(error.what()) + "; buffers of a PE:", map);
  } catch (const plug_in::CheckFailed& error) {
    throw RunError(firmware.name() + ": " + error.what());
  } catch (const cn::MachineFault& fault) {
    throw RunError(fault.what());
  }
}

/// The body, with the checker of hazards around it if that is wanted.
class CheckedBody {
 public:
  explicit CheckedBody(Firmware& firmware) : firmware_(firmware) {}

  void check_hazards(cn::Machine& machine, model::HazardChecker::Clock clock) {
    checker_.emplace(machine, std::move(clock));
    for (MonoBufferBase* const buffer : firmware_.buffers())
      checker_->name_mono(buffer->name(), {buffer->address(), buffer->size_bytes()});
    machine.set_access_observer(&*checker_);
  }
  void run(cn::Machine& machine) {
    firmware_.run(machine);
    if (checker_) checker_->firmware_ends();
  }
  void finish() const {
    if (checker_) checker_->throw_if_found();
  }

 private:
  Firmware& firmware_;
  std::optional<model::HazardChecker> checker_;
};

/// The computer that the board is in: uploads, starts the firmware, waits for its end, downloads.
class PlugInHost : public sc_core::sc_module {
 public:
  PlugInHost(const sc_core::sc_module_name& name, model::Csx600& chip, const Firmware& firmware)
      : sc_module(name), chip_(chip), firmware_(firmware) {
    SC_HAS_PROCESS(PlugInHost);
    SC_THREAD(run);
  }

  bool finished() const { return finished_; }
  model::Cycles finished_cycle() const { return finished_cycle_; }

 private:
  void run() {
    for (MonoBufferBase* const buffer : firmware_.buffers())
      if (buffer->is_uploaded() && buffer->size_bytes() > 0)
        wait_until(
            chip_.host_link.upload(buffer->address(), buffer->host_bytes(), buffer->size_bytes(), now()));
    chip_.control_unit.start();
    if (!chip_.control_unit.finished()) wait(chip_.control_unit.finished_event());
    for (MonoBufferBase* const buffer : firmware_.buffers())
      if (buffer->is_downloaded() && buffer->size_bytes() > 0)
        wait_until(
            chip_.host_link.download(buffer->address(), buffer->host_bytes(), buffer->size_bytes(), now()));
    finished_cycle_ = now();
    finished_ = true;
  }
  void wait_until(model::Cycles cycle) {
    const sc_core::sc_time target = chip_.clock.time_at(cycle);
    if (target > sc_core::sc_time_stamp()) wait(target - sc_core::sc_time_stamp());
  }
  model::Cycles now() const { return chip_.clock.cycle_at(sc_core::sc_time_stamp()); }

  model::Csx600& chip_;
  const Firmware& firmware_;
  bool finished_ = false;
  model::Cycles finished_cycle_ = 0;
};

PlugInResult run_on_chip(Firmware& firmware, const PlugInOptions& options) {
  CheckedBody body(firmware);
  model::Csx600 chip("csx600", options.chip, options.timing);
  const PlugInHost host("host", chip, firmware);
  if (options.check_hazards) body.check_hazards(chip.control_unit, [&] { return chip.control_unit.now(); });
  Observation observation(options.observation, chip);
  chip.control_unit.load([&](cn::Machine& machine) { body.run(machine); });
  sc_core::sc_start();
  chip.control_unit.require_finished();
  if (!host.finished()) throw RunError("the firmware has ended, but the host has not");
  body.finish();
  PlugInResult result;
  result.chip = collect_statistics(chip, host.finished_cycle());
  result.observation_failures = observation.finish();
  return result;
}

PlugInResult run_on_native_machine(Firmware& firmware, const PlugInOptions& options,
                                   std::uint64_t mono_bytes) {
  CheckedBody body(firmware);
  NativeMachine machine(options.chip.chip.pes, options.chip.poly.sram_bytes, mono_bytes);
  if (options.check_hazards) body.check_hazards(machine, {});
  const auto copy = [&](const MonoBufferBase& buffer, void* to, const void* from) {
    if (buffer.size_bytes() > 0) std::memcpy(to, from, buffer.size_bytes());
  };
  for (MonoBufferBase* const buffer : firmware.buffers())
    if (buffer->is_uploaded()) copy(*buffer, machine.mono() + buffer->address(), buffer->host_bytes());
  machine.run_firmware([&](cn::Machine& on) { body.run(on); });
  body.finish();
  for (MonoBufferBase* const buffer : firmware.buffers())
    if (buffer->is_downloaded()) copy(*buffer, buffer->host_bytes(), machine.mono() + buffer->address());
  return {};
}

}  // namespace

PlugInResult run_plug_in(Firmware& firmware, const PlugInOptions& options) {
  if (options.chip.board.chips != 1)
    throw InputError("board.chips: found " + std::to_string(options.chip.board.chips) +
                     "; allowed: 1, since a plug-in runs on one chip, on its first array");
  return with_plug_in_errors(firmware, [&] {
    firmware.prepare(options.chip.chip.pes);
    const std::uint64_t mono_bytes = place_buffers(firmware, options.chip.ddr.size_bytes);
    PlugInResult result = options.native ? run_on_native_machine(firmware, options, mono_bytes)
                                         : run_on_chip(firmware, options);
    firmware.check();
    return result;
  });
}

}  // namespace testbench
