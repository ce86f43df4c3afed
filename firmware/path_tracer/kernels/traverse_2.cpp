#include "firmware/path_tracer/kernels/traverse.hpp"

namespace path_tracer {

template const TraverseKernels& CN_LEVEL::traverse_kernel_table<2>();

}  // namespace path_tracer
