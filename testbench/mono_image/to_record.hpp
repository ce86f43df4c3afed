#pragma once

#include <glm/glm.hpp>

#include "firmware/path_tracer/records/records.hpp"

namespace testbench {

/// A vector as records in mono memory hold it.
inline path_tracer::vec3<double> to_record(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace testbench
