#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <ostream>
#include <utility>
#include <vector>

#include "firmware/cn/language/kernel.hpp"

namespace cn {

inline bool operator!=(const IssueCounts& a, const IssueCounts& b) {
  return !(a == b);
}

/// The issued instructions by name, without zeros, so that a failed comparison is readable.
inline void PrintTo(const IssueCounts& counts, std::ostream* out) {
  *out << "{";
  for (std::size_t i = 0; i < kInstructionClasses; ++i)
    if (counts.by_class[i] != 0) *out << " " << kInstructionClassNames[i] << ":" << counts.by_class[i];
  *out << " }";
}

}  // namespace cn

namespace test_support {

/// A variable of every PE as the test sees it.
template <class T>
using PerPe = std::vector<T>;

inline cn::IssueCounts counts(std::initializer_list<std::pair<cn::InstructionClass, std::uint64_t>> issued) {
  cn::IssueCounts sum;
  for (const auto& [instruction, times] : issued) sum[instruction] += times;
  return sum;
}

/// The strip's part of `values`, without issuing instructions.
template <class T>
[[gnu::noinline]] cn::poly<T> load(const PerPe<T>& values) {
  using Lane = typename cn::poly<T>::Lane;
  return cn::poly<T>(cn::each_lane<Lane>(
      [&](int i) { return static_cast<Lane>(values[std::size_t(cn::strip.first_pe + i)]); }));
}

/// Stores the values of all PEs of the strip, enabled or not. Checks that each lane holds a value of T
/// without stray bits above it.
template <class T>
[[gnu::noinline]] void store(PerPe<T>& values, const cn::poly<T>& poly) {
  for (int i = 0; i < cn::kStripLanes; ++i) {
    const auto lane = poly.lanes()[i];
    const auto value = static_cast<T>(lane);
    if constexpr (std::is_integral_v<T>) {
      EXPECT_EQ(static_cast<decltype(lane)>(value), lane) << "PE " << cn::strip.first_pe + i;
    }
    values[std::size_t(cn::strip.first_pe + i)] = value;
  }
}

[[gnu::noinline]] inline void store(PerPe<char>& values, const cn::mask& mask) {
  for (int i = 0; i < cn::kStripLanes; ++i) {
    const std::int64_t lane = mask.lanes()[i];
    EXPECT_TRUE(lane == 0 || lane == -1) << lane;
    values[std::size_t(cn::strip.first_pe + i)] = lane != 0;
  }
}

template <class Program>
void call(const Program& program) {
  program();
}

/// A fixture that runs callables as kernels on its own array.
class StripFixture : public testing::Test {
 protected:
  explicit StripFixture(int num_pes = 24) : memory(num_pes, 1024) {}

  template <class Program>
  const cn::IssueTree& run(const cn::LaneMask& enabled, const Program& program) {
    cn::run_strips<Program, &call<Program>>(program, memory, enabled, issue_tree);
    return issue_tree;
  }
  template <class Program>
  const cn::IssueTree& run(const Program& program) {
    return run(cn::LaneMask::first(num_pes()), program);
  }
  /// The total of the instructions that `program` issues with every PE enabled.
  template <class Program>
  cn::IssueCounts issued_by(const Program& program) {
    return run(program).total();
  }

  int num_pes() const { return memory.num_pes(); }
  template <class T>
  PerPe<T> per_pe(T value = T{}) const {
    return PerPe<T>(std::size_t(num_pes()), value);
  }

  cn::PolyMemory memory;
  cn::IssueTree issue_tree;
};

}  // namespace test_support
