#include "model/control/data_cache.hpp"

#include <gtest/gtest.h>

namespace data_cache_test {

using model::DataCache;

TEST(DataCache, NumbersLines) {
  const DataCache cache(4096, 32);
  EXPECT_EQ(cache.line_bytes(), 32u);
  EXPECT_EQ(cache.line_of(0), 0u);
  EXPECT_EQ(cache.line_of(31), 0u);
  EXPECT_EQ(cache.line_of(32), 1u);
  EXPECT_EQ(cache.line_of(std::uint64_t{1} << 33), std::uint64_t{1} << 28);
}

TEST(DataCache, HoldsEachLineAfterItsFirstTouch) {
  DataCache cache(4096, 32);
  for (std::uint64_t line = 0; line < 128; ++line) EXPECT_FALSE(cache.touch(line)) << line;
  for (std::uint64_t line = 0; line < 128; ++line) EXPECT_TRUE(cache.touch(line)) << line;
}

TEST(DataCache, LinesOfOnePlaceDriveEachOtherOut) {
  DataCache cache(4096, 32);
  EXPECT_FALSE(cache.touch(3));
  EXPECT_FALSE(cache.touch(3 + 128));
  EXPECT_FALSE(cache.touch(3));
  EXPECT_TRUE(cache.touch(3));
  EXPECT_FALSE(cache.touch(4));
  EXPECT_TRUE(cache.touch(3));
}

TEST(DataCache, OneLineIsACacheToo) {
  DataCache cache(64, 64);
  EXPECT_FALSE(cache.touch(0));
  EXPECT_TRUE(cache.touch(0));
  EXPECT_FALSE(cache.touch(1));
  EXPECT_FALSE(cache.touch(0));
}

}  // namespace data_cache_test
