#include "testbench/plug_in/plug_in_run.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <systemc>

#include "model/config/address_map.hpp"
#include "model/csx600.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "model/time/run_until_idle.hpp"
#include "testbench/machine/memory_overflow.hpp"
#include "testbench/machine/recording_machine.hpp"
#include "testbench/observe/observation.hpp"
#include "testbench/plug_in/buffer_places.hpp"
#include "testbench/system/crash_guard.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/simulator_time.hpp"

namespace testbench {
namespace {

using plug_in::Firmware;
using plug_in::MonoBufferBase;

std::uint64_t place_in(const model::ChipConfig& chip, const Firmware& firmware) {
  return place_buffers(firmware, chip.ddr.size_bytes, model::on_chip_sram_range(chip)).ddr;
}

/// What a plug-in throws, as errors of the input or of the run.
template <class Work>
auto with_plug_in_errors(const Firmware& firmware, Work&& work) {
  try {
    return work();
  } catch (const plug_in::OptionError& error) {
    throw InputError(firmware.name() + ": " + error.what());
  } catch (const cn::PolyMemoryOverflow& error) {
    throw input_error_of(error);
  } catch (const plug_in::CheckFailed& error) {
    throw RunError(firmware.name() + ": " + error.what());
  } catch (const cn::MachineFault& fault) {
    throw RunError(fault.what());
  } catch (const InputError&) {
    throw;
  } catch (const RunError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::length_error&) {  // of a container that was asked to hold more than memory could
    throw std::bad_alloc();
  } catch (const std::exception& error) {
    throw RunError(firmware.name() + ": " + error.what());
  } catch (...) {
    throw RunError(firmware.name() + ": found that it throws what is no std::exception");
  }
}

/// The body, with the checker of hazards around it if that is wanted.
class CheckedBody {
 public:
  explicit CheckedBody(Firmware& firmware)
      : firmware_(firmware),
        crash_message_(firmware.name() +
                       ": crashed; --check-hazards names kernels that leave the SRAM of their PEs") {}

  void check_hazards(cn::Machine& machine, model::HazardChecker::Clock clock) {
    checker_.emplace(machine, std::move(clock));
    for (MonoBufferBase* const buffer : firmware_.buffers())
      checker_->name_mono(buffer->name(), {buffer->address(), buffer->size_bytes()});
    machine.set_access_observer(&*checker_);
  }
  void run(cn::Machine& machine) {
    {
      constexpr int kRunFailed = 1;
      const CrashGuard guard(crash_message_, kRunFailed, checker_ ? &checker_->hazard() : nullptr);
      firmware_.run(machine);
    }
    if (checker_) checker_->firmware_ends();
  }
  void finish() const {
    if (checker_) checker_->throw_if_found();
  }

 private:
  Firmware& firmware_;
  std::string crash_message_;
  std::optional<model::HazardChecker> checker_;
};

/// The computer that the board is in: uploads, starts the firmware, waits for its end, downloads.
class PlugInHost : public sc_core::sc_module {
 public:
  /// @param keeps_results false: what is downloaded is dropped
  PlugInHost(const sc_core::sc_module_name& name, model::Csx600& chip, const Firmware& firmware,
             bool keeps_results)
      : sc_module(name), chip_(chip), firmware_(firmware), keeps_results_(keeps_results) {
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
      if (buffer->is_downloaded() && buffer->size_bytes() > 0) download(*buffer);
    finished_cycle_ = now();
    finished_ = true;
  }
  void download(MonoBufferBase& buffer) {
    if (!keeps_results_) dropped_.resize(std::max<std::uint64_t>(dropped_.size(), buffer.size_bytes()));
    void* const to = keeps_results_ ? buffer.host_bytes() : dropped_.data();
    wait_until(chip_.host_link.download(buffer.address(), to, buffer.size_bytes(), now()));
  }
  void wait_until(model::Cycles cycle) {
    const sc_core::sc_time target = chip_.clock.time_at(cycle);
    if (target > sc_core::sc_time_stamp()) wait(target - sc_core::sc_time_stamp());
  }
  model::Cycles now() const { return chip_.clock.cycle_at(sc_core::sc_time_stamp()); }

  model::Csx600& chip_;
  const Firmware& firmware_;
  bool keeps_results_;
  std::vector<std::uint8_t> dropped_;
  bool finished_ = false;
  model::Cycles finished_cycle_ = 0;
};

void simulate(model::Csx600& chip, const PlugInHost& host) {
  model::run_until_idle();
  chip.control_unit.require_finished();
  if (!host.finished()) throw RunError("the firmware has ended, but the host has not");
}

PlugInResult run_on_chip(Firmware& firmware, const PlugInOptions& options) {
  CheckedBody body(firmware);
  model::Csx600 chip("csx600", options.chip, options.timing);
  const PlugInHost host("host", chip, firmware, true);
  if (options.check_hazards) body.check_hazards(chip.control_unit, [&] { return chip.control_unit.now(); });
  Observation observation(options.observation, chip);
  chip.control_unit.load([&](cn::Machine& machine) { body.run(machine); });
  simulate(chip, host);
  body.finish();
  PlugInResult result;
  result.chip = collect_statistics(chip, host.finished_cycle());
  result.observation_failures = observation.finish();
  return result;
}

/// Uploads, runs, downloads.
void run_natively(Firmware& firmware, NativeMachine& machine, const std::function<void(cn::Machine&)>& body) {
  const auto place_of = [&](const MonoBufferBase& buffer) {
    const bool on_chip = buffer.memory() == plug_in::Memory::on_chip_sram;
    return on_chip ? machine.scratchpad_bytes() + (buffer.address() - machine.scratchpad().first)
                   : machine.mono() + buffer.address();
  };
  for (MonoBufferBase* const buffer : firmware.buffers())
    if (buffer->is_uploaded() && buffer->size_bytes() > 0)
      std::memcpy(place_of(*buffer), buffer->host_bytes(), buffer->size_bytes());
  machine.run_firmware(body);
  for (MonoBufferBase* const buffer : firmware.buffers())
    if (buffer->is_downloaded() && buffer->size_bytes() > 0)
      std::memcpy(buffer->host_bytes(), place_of(*buffer), buffer->size_bytes());
}

void run_on_native_machine(Firmware& firmware, const PlugInOptions& options, std::uint64_t ddr_bytes) {
  CheckedBody body(firmware);
  NativeMachine machine(options.chip.chip.pes, options.chip.poly.sram_bytes, ddr_bytes,
                        model::on_chip_sram_range(options.chip));
  if (options.check_hazards) body.check_hazards(machine, {});
  run_natively(firmware, machine, [&](cn::Machine& on) { body.run(on); });
  body.finish();
}

}  // namespace

PlugInResult run_plug_in(Firmware& firmware, const PlugInOptions& options) {
  if (options.chip.board.chips != 1)
    throw InputError("board.chips: found " + std::to_string(options.chip.board.chips) +
                     "; allowed: 1, since a plug-in runs on one chip, on its first array");
  return with_plug_in_errors(firmware, [&] {
    const SimulatorTimer timer;
    firmware.prepare(options.chip.chip.pes);
    const std::uint64_t ddr_bytes = place_in(options.chip, firmware);
    PlugInResult result;
    if (options.native) {
      run_on_native_machine(firmware, options, ddr_bytes);
    } else {
      result = run_on_chip(firmware, options);
    }
    firmware.check();
    result.cpu_seconds = timer.cpu_seconds();
    return result;
  });
}

PlugInRecording record_plug_in(std::unique_ptr<Firmware> firmware, const PlugInOptions& options) {
  PlugInRecording recording;
  recording.firmware = std::move(firmware);
  Firmware& recorded = *recording.firmware;
  with_plug_in_errors(recorded, [&] {
    recorded.prepare(options.chip.chip.pes);
    const std::uint64_t ddr_bytes = place_in(options.chip, recorded);
    RecordingMachine machine(options.chip.chip.pes, options.chip.poly.sram_bytes, ddr_bytes, recording.stream,
                             model::on_chip_sram_range(options.chip));
    run_natively(recorded, machine, [&](cn::Machine& on) { recorded.run(on); });
    machine.finish();
    recorded.check();
  });
  return recording;
}

PlugInResult replay_plug_in(const PlugInRecording& recording, const PlugInOptions& options) {
  return with_plug_in_errors(*recording.firmware, [&] {
    const SimulatorTimer timer;
    place_in(options.chip, *recording.firmware);
    model::Csx600 chip("csx600", options.chip, options.timing);
    const PlugInHost host("host", chip, *recording.firmware, false);
    chip.pio_engine.leave_data(true);
    chip.control_unit.load([&](cn::Machine& machine) { recording.stream.replay(machine); });
    simulate(chip, host);
    PlugInResult result;
    result.chip = collect_statistics(chip, host.finished_cycle());
    result.cpu_seconds = timer.cpu_seconds();
    return result;
  });
}

}  // namespace testbench
