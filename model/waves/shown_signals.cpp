#include "model/waves/shown_signals.hpp"

#include <algorithm>

namespace model {
namespace {

std::uint64_t initial_value(WaveSignal signal) {
  switch (signal) {
    case WaveSignal::control_semaphore:
      return kNoSemaphore;
    case WaveSignal::pio_load_request:
    case WaveSignal::pio_save_request:
      return kNoRequest;
    case WaveSignal::bins_load_block:
    case WaveSignal::bins_compute_block:
    case WaveSignal::bins_save_block:
      return kNoBlock;
    default:
      return 0;
  }
}

bool is_memory_counter(WaveSignal signal) {
  switch (signal) {
    case WaveSignal::clear_connect_pio_bytes:
    case WaveSignal::ddr_page_hits:
    case WaveSignal::ddr_page_misses:
    case WaveSignal::ddr_bytes_read:
    case WaveSignal::ddr_bytes_written:
      return true;
    default:
      return false;
  }
}

WaveRecorder::Rule rule_of(WaveSignal signal) {
  // Counters are read when a request is booked and shown when it is over, and two engines overtake each
  // other.
  if (is_memory_counter(signal)) return WaveRecorder::Rule::maximum;
  return signal == WaveSignal::pe_transfer ? WaveRecorder::Rule::set_or_clear : WaveRecorder::Rule::assign;
}

}  // namespace

ShownSignals::ShownSignals(const ChipConfig& chip, const WaveSelection& selection)
    : signals_(select_waves(chip, selection)), places_(std::size_t(kWaveSignals)) {
  for (const WaveSignalInfo& info : wave_signal_table())
    places_[std::size_t(info.id)].assign(std::size_t(wave_count(chip, info.count)), kNotShown);
  for (std::size_t i = 0; i < signals_.size(); ++i)
    places_[std::size_t(signals_[i].info->id)][std::size_t(signals_[i].index)] = i;
}

bool ShownSignals::any(WaveSignal signal) const {
  const std::vector<std::size_t>& places = places_[std::size_t(signal)];
  return std::any_of(places.begin(), places.end(), [](std::size_t place) { return place != kNotShown; });
}

bool ShownSignals::any_of_banks() const {
  return std::any_of(signals_.begin(), signals_.end(),
                     [](const WaveInstance& signal) { return signal.info->count == WaveCount::bank; });
}

bool ShownSignals::any_of_memory_counters() const {
  return std::any_of(signals_.begin(), signals_.end(),
                     [](const WaveInstance& signal) { return is_memory_counter(signal.info->id); });
}

std::vector<WaveRecorder::Signal> ShownSignals::to_record(const std::string& chip) const {
  std::vector<WaveRecorder::Signal> recorded;
  for (const WaveInstance& signal : signals_)
    recorded.push_back({{wave_name_in_file(chip, signal), signal.info->width},
                        initial_value(signal.info->id),
                        rule_of(signal.info->id)});
  return recorded;
}

}  // namespace model
