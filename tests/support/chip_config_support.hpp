#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "model/config/chip_file.hpp"
#include "model/config/chip_parameters.hpp"

/// Shared by the tests of chip parameters, presets and files.
namespace model {

/// The message of the ConfigError that `act` throws; "" and a test failure if it throws none.
template <class Act>
std::string error_of(Act act) {
  try {
    act();
  } catch (const ConfigError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no ConfigError";
  return {};
}

/// A TOML file in the test's temporary directory. The destructor removes it.
class TomlFile {
 public:
  explicit TomlFile(std::string_view content) {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = testing::TempDir() + test->test_suite_name() + "_" + test->name() + "_" +
            std::to_string(getpid()) + ".toml";
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~TomlFile() { std::filesystem::remove(path_); }
  TomlFile(const TomlFile&) = delete;
  TomlFile& operator=(const TomlFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The message of the error when a file with `content` is loaded. The message must begin with the file's
/// name, which is replaced by "FILE".
inline std::string load_error(std::string_view content) {
  const TomlFile file(content);
  std::string message = error_of([&] { load_chip(file.path()); });
  const std::size_t at = message.find(file.path());
  EXPECT_EQ(at, 0U) << message;
  return at == 0 ? "FILE" + message.substr(file.path().size()) : message;
}

/// The keys whose values differ, and "preset" if the names of the presets differ.
inline std::vector<std::string> differences(const ChipConfig& a, const ChipConfig& b) {
  std::vector<std::string> keys;
  if (a.preset != b.preset) keys.push_back("preset");
  for (const ParameterInfo& parameter : parameter_table()) {
    if (parameter.read(a) != parameter.read(b)) keys.push_back(parameter.key);
  }
  return keys;
}

/// Allowed values of a parameter other than its default.
inline std::vector<ParameterValue> other_values(const ParameterInfo& parameter) {
  std::vector<ParameterValue> values;
  if (const auto* integers = std::get_if<IntegerRange>(&parameter.allowed)) {
    values = {integers->low, integers->high, integers->low + integers->multiple_of};
  } else if (const auto* reals = std::get_if<RealRange>(&parameter.allowed)) {
    values = {reals->low, reals->high, reals->low + (reals->high - reals->low) / 3};
  } else if (const auto* names = std::get_if<Choice>(&parameter.allowed)) {
    for (const std::string_view name : *names) values.push_back(std::string(name));
  } else {
    values = {true, false};
  }
  values.erase(std::remove(values.begin(), values.end(), parameter.default_value), values.end());
  return values;
}

}  // namespace model
