#pragma once

#include "testbench/mono_image/emitter.hpp"

namespace testbench {

/// Lights that lie side by side, or far away in similar directions.
struct LightCluster {
  std::vector<std::size_t> emitters;
  std::vector<double> power_cdf;  ///< entry i: power of emitters 0..i

  double power() const { return power_cdf.back(); }
};

/// Sorts emitters into at most `most` clusters of near ones, as many of distant ones and of the environment's
/// parts. Emitters of one face and material are one cluster.
std::vector<LightCluster> cluster_lights(const std::vector<Emitter>& emitters, std::size_t most);

}  // namespace testbench
