#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "testbench/system/error.hpp"

namespace test_support {

/// The message of the InputError that `action` throws; "" if it throws none.
template <class Action>
std::string input_error_of(Action&& action) {
  try {
    action();
  } catch (const testbench::InputError& error) {
    return error.what();
  }
  return "";
}

/// Checks that `action` throws an InputError whose message is one line and contains every part.
template <class Action>
void expect_input_error(Action&& action, const std::vector<std::string>& parts) {
  const std::string message = input_error_of(action);
  EXPECT_NE(message, "") << "no error";
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
}

}  // namespace test_support
