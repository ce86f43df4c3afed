#pragma once

#include <vector>

#include "firmware/path_tracer/records/node_layout.hpp"

namespace test_support {

/// All layouts of nodes for which the firmware has kernels.
inline std::vector<path_tracer::NodeLayout> node_layouts() {
  using path_tracer::NodeFormat;
  std::vector<path_tracer::NodeLayout> layouts;
  for (const NodeFormat format : {NodeFormat::fp64, NodeFormat::fp32, NodeFormat::quantised8})
    for (const int width : {2, 4, 8}) {
      const path_tracer::NodeLayout layout{format, width};
      if (layout.has_kernel()) layouts.push_back(layout);
    }
  return layouts;
}

}  // namespace test_support
