# How kernels are compiled: in this tree, and by csx600_add_firmware() in trees that use the installed package, which holds
# a copy of this file.

# The same bits on every machine: no contraction to fused multiply-add, no fast-math; integers wrap, as a PE's do. Neither
# errno nor traps of floating-point operations are looked at, and giving them up changes no result.
set(CSX600_ARITHMETIC_OPTIONS -ffp-contract=off -fwrapv -fno-math-errno -fno-trapping-math)

# What joins objects and renames symbols: GNU's, whatever belongs to the compiler.
find_program(CSX600_GNU_LD NAMES ld.bfd ld REQUIRED)
find_program(CSX600_GNU_OBJCOPY NAMES objcopy REQUIRED)

# Structs of vectors are copied in pieces of these sizes. GCC's default of 128 bits writes a register in two halves and
# reads it back whole, which stalls; with it x86-64-v3 was no faster than v2.
set(CSX600_NATIVE_BITS_v2 128)
set(CSX600_NATIVE_BITS_v3 256)
set(CSX600_NATIVE_BITS_v4 512)

# csx600_add_level_object(NAME LEVEL [OBSERVED] SOURCES ... OBJCOPY ...): compiles sources for an x86-64 level into one
# object file, whose path is ${NAME}_object afterwards; NAME_objects is the target for further options. Inline functions
# that another part of the program also has must not be merged with ones compiled for a wider machine. That takes a
# relocatable link that dissolves comdat groups; OBJCOPY says which symbols stay global.
# vector_loop: instructions are counted from zero wherever control flow begins to depend on data, and GCC's `rep stos`
# takes longer to start than that to clear; a tree's kernels were 7 % slower.
# -Wno-psabi: vectors are passed between functions of one level only, so their ABI is nobody else's concern.
# OBSERVED: the kernels report their SRAM accesses, for the hazard checker. They are compiled with few optimisations, since
# looking at each access takes longer than what it looks at.
function(csx600_add_level_object name level)
  cmake_parse_arguments(PARSE_ARGV 2 of "OBSERVED" "" "SOURCES;OBJCOPY")
  set(native_bits ${CSX600_NATIVE_BITS_${level}})
  add_library(${name}_objects OBJECT ${of_SOURCES})
  target_compile_options(${name}_objects PRIVATE
    -march=x86-64-${level} -Wno-psabi
    "$<$<CXX_COMPILER_ID:GNU>:-mmove-max=${native_bits};-mstore-max=${native_bits}>"
    "$<$<CXX_COMPILER_ID:GNU>:-mmemset-strategy=vector_loop:-1:noalign;-fno-gnu-unique>")
  if(of_OBSERVED)
    target_compile_definitions(${name}_objects PRIVATE CN_OBSERVED_SRAM)
    target_compile_options(${name}_objects PRIVATE -O1)
  endif()
  set(object ${CMAKE_CURRENT_BINARY_DIR}/${name}.o)
  add_custom_command(
    OUTPUT ${object}
    COMMAND ${CSX600_GNU_LD} -r --force-group-allocation -o ${object} $<TARGET_OBJECTS:${name}_objects>
    COMMAND ${CSX600_GNU_OBJCOPY} ${of_OBJCOPY} ${object}
    DEPENDS ${name}_objects $<TARGET_OBJECTS:${name}_objects>
    COMMAND_EXPAND_LISTS
    VERBATIM)
  set_source_files_properties(${object} PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
  set(${name}_object ${object} PARENT_SCOPE)
endfunction()
