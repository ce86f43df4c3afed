#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "testbench/statistics/statistics_difference.hpp"

namespace testbench {

/// What a comparison says of one thing, as tools of continuous integration show it.
struct TestCase {
  std::string group;
  std::string name;
  std::string failure;  ///< "": passed
};

/// The cases as JUnit's XML: one test suite.
std::string junit_xml(const std::string& suite, const std::vector<TestCase>& cases);

/// Every value that was compared, which passed or differs.
std::vector<TestCase> cases_of(const Comparison& comparison);

/// [{ key, a, b, relative, unit }], a or b null where that run does not have the key.
nlohmann::ordered_json differences_json(const std::vector<Difference>& differences);

}  // namespace testbench
