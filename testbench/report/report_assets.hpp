#pragma once

#include <string_view>

/// The parts of the report page: the files of testbench/report, linked into the program.
namespace testbench::report_assets {

std::string_view page_html();
std::string_view page_css();
std::string_view common_js();
std::string_view run_js();
std::string_view sweep_js();
std::string_view echarts_js();

}  // namespace testbench::report_assets
