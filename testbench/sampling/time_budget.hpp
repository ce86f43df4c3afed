#pragma once

#include <optional>
#include <string>

namespace testbench {

/// The seconds that a text like "2s", "1.5 min", "500ms" or "20us" names; std::nullopt for any other text and
/// for a time that is not above 0 or not finite.
std::optional<double> parse_duration(const std::string& text);

/// The allowed texts for error messages.
std::string allowed_duration();

/// Predicts how long passes take from those that are over: a time that every pass takes, and a time for each
/// path.
class PassTimes {
 public:
  void add(double paths, double seconds);
  /// The most paths that a pass of at most `seconds` has, as predicted, with something to spare.
  double most_paths(double seconds) const;
  bool any() const { return passes_ > 0; }

 private:
  int passes_ = 0;
  double first_paths_ = 0;
  double first_seconds_ = 0;
  double seconds_a_path_ = 0;  ///< of the largest pass
  double largest_paths_ = 0;
};

}  // namespace testbench
