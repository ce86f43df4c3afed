# The version of the border to plug-ins: a digest of the headers that program and plug-in must share, and the header that
# tells the code.
file(GLOB_RECURSE interface_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/firmware/cn/*.hpp
  ${PROJECT_SOURCE_DIR}/firmware/plug_in/*.hpp)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${interface_headers})
set(digests "${CMAKE_CXX_COMPILER_ID}")
foreach(header IN LISTS interface_headers)
  file(SHA256 ${header} digest)
  string(APPEND digests ${digest})
endforeach()
string(SHA256 CSX600_INTERFACE_DIGEST "${digests}")
string(SUBSTRING ${CSX600_INTERFACE_DIGEST} 0 12 CSX600_INTERFACE_DIGEST)
configure_file(firmware/plug_in/interface_version.hpp.in ${PROJECT_BINARY_DIR}/generated/firmware/plug_in/interface_version.hpp @ONLY)
