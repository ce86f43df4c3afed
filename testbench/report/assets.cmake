# The parts of the report page, linked into the program as bytes: report_assets.o in the folder that includes this. Symbols
# are named after the files (report_assets.cpp).
set(report_assets page.html page.css common.js run.js sweep.js echarts/echarts.common.min.js)
list(TRANSFORM report_assets PREPEND report/)
list(TRANSFORM report_assets PREPEND ${PROJECT_SOURCE_DIR}/testbench/ OUTPUT_VARIABLE report_files)
add_custom_command(OUTPUT report_assets.o
  COMMAND ${CSX600_GNU_LD} -m elf_x86_64 -r -b binary -z noexecstack -o ${CMAKE_CURRENT_BINARY_DIR}/report_assets.o ${report_assets}
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}/testbench DEPENDS ${report_files} VERBATIM)
