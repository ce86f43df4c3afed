# Which levels of the x86-64 instruction set the kernels are built for: CSX600_BUILT_LEVELS, narrow to wide, and the header
# that tells the code. A program for this machine alone needs one level, the widest that it executes; a package or
# continuous integration wants all, from which the widest is picked at run time.
set(CSX600_LEVELS native CACHE STRING "x86-64 levels of the kernels: native, all, or a list of v2, v3, v4")

include(CheckCXXSourceRuns)
set(all_levels v2 v3 v4)
foreach(level IN LISTS all_levels)
  check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"x86-64-${level}\") ? 0 : 1; }"
    CSX600_MACHINE_RUNS_${level})
endforeach()

if(CSX600_LEVELS STREQUAL all)
  set(CSX600_BUILT_LEVELS ${all_levels})
elseif(CSX600_LEVELS STREQUAL native)
  foreach(level IN LISTS all_levels)
    if(CSX600_MACHINE_RUNS_${level})
      set(CSX600_BUILT_LEVELS ${level})
    endif()
  endforeach()
else()
  set(CSX600_BUILT_LEVELS ${CSX600_LEVELS})
  list(SORT CSX600_BUILT_LEVELS)
  list(REMOVE_DUPLICATES CSX600_BUILT_LEVELS)
endif()

foreach(level IN LISTS CSX600_BUILT_LEVELS)
  if(NOT level IN_LIST all_levels)
    message(FATAL_ERROR "CSX600_LEVELS: found '${level}', must be native, all, or a list of v2, v3, v4")
  endif()
endforeach()
if(NOT CSX600_BUILT_LEVELS)
  message(FATAL_ERROR "CSX600_LEVELS: this machine executes none of v2, v3, v4; name the levels to build for")
endif()

foreach(level IN LISTS all_levels)
  if(level IN_LIST CSX600_BUILT_LEVELS)
    set(CSX600_BUILDS_${level} true)
  else()
    set(CSX600_BUILDS_${level} false)
  endif()
endforeach()
configure_file(firmware/cn/simd/built_levels.hpp.in generated/firmware/cn/simd/built_levels.hpp @ONLY)
message(STATUS "Kernels for x86-64 levels: ${CSX600_BUILT_LEVELS}")
