// Linked with one source of the firmware broken (add_hazard_mutant in CMakeLists.txt): the hazard checker
// must stop it.

#include <set>
#include <sstream>

#include "tests/hazards/hazard_mutant.hpp"
#include "tests/support/checked_firmware.hpp"
#include "tests/support/hazards.hpp"

namespace hazard_mutant_test {

using path_tracer::Program;
using path_tracer::ProgramConfig;
using path_tracer::Traversal;
using test_support::kHazardMutant;

std::vector<std::string> expected_parts() {
  std::vector<std::string> parts{"hazard", "kernel '", "request ", " bytes, ", "semaphore '"};
  std::istringstream text(kHazardMutant.expected);
  for (std::string part; std::getline(text, part, '|');) parts.push_back(part);
  return parts;
}

bool has_all(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    if (message.find(part) == std::string::npos) return false;
  return true;
}

/// The hazard's message; empty when the run came to its end, or was refused before it began.
std::string fault_of(const testbench::Scene& scene, const ProgramConfig& config) {
  try {
    return test_support::run_checked(scene, config, 8, 1).fault;
  } catch (const path_tracer::ProgramError&) {
    return "";
  }
}

std::vector<Traversal> traversals() {
  using test_support::kTreeTraversals;
  if (kHazardMutant.of_tree) return {std::begin(kTreeTraversals), std::end(kTreeTraversals)};
  return {Traversal::brute_force};
}

/// Some configurations can do without the missing line: at n = 0 no block is loaded ahead, and with many
/// blocks no two steps meet on one. Where a configuration cannot, the message must be the expected one.
TEST(Mutant, IsStopped) {
  const std::vector<std::string> parts = expected_parts();
  std::set<std::string> stopped;
  std::set<std::string> as_expected;
  const auto try_one = [&](const testbench::Scene& scene, const ProgramConfig& config) {
    const std::string fault = fault_of(scene, config);
    if (fault.empty()) return;
    test_support::expect_one_line(fault);
    stopped.insert(fault);
    if (has_all(fault, parts)) as_expected.insert(fault);
  };
  for (const testbench::Scene& scene : {test_support::small_scene(), test_support::open_scene()})
    for (const Program program : {Program::segments, Program::direct, Program::full})
      for (const Traversal traversal : traversals())
        for (const int n : {0, 1, 3, 8})
          for (const int blocks : {1, 2, 4, 8})
            try_one(scene, test_support::checked_program(program, traversal, n, blocks));
  EXPECT_FALSE(stopped.empty()) << kHazardMutant.name << " was never noticed";
  EXPECT_FALSE(as_expected.empty()) << kHazardMutant.name << " was not noticed as " << kHazardMutant.expected
                                    << ", but as " << (stopped.empty() ? "nothing" : *stopped.begin());
  std::printf("%zu different messages, %zu as expected", stopped.size(), as_expected.size());
  std::printf(", such as: %s\n", as_expected.empty() ? "none" : as_expected.begin()->c_str());
}

}  // namespace hazard_mutant_test
