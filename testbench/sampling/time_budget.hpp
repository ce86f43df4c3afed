#pragma once

#include <optional>
#include <string>
#include <vector>

namespace testbench {

/// The seconds that a text like "2s", "1.5 min", "500ms" or "20us" names; std::nullopt for any other text and
/// for a time that is not above 0 or not finite.
std::optional<double> parse_duration(const std::string& text);

/// The allowed texts for error messages.
std::string allowed_duration();

/// Predicts how long passes take from those that are over: for each path as long as in the largest of them,
/// and for each pass the most that one took beyond that.
class PassTimes {
 public:
  void add(double paths, double seconds);
  /// The most paths that a pass of at most `seconds` has, as predicted, with something to spare.
  double most_paths(double seconds) const;
  bool any() const { return !passes_.empty(); }

 private:
  struct Pass {
    double paths;
    double seconds;
  };
  std::vector<Pass> passes_;
};

}  // namespace testbench
