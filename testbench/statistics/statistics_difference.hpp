#pragma once

#include <optional>
#include <string>
#include <vector>

#include "testbench/statistics/statistics_file.hpp"

namespace testbench {

/// A value that two runs do not have in common.
struct Difference {
  std::string key;
  std::optional<nlohmann::ordered_json> a;  ///< none when that run does not have the key
  std::optional<nlohmann::ordered_json> b;

  /// (b - a) / the larger of |a| and |b|; none unless both are numbers.
  std::optional<double> relative() const;
};

inline const std::string& key_of(const Difference& difference) {
  return difference.key;
}

struct Tolerance {
  std::string glob;     ///< shell pattern of keys: * ? [ ]
  double relative = 0;  ///< numbers that differ by at most so much are equal
};

/// How far apart numbers under some keys may be and still be equal.
struct AbsoluteTolerance {
  std::string glob;     ///< shell pattern of keys
  double distance = 0;  ///< in the unit of the key
};

/// A scene's path says where a run found the scene, not what it is: only the last name of the path counts, in
/// the way that golden tables call scenes. "models/box", "models/box/", "/home/me/models/box/scene.toml" and
/// "./box" are one scene.
std::string scene_name_of(const std::string& path);

struct ComparisonRules {
  std::vector<Tolerance> tolerances;  ///< the last that matches a key counts; without one it must be equal
  std::vector<std::string> ignore;    ///< globs
  std::vector<AbsoluteTolerance> absolute = {};  ///< as tolerances; a number is equal that either lets pass
};

struct Comparison {
  std::vector<Difference> differences;  ///< in the order of the files
  std::vector<std::string> keys;        ///< compared: those of either, without the ignored ones
};

Comparison compare(const FlatStatistics& a, const FlatStatistics& b, const ComparisonRules& rules);

/// A table by group: key, a, b, relative difference, unit.
std::string difference_text(const std::vector<Difference>& differences);

}  // namespace testbench
