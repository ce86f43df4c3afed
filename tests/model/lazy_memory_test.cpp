#include "model/memory/lazy_memory.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace lazy_memory_test {

TEST(LazyMemory, TakesOnlyPagesThatAreTouched) {
  model::LazyMemory memory(std::uint64_t{1} << 34);  // 16 GiB, more than the simulator need have
  EXPECT_EQ(memory.size_bytes(), std::uint64_t{1} << 34);
  memory.data()[0] = 1;
  memory.data()[(std::uint64_t{1} << 34) - 1] = 2;
  EXPECT_GE(memory.resident_bytes(), 2u * 4096);
  EXPECT_LE(memory.resident_bytes(), std::uint64_t{8} << 20);
}

TEST(LazyMemory, ReadsAsZero) {
  model::LazyMemory memory(1 << 20);
  for (std::uint64_t i = 0; i < memory.size_bytes(); i += 4093) ASSERT_EQ(memory.data()[i], 0) << i;
}

TEST(LazyMemory, RefusedRangeNamesItsSize) {
  try {
    model::LazyMemory memory(std::uint64_t{1} << 62);
    FAIL() << "no host has that much address space";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(),
                 "mono memory of 4611686018427387904 bytes: the host refused the address range");
  }
}

}  // namespace lazy_memory_test
