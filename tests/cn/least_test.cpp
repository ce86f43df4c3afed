#include "firmware/cn/language/least.hpp"

#include <gtest/gtest.h>

#include <random>

#include "firmware/cn/language/kernel.hpp"

namespace least_test {

struct LeastOf {
  cn::PolyField<std::int32_t> value;
  std::int32_t* least;
};
void find_least(const LeastOf& arguments) {
  cn::keep_least(arguments.value.read(), 16, *arguments.least);
}

/// The least value is that of the enabled PEs only, over all strips.
TEST(KeepLeast, FindsTheLeastOfTheEnabledPes) {
  constexpr int kPes = 40;
  cn::PolyMemory memory(kPes, 64);
  const cn::PolyField<std::int32_t> value{memory.allocate("value", 8).offset_bytes};
  std::mt19937_64 random(11);
  for (int round = 0; round < 200; ++round) {
    cn::LaneMask enabled;
    std::int32_t expected = 1 << 30;
    for (int pe = 0; pe < kPes; ++pe) {
      const auto number = std::int32_t(random() % 65536);
      memory.word(pe, value.offset_bytes) = std::uint64_t(unsigned(number));
      if (random() % 3 != 0) continue;
      enabled.set(pe, true);
      expected = std::min(expected, number);
    }
    std::int32_t least = 1 << 30;
    cn::IssueTree issued;
    cn::run_strips<LeastOf, find_least>({value, &least}, memory, enabled, issued);
    ASSERT_EQ(least, expected);
  }
}

}  // namespace least_test
