#include "testbench/report/report_assets.hpp"

// Symbols that the linker defines for a file's bytes, named after the file.
extern "C" {
extern const char _binary_report_page_html_start[];
extern const char _binary_report_page_html_end[];
extern const char _binary_report_page_css_start[];
extern const char _binary_report_page_css_end[];
extern const char _binary_report_common_js_start[];
extern const char _binary_report_common_js_end[];
extern const char _binary_report_run_js_start[];
extern const char _binary_report_run_js_end[];
extern const char _binary_report_sweep_js_start[];
extern const char _binary_report_sweep_js_end[];
extern const char _binary_report_echarts_echarts_common_min_js_start[];
extern const char _binary_report_echarts_echarts_common_min_js_end[];
}

namespace testbench::report_assets {
namespace {

std::string_view between(const char* start, const char* end) {
  return {start, std::size_t(end - start)};
}

}  // namespace

std::string_view page_html() {
  return between(_binary_report_page_html_start, _binary_report_page_html_end);
}
std::string_view page_css() {
  return between(_binary_report_page_css_start, _binary_report_page_css_end);
}
std::string_view common_js() {
  return between(_binary_report_common_js_start, _binary_report_common_js_end);
}
std::string_view run_js() {
  return between(_binary_report_run_js_start, _binary_report_run_js_end);
}
std::string_view sweep_js() {
  return between(_binary_report_sweep_js_start, _binary_report_sweep_js_end);
}
std::string_view echarts_js() {
  return between(_binary_report_echarts_echarts_common_min_js_start,
                 _binary_report_echarts_echarts_common_min_js_end);
}

}  // namespace testbench::report_assets
