#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "testbench/run/render.hpp"

namespace testbench {

/// A run that the paper's claims are judged by.
struct ClaimRun {
  std::string name;
  const Scene* scene;
  RenderOptions options;
};

/// What such a run measured.
class ClaimFigures {
 public:
  explicit ClaimFigures(nlohmann::json measured) : measured_(std::move(measured)) {}

  double segments() const { return measured_["counts"]["segments"].get<double>(); }
  double rays() const { return segments() + measured_["counts"]["shadow_rays"].get<double>(); }
  double cycles() const { return measured_["cycles"].get<double>(); }
  double cycles_per_segment() const { return cycles() / segments(); }
  /// Seconds for 1,000,000 path segments.
  double seconds_per_million() const { return measured_["seconds"].get<double>() * 1e6 / segments(); }
  const nlohmann::json& counts() const { return measured_["counts"]; }
  const nlohmann::json& chip() const { return measured_["chip"]; }
  /// The kernel's section; null without such a kernel.
  nlohmann::json kernel(const std::string& name) const;

 private:
  nlohmann::json measured_;
};

/// Figures by the runs' names.
class ClaimMeasurements {
 public:
  void add(const std::string& name, nlohmann::json measured) { figures_.emplace(name, std::move(measured)); }
  /// Throws std::out_of_range for a run that was not made.
  const ClaimFigures& of(const std::string& name) const { return figures_.at(name); }

 private:
  std::map<std::string, ClaimFigures> figures_;
};

/// The scenes that claims are about.
struct ClaimScenes {
  Scene box;             ///< the paper's: few triangles, brute force
  Scene many_triangles;  ///< with a tree
};

/// Every run, on the options' chip where a claim names no other. `options` gives chip, timing and samples.
std::vector<ClaimRun> claim_runs(const ClaimScenes& scenes, const RenderOptions& options);

/// Makes the runs, each in a process of its own, `at_once` at a time.
/// @param done called with the share of finished runs
ClaimMeasurements measure_claims(const std::vector<ClaimRun>& runs, int at_once,
                                 const std::function<void(double share)>& done = {});

}  // namespace testbench
