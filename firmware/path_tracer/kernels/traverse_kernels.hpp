#pragma once

#include "firmware/path_tracer/kernels/traversal_kernels.hpp"

namespace path_tracer {

/// The poly programs that test leaves and visit nodes of 2, 4 or 8 children. The namespace is
/// the level's name.
inline namespace CN_LEVEL {
template <int width>
const TraverseKernels& traverse_kernel_table();
}

}  // namespace path_tracer
