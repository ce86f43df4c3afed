#include "firmware/path_tracer/kernels/traverse.hpp"

namespace path_tracer {

template const TraverseKernels& TRAVERSE_KERNELS<4>();

}  // namespace path_tracer
