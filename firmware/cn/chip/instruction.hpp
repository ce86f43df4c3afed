#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>
#include <vector>

namespace cn {

/// Classes of poly instructions that differ in cost. `sram` and `sram_vector_load` count 4-byte words, the
/// width of the path between a PE's SRAM and its registers (96 GB/s for all PEs, or 4 B a PE and cycle);
/// every other class counts instructions. A vector instruction works on four variables of a PE, one after the
/// other, without waiting for the latency in between (poly4.hpp).
enum class InstructionClass : std::uint8_t {
  fp64_add,
  fp64_mul,
  fp64_div,
  fp64_sqrt,
  fp64_sincos,
  fp64_exp,
  fp64_log,
  fp64_atan2,
  fp32_add,
  fp32_mul,
  fp32_div,
  fp32_sqrt,
  fp64_add_vector4,
  fp64_mul_vector4,
  fp64_multiply_add_vector4,  // multiplier and adder in the same clocks; two roundings
  fp32_add_vector4,
  fp32_mul_vector4,
  fp32_multiply_add_vector4,
  int16_alu,
  int32_alu,
  int64_alu,
  int16_mul,
  int32_mul,
  int64_mul,
  move,     // register to register, also the masked assignment
  convert,  // between number formats
  enable,   // push, invert or pop of the enable stack
  sram,
  sram_vector_load,  // overlaps vector arithmetic
  swazzle,           // one step along the PE-to-PE path
  swazzle_vector4,   // the same for four variables in sequence
  reduce,            // one test of all PEs by the control unit (any, all, count)
  mono,              // an instruction of the control unit itself; overlaps poly work through the issue queue
};

inline constexpr std::size_t kInstructionClasses = static_cast<std::size_t>(InstructionClass::mono) + 1;

inline constexpr std::array<std::string_view, kInstructionClasses> kInstructionClassNames = {
    "fp64_add",
    "fp64_mul",
    "fp64_div",
    "fp64_sqrt",
    "fp64_sincos",
    "fp64_exp",
    "fp64_log",
    "fp64_atan2",
    "fp32_add",
    "fp32_mul",
    "fp32_div",
    "fp32_sqrt",
    "fp64_add_vector4",
    "fp64_mul_vector4",
    "fp64_multiply_add_vector4",
    "fp32_add_vector4",
    "fp32_mul_vector4",
    "fp32_multiply_add_vector4",
    "int16_alu",
    "int32_alu",
    "int64_alu",
    "int16_mul",
    "int32_mul",
    "int64_mul",
    "move",
    "convert",
    "enable",
    "sram",
    "sram_vector_load",
    "swazzle",
    "swazzle_vector4",
    "reduce",
    "mono"};

/// How many instructions of each class were issued.
struct IssueCounts {
  std::array<std::uint64_t, kInstructionClasses> by_class{};

  std::uint64_t& operator[](InstructionClass c) { return by_class[static_cast<std::size_t>(c)]; }
  std::uint64_t operator[](InstructionClass c) const { return by_class[static_cast<std::size_t>(c)]; }

  IssueCounts& operator+=(const IssueCounts& other) {
    for (std::size_t i = 0; i < kInstructionClasses; ++i) by_class[i] += other.by_class[i];
    return *this;
  }
  bool operator==(const IssueCounts& other) const { return by_class == other.by_class; }
};

/// Instructions that a kernel issued, shared by all PEs. Cost is data-independent except where a region runs
/// as long as any PE needs it. A kernel is executed strip by strip (strip.hpp). So each data-dependent
/// region, and each of its iterations, is a node that the first strip to reach it fills in. Later strips
/// issue the same instructions there and add only their enabled lanes. The sum over all nodes is what a chip
/// that runs all PEs in lock step issues.
class IssueTree {
 public:
  struct Node;
  using Region = std::vector<Node*>;  // one node for each iteration

  struct Node {
    IssueCounts counts;
    bool reached = false;
    std::uint64_t enabled_lanes = 0;
    std::vector<Region> regions;  // in the order in which the node's code enters them

    /// Resets the node; keeps the memory it holds.
    void clear() {
      counts = IssueCounts{};
      reached = false;
      enabled_lanes = 0;
      for (Region& region : regions) region.clear();
    }
  };

  IssueTree() = default;
  IssueTree(const IssueTree&) = delete;
  IssueTree& operator=(const IssueTree&) = delete;

  Node& root() { return root_; }
  const Node& root() const { return root_; }

  /// Returns the node for an iteration of a region of `parent`. Iterations come one after the other. The node
  /// keeps its address until clear().
  Node& node(Node& parent, std::size_t region, std::size_t iteration) {
    if (parent.regions.size() <= region) parent.regions.resize(region + 1);
    Region& iterations = parent.regions[region];
    while (iterations.size() <= iteration) iterations.push_back(&take());
    return *iterations[iteration];
  }

  /// Makes the tree ready for the next kernel. Nodes are kept and used again, because a kernel has dozens and
  /// there are many kernels.
  void clear() {
    root_.clear();
    used_ = 0;
  }

  template <class Visitor>  // (const Node&) -> void
  void for_each_node(Visitor&& visit) const {
    visit_node(root_, visit);
  }

  IssueCounts total() const {
    IssueCounts sum;
    for_each_node([&](const Node& node) { sum += node.counts; });
    return sum;
  }

 private:
  Node& take() {
    if (used_ == pool_.size()) pool_.emplace_back();
    Node& node = pool_[used_++];
    node.clear();
    return node;
  }

  template <class Visitor>
  static void visit_node(const Node& node, Visitor& visit) {
    if (!node.reached) return;
    visit(node);
    for (const Region& region : node.regions)
      for (const Node* iteration : region) visit_node(*iteration, visit);
  }

  Node root_;
  std::deque<Node> pool_;  ///< a deque, so that nodes keep their addresses
  std::size_t used_ = 0;
};

}  // namespace cn
