# What `cmake --install` installs: the program, what firmware outside this tree is built with, and the chip's library.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(CSX600_FIRMWARE_SOURCES ${PROJECT_SOURCE_DIR})
include(firmware/add_firmware.cmake)

# The examples as plug-ins, which `csx600 run dgemm` finds by their names: beside the program in the build tree, in
# lib/csx600 when installed (testbench/plug_in/firmware_path.cpp).
add_subdirectory(firmware/examples/plug_ins)

set(headers ${CMAKE_INSTALL_INCLUDEDIR}/csx600)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/csx600)

install(TARGETS csx600 COMPONENT program)
install(TARGETS ${example_plug_ins} LIBRARY DESTINATION lib/csx600 COMPONENT program)
install(TARGETS csx600_cn EXPORT csx600 COMPONENT development)
install(EXPORT csx600 NAMESPACE csx600:: DESTINATION ${package} FILE csx600Targets.cmake COMPONENT development)
install(DIRECTORY firmware/cn firmware/plug_in DESTINATION ${headers}/firmware COMPONENT development
  FILES_MATCHING PATTERN *.hpp PATTERN level.hpp EXCLUDE)
install(FILES ${PROJECT_BINARY_DIR}/generated/firmware/plug_in/interface_version.hpp
  DESTINATION ${headers}/firmware/plug_in COMPONENT development)
# These are compiled into each plug-in, once for each level.
install(FILES firmware/plug_in/entry.cpp DESTINATION ${headers}/firmware/plug_in COMPONENT development)
install(FILES firmware/cn/language/math.cpp DESTINATION ${headers}/firmware/cn/language COMPONENT development)

configure_package_config_file(firmware/csx600Config.cmake.in ${PROJECT_BINARY_DIR}/csx600Config.cmake
  INSTALL_DESTINATION ${package} PATH_VARS headers)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/csx600ConfigVersion.cmake COMPATIBILITY ExactVersion)
install(FILES ${PROJECT_BINARY_DIR}/csx600Config.cmake ${PROJECT_BINARY_DIR}/csx600ConfigVersion.cmake
  firmware/kernels.cmake firmware/add_firmware.cmake firmware/plug_in.map DESTINATION ${package} COMPONENT development)

# The chip as a plain sc_module, for platforms of others: csx600::chip. Its headers include SystemC's, so they have a folder
# of their own; those of firmware stay free of it.
install(TARGETS model model_timing firmware_cn EXPORT csx600_chip COMPONENT development)
install(EXPORT csx600_chip NAMESPACE csx600:: DESTINATION ${package} FILE csx600ChipTargets.cmake COMPONENT development)
install(DIRECTORY model DESTINATION ${headers}_chip COMPONENT development FILES_MATCHING PATTERN *.hpp)

# Two Debian packages, `cpack --config build/release/CPackConfig.cmake`: the program; headers, library and CMake package.
set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_PACKAGE_CONTACT "csx600 contributors")
set(CPACK_PACKAGE_VENDOR csx600)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Model of the ClearSpeed CSX600 that runs firmware")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME csx600)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME csx600-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "csx600 (= ${PROJECT_VERSION}), g++ (>= 4:12), cmake (>= 3.25), make | ninja-build, pkg-config, binutils, libsleef-dev, \
libsystemc-dev, libtomlplusplus-dev")
include(CPack)
