#pragma once

#include <systemc>

#include "model/csx600.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/run/results.hpp"

namespace testbench {

/// The computer that the board is in, as one array sees it: uploads the scene, starts the firmware, fetches
/// results while it runs.
class HostPc : public sc_core::sc_module {
 public:
  /// @param image without bytes where another array of the chip brings the scene
  /// @param uploads_scene the host's side of that array; null if it is this one
  HostPc(const sc_core::sc_module_name& name, model::Csx600& chip, model::ControlUnit& control_unit,
         const MonoImage& image, Film& film, const HostPc* uploads_scene = nullptr);
  /// Of the chip's first array.
  HostPc(const sc_core::sc_module_name& name, model::Csx600& chip, const MonoImage& image, Film& film)
      : HostPc(name, chip, chip.control_unit, image, film) {}

  /// Tells `checker`, which may be null, what the host fetches while the firmware runs.
  void report_reads_to(model::HazardChecker* checker) { checker_ = checker; }

  bool finished() const { return finished_; }
  /// The cycle at which the last result was in the host's memory.
  model::Cycles finished_cycle() const { return finished_cycle_; }

 private:
  void run();
  void upload();
  void fetch_results();
  void fetch_untimed_results();
  void wait_until(model::Cycles cycle);
  model::Cycles now() const { return chip_.clock.cycle_at(sc_core::sc_time_stamp()); }

  model::Csx600& chip_;
  model::ControlUnit& control_unit_;
  const HostPc* uploads_scene_;
  bool scene_is_there_ = false;
  sc_core::sc_event scene_came_;
  const MonoImage& image_;
  ResultReader results_;
  model::HazardChecker* checker_ = nullptr;
  bool finished_ = false;
  model::Cycles finished_cycle_ = 0;
};

}  // namespace testbench
