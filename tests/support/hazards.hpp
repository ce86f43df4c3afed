#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/cn/machine.hpp"

namespace test_support {

/// The message of the fault that stops `run`; empty if none does.
template <class Run>
std::string fault_of(Run&& run) {
  try {
    run();
  } catch (const cn::MachineFault& fault) {
    return fault.what();
  }
  return "";
}

inline void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
}

inline void expect_one_line(const std::string& message) {
  EXPECT_FALSE(message.empty());
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

}  // namespace test_support
