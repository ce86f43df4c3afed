#pragma once

#include <systemc>

#include "model/csx600.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/run/results.hpp"

namespace testbench {

/// The computer that the board is in: uploads the scene, starts the firmware, fetches results while it runs.
class HostPc : public sc_core::sc_module {
 public:
  HostPc(const sc_core::sc_module_name& name, model::Csx600& chip, const MonoImage& image, Film& film);

  /// Tells `checker`, which may be null, what the host fetches while the firmware runs.
  void report_reads_to(model::HazardChecker* checker) { checker_ = checker; }

  bool finished() const { return finished_; }
  /// The cycle at which the last result was in the host's memory.
  model::Cycles finished_cycle() const { return finished_cycle_; }

 private:
  void run();
  void fetch_results();
  void fetch_untimed_results();
  void wait_until(model::Cycles cycle);
  model::Cycles now() const { return chip_.clock.cycle_at(sc_core::sc_time_stamp()); }

  model::Csx600& chip_;
  const MonoImage& image_;
  ResultReader results_;
  model::HazardChecker* checker_ = nullptr;
  bool finished_ = false;
  model::Cycles finished_cycle_ = 0;
};

}  // namespace testbench
