#include "model/waves/wave_config.hpp"

namespace model {
namespace {

std::string number(std::uint64_t value) {
  return std::to_string(value);
}

}  // namespace

void check_waves(const WaveConfig& config, const ChipConfig& chip) {
  for (const CycleWindow& window : config.windows)
    if (window.first >= window.last)
      throw WaveError("waves: found a window from cycle " + number(window.first) + " to before cycle " +
                      number(window.last) + "; allowed: one that ends after it begins");
  for (const BlockWindow& window : config.blocks)
    if (window.first == 0 || window.count == 0)
      throw WaveError("waves: found a window of " + number(window.count) + " blocks from block " +
                      number(window.first) + " on; allowed: at least one, counted from 1");
  select_waves(chip, config.selection);
}

std::string text_of_windows(const WaveConfig& config) {
  std::string text;
  const auto add = [&](const std::string& window) { text += (text.empty() ? "" : ", ") + window; };
  for (const CycleWindow& window : config.windows)
    add("from cycle " + number(window.first) +
        (window.last == CycleWindow{}.last ? " on" : " to before cycle " + number(window.last)));
  for (const BlockWindow& window : config.blocks) add("from block " + number(window.first) + " on");
  return text;
}

}  // namespace model
