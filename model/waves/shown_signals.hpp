#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/config/chip_config.hpp"
#include "model/waves/wave_recorder.hpp"
#include "model/waves/wave_selection.hpp"
#include "model/waves/wave_signals.hpp"

namespace model {

/// The signals that a trace shows, and the place of each in its file.
class ShownSignals {
 public:
  static constexpr std::size_t kNotShown = ~std::size_t{0};

  /// Throws WaveError if the selection is empty.
  ShownSignals(const ChipConfig& chip, const WaveSelection& selection);

  /// In the order of the file.
  const std::vector<WaveInstance>& all() const { return signals_; }
  /// @param index of the thread, bank or PE; 0 for the chip's own
  std::size_t place(WaveSignal signal, int index) const {
    return places_[std::size_t(signal)][std::size_t(index)];
  }
  bool any(WaveSignal signal) const;
  bool any_of_banks() const;
  bool any_of_memory_counters() const;
  bool any_of_pes() const { return any(WaveSignal::pe_enabled) || any(WaveSignal::pe_transfer); }

  /// What the recorder has to know: name, initial value and how changes combine.
  std::vector<WaveRecorder::Signal> to_record(const std::string& chip) const;

 private:
  std::vector<WaveInstance> signals_;
  std::vector<std::vector<std::size_t>> places_;  ///< by kind and index
};

}  // namespace model
