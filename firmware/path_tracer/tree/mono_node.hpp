#pragma once

#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/cn/language/poly4.hpp"
#include "firmware/path_tracer/records/traversal_record.hpp"

namespace cn {
class Machine;
}

/// Nodes as the control unit reads them, for all PEs at once.
namespace path_tracer {

/// Boxes of a node's children, in double precision and the scene's own units whatever the format.
struct MonoNode {
  struct Four {                  ///< children, as a vector instruction takes them
    cn::mono4<double> lower[3];  ///< by axis
    cn::mono4<double> upper[3];
  };
  Four four[kMaxNodeWidth / 4];
  std::uint32_t reference[kMaxNodeWidth];
  int children = 0;  ///< these come first
};

/// The tree's nodes.
struct MonoNodes {
  cn::MonoPointer<std::uint64_t> first;
  NodeLayout layout;
  double unit = 1.0;  ///< of their coordinates: 1 / to_node_unit()
};

/// Through the data cache; what decoding takes is charged.
MonoNode read_node(cn::Machine& machine, const MonoNodes& nodes, std::int32_t slot);

}  // namespace path_tracer
