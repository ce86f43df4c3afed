#pragma once

#include "firmware/cn/language/vec3.hpp"
#include "tests/support/strip_fixture.hpp"

/// Points and directions for tests of poly functions.
namespace test_support {

using Vector = cn::vec3<double>;
inline constexpr double Vector::*kComponents[] = {&Vector::x, &Vector::y, &Vector::z};

struct Ray {
  Vector origin;
  Vector direction;
};

/// One vector per PE.
inline cn::vec3<cn::poly<double>> load3(const PerPe<Vector>& vectors) {
  PerPe<double> parts[3];
  for (const Vector& v : vectors)
    for (int axis = 0; axis < 3; ++axis) parts[axis].push_back(v.*kComponents[axis]);
  return {load(parts[0]), load(parts[1]), load(parts[2])};
}

}  // namespace test_support
