#pragma once

#include "firmware/path_tracer/kernels/traversal_kernels.hpp"

namespace path_tracer {

/// The poly programs that test leaves and visit nodes of 2, 4 or 8 children. TRAVERSE_KERNELS is the level's
/// name for the table.
template <int width>
const TraverseKernels& TRAVERSE_KERNELS();

}  // namespace path_tracer
