# csx600_add_firmware(NAME SOURCES...): builds libNAME.so, which `csx600 run` loads. All sources are compiled once for each
# x86-64 level in CSX600_FIRMWARE_LEVELS, and once with kernels that report their SRAM accesses (--check-hazards). One of
# them defines plug_in::make_firmware(), whose symbol each level's object file gives a name of its own (plug_in/entry.cpp).
set(CSX600_FIRMWARE_LEVELS v2 v3 v4 CACHE STRING "x86-64 levels that plug-ins are built for: a list of v2, v3, v4")

function(csx600_add_firmware name)
  if(NOT ARGN)
    message(FATAL_ERROR "csx600_add_firmware(${name}): found no source, allowed is one or more")
  endif()
  list(GET CSX600_FIRMWARE_LEVELS 0 least)
  set(objects "")
  foreach(level IN ITEMS ${CSX600_FIRMWARE_LEVELS} observed)
    set(observed "")
    set(march ${level})
    set(suffix x86_64_${level})
    if("${level}" STREQUAL "observed")
      set(observed OBSERVED)
      set(march ${least})
      set(suffix observed)
    endif()
    set(part ${name}_${suffix})
    set(make csx600_firmware_${suffix})
    csx600_add_level_object(${part} ${march} ${observed}
      SOURCES ${ARGN} ${CSX600_FIRMWARE_SOURCES}/firmware/cn/language/math.cpp
      OBJCOPY --redefine-sym=_ZN7plug_in13make_firmwareEv=${make} --keep-global-symbol=${make})
    target_link_libraries(${part}_objects PRIVATE csx600::cn PkgConfig::SLEEF)
    set_target_properties(${part}_objects PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF)
    # One call finds the block of a thread's variables, instead of one call for each variable. Without a build type,
    # kernels would be compiled without optimisation.
    target_compile_options(${part}_objects PRIVATE -ftls-model=local-dynamic)
    if(NOT CMAKE_BUILD_TYPE AND NOT "${level}" STREQUAL "observed")
      target_compile_options(${part}_objects PRIVATE -O3)
    endif()
    list(APPEND objects ${${part}_object})
  endforeach()
  add_library(${name} MODULE ${CSX600_FIRMWARE_SOURCES}/firmware/plug_in/entry.cpp ${objects})
  set_target_properties(${name} PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF PREFIX lib)
  target_link_libraries(${name} PRIVATE csx600::cn PkgConfig::SLEEF)
  target_link_options(${name} PRIVATE
    LINKER:--version-script,${CMAKE_CURRENT_FUNCTION_LIST_DIR}/plug_in.map LINKER:-z,defs)
endfunction()
