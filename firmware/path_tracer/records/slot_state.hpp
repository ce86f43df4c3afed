#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/cn/chip/mono_memory.hpp"

/// What stream execution (Execution::stream) has in mono memory beside the bins, because no PE keeps anything
/// from one kernel to the next.
namespace path_tracer {

/// What the array would keep in a PE for a slot: conditions, and the places of what its ray needs next.
struct SlotState {
  cn::MonoAddress surface_place = 0;
  cn::MonoAddress light_place = 0;
  std::int32_t conditions = 0;  ///< bit i: SlotCondition i
  std::int32_t unused = 0;
};

/// Conditions of slots, in the order of their bits.
enum class SlotCondition { live, shadow, hit_something, casts, ended, finished };
inline constexpr std::size_t kSlotConditions = 6;

/// Of a slot: 1 if its path ended, 1 if its vertices wait for their radiance. Sums of these, taken over the
/// slots before a slot, are its ascending numbers. As one word, two such records add up by one addition.
struct PathNumbers {
  std::int32_t ended = 0;
  std::int32_t finished = 0;
};

/// Words that a PE sums up at each level of a scan.
inline constexpr int kScanRadix = 8;

/// The levels of a scan over so many words: those of level 0 are the input, those of each further level sums
/// of kScanRadix words of the level below, up to a single one.
struct ScanLevels {
  static constexpr int kMaxLevels = 12;
  int count = 0;
  std::array<std::int32_t, kMaxLevels> words{};   ///< by level
  std::array<std::uint64_t, kMaxLevels> first{};  ///< by level: its first word
  std::uint64_t all_words = 0;

  explicit ScanLevels(std::int32_t input_words) {
    add_level(input_words);
    while (words[std::size_t(count - 1)] > 1) add_level(groups(count - 1));
  }

  /// PEs that a level takes, each with kScanRadix of its words.
  std::int32_t groups(int level) const { return (words[std::size_t(level)] + kScanRadix - 1) / kScanRadix; }
  /// The last level, whose word is the sum of all.
  int top() const { return count - 1; }

 private:
  void add_level(std::int32_t words_here) {
    words[std::size_t(count)] = words_here;
    first[std::size_t(count)] = all_words;
    all_words += std::uint64_t(groups(count)) * kScanRadix;
    ++count;
  }
};

}  // namespace path_tracer
