#include "testbench/system/memory.hpp"

#include <gtest/gtest.h>

#include "testbench/film/film.hpp"
#include "testbench/system/error.hpp"

namespace memory_test {

TEST(Memory, WhatTheMachineDoesNotHaveIsOneLine) {
  EXPECT_NO_THROW(testbench::require_memory(1 << 20, "a little"));
  try {
    testbench::require_memory(std::uint64_t{1} << 60, "a film");
    FAIL() << "no error";
  } catch (const testbench::RunError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind("out of memory: a film needs 1152921504606846976 bytes, ", 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(Memory, AFilmTakesItsSumsAndNoPadding) {
  const testbench::Film film({64, 64}, 1.0);
  // Six sums of 128 bits and a number of samples of 64 bits a pixel, the rejected samples, and whether splats
  // were added.
  EXPECT_EQ(film.bytes().size(), 64u * 64u * (6 * 16 + 8) + sizeof(testbench::RejectedSamples) + 1);
}

}  // namespace memory_test
