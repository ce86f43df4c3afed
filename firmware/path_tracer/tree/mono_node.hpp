#pragma once

#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/cn/language/poly4.hpp"
#include "firmware/path_tracer/records/traversal_record.hpp"

namespace cn {
class Machine;
}

/// Nodes as the control unit reads them, for all PEs at once.
namespace path_tracer {

/// Boxes of a node's children, in double precision and in the scene's units for every format.
struct MonoNode {
  struct Four {                  ///< four children, for a vector instruction
    cn::mono4<double> lower[3];  ///< by axis
    cn::mono4<double> upper[3];
  };
  Four four[kMaxNodeWidth / 4];
  std::uint32_t reference[kMaxNodeWidth];
  int children = 0;  ///< number of entries in use
};

/// The tree's nodes.
struct MonoNodes {
  cn::MonoPointer<std::uint64_t> first;
  NodeLayout layout;
  double unit = 1.0;  ///< the coordinates' unit: 1 / to_node_unit()
};

/// Reads a node through the data cache and charges what decoding takes.
MonoNode read_node(cn::Machine& machine, const MonoNodes& nodes, std::int32_t slot);

}  // namespace path_tracer
