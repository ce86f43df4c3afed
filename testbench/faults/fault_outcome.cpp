#include "testbench/faults/fault_outcome.hpp"

#include <algorithm>
#include <cstdlib>

#include "testbench/film/image_file.hpp"

namespace testbench {

FaultResult compare_with(const std::vector<double>& fault_free, const RenderResult& result) {
  constexpr std::size_t kChannels = 3;
  const std::vector<double> rgb = result.film.rgb();
  FaultResult compared;
  for (std::size_t pixel = 0; pixel < rgb.size(); pixel += kChannels) {
    bool differs = false;
    for (std::size_t i = pixel; i < pixel + kChannels; ++i) {
      differs |= rgb[i] != fault_free.at(i);
      const int codes = std::abs(srgb_code(rgb[i]) - srgb_code(fault_free[i]));
      compared.largest_difference = std::max(compared.largest_difference, codes);
    }
    compared.differing_pixels += differs;
  }
  if (compared.differing_pixels > 0)
    compared.outcome =
        compared.largest_difference > 1 ? FaultOutcome::wrong_pixels : FaultOutcome::slightly_wrong;
  else if (result.faults.corrected > 0)
    compared.outcome = FaultOutcome::corrected;
  return compared;
}

FaultResult stopped_by(const std::string& message) {
  const auto says = [&](const char* part) { return message.find(part) != std::string::npos; };
  FaultResult result;
  result.message = message;
  result.outcome = FaultOutcome::stopped;
  if (says(model::kEccMessage)) result.outcome = FaultOutcome::detected;
  if (says(model::kWatchdogMessage) || says("deadlock") || says("--time-limit"))
    result.outcome = FaultOutcome::hang;
  if (says("signal or crash")) result.outcome = FaultOutcome::crashed;
  return result;
}

}  // namespace testbench
