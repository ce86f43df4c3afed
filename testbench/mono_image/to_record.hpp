#pragma once

#include <glm/glm.hpp>

#include "firmware/cn/language/vec3.hpp"

namespace testbench {

/// A vector as records in mono memory hold it.
inline cn::vec3<double> to_record(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace testbench
