#pragma once

namespace test_support {

/// What is broken in the firmware that a mutant's program is linked with (CMakeLists.txt).
struct HazardMutant {
  const char* name;
  const char* expected;  ///< parts of the message that must stop it, separated by |
  bool of_tree;          ///< it runs through a tree
};

extern const HazardMutant kHazardMutant;

}  // namespace test_support
