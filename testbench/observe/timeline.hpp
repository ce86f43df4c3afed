#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "model/csx600.hpp"
#include "model/observe/chip_observer.hpp"
#include "testbench/files/output_stream.hpp"

namespace testbench {

/// Writes a run as a timeline for viewers such as Perfetto or Chrome's about:tracing, in their trace-event
/// format (JSON object form): complete events ("X") on one track each for kernels, waits of the control unit,
/// loads and saves of programmed I/O, and host transfers. Times are microseconds of simulated time; cycles
/// are among the arguments. The file is written while the chip runs.
class Timeline : public model::ChipObserver {
 public:
  /// Throws InputError if the file cannot be created.
  Timeline(const std::filesystem::path& file, const model::Csx600& chip, int array);

  void kernel_details(const model::KernelDetails& details) override { label_ = details.label; }
  void spent(model::CycleCause cause, model::Cycles start, model::Cycles finish, int semaphore) override;
  void ran_kernel(const char* name, model::Cycles start, model::Cycles finish, int enabled_pes) override;
  void finished(const model::PioEvent& event) override;
  void ended_transfer(bool upload, std::uint64_t bytes, model::Cycles start, model::Cycles finish) override;

  /// Must be called after the run. Throws RunError if the file is not complete.
  void finish();

 private:
  enum class Track : std::uint8_t { kernels = 1, waits, loads, saves, host };

  void name_tracks();
  void add(Track track, const std::string& name, const char* category, model::Cycles start,
           model::Cycles finish, nlohmann::ordered_json arguments);
  void write(const nlohmann::ordered_json& event);

  const model::Csx600& chip_;
  const model::ControlUnit& control_unit_;
  StreamedFile file_;
  std::string buffer_;
  bool first_ = true;
  cn::Label label_;
};

}  // namespace testbench
