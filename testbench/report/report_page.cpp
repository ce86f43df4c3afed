#include "testbench/report/report_page.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "testbench/files/input_file.hpp"
#include "testbench/report/report_assets.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/statistics/renamed_keys.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/sweep/sweep_table.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// What the page reads of a sweep.json.
const Schema& sweep_schema() {
  static const Schema schema = {{"keys", JsonType::list},
                                {"keys.*", JsonType::text},
                                {"axes", JsonType::list},
                                {"axes.*", JsonType::list},
                                {"axes.*.*", JsonType::text},
                                {"base", JsonType::object},
                                {"base.*", JsonType::scalar},
                                {"points", JsonType::list},
                                {"points.*.inputs", JsonType::object},
                                {"points.*.inputs.*", JsonType::scalar},
                                {"points.*.status", JsonType::text},
                                {"points.*.error", JsonType::text, false},
                                {"points.*.results", JsonType::object, false},
                                {"points.*.results.*", JsonType::number_or_none, false}};
  return schema;
}

Json parse(const fs::path& path) {
  constexpr const char* kAllowed =
      "a statistics file of `csx600 render` or `csx600 run`, or a directory of `csx600 sweep`";
  const std::string text = read_input_file(path, kAllowed);
  Json json = parse_json_object(text, path, kAllowed);
  const std::string format = json.contains("format") && json["format"].is_string()
                                 ? json["format"].get<std::string>()
                                 : std::string("none");
  if (format == "csx600-statistics-1") require_statistics_format(format, path.string());
  const bool is_run = format == kStatisticsFormat || format == kRunStatisticsFormat;
  if (!is_run && format != kSweepFormat)
    throw InputError(path.string() + ": format: found '" + format + "'; allowed: '" + kStatisticsFormat +
                     "', '" + kRunStatisticsFormat + "', '" + kSweepFormat + "'");
  if (is_run) return parse_statistics(text, path);
  require_schema(json, sweep_schema(), text, path);
  return json;
}

void require_current_names(const fs::path& path, const Json& json) {
  if (json["format"] != kSweepFormat) return;  // parse_statistics() has checked them
  for (const Json& point : json["points"])
    if (point.contains("results"))
      for (const auto& [key, value] : point["results"].items()) require_current_key(path, key);
}

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string image_address(const std::string& image) {
  constexpr const char* kAllowed = "a PNG file of `csx600 render --png`";
  const std::string bytes = read_input_file(image, kAllowed);
  if (bytes.rfind("\x89PNG\r\n\x1a\n", 0) != 0)
    throw InputError("--image: " + image + ": found no PNG; allowed: " + kAllowed);
  return "data:image/png;base64," + base64(bytes);
}

/// JSON as the content of a script element, which the text "</" would end. In JSON "<" occurs only within
/// strings.
std::string for_script(const std::string& json) {
  std::string safe;
  for (const char c : json) safe += c == '<' ? "\\u003c" : std::string(1, c);
  return safe;
}

std::string for_html(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return safe;
}

/// The page with its places "{{NAME}}" filled from left to right. Filled-in text is not searched for places.
std::string fill(std::string_view page,
                 const std::vector<std::pair<std::string_view, std::string_view>>& places) {
  std::string filled;
  for (const auto& [name, content] : places) {
    const std::string place = "{{" + std::string(name) + "}}";
    const std::size_t at = page.find(place);
    filled.append(page.substr(0, at)).append(content);
    page.remove_prefix(at + place.size());
  }
  return filled.append(page);
}

}  // namespace

std::string report_page(const std::string& run_or_sweep, const std::string& image) {
  std::error_code ignored;  // read_input_file() says why a path cannot be read
  const fs::path path = fs::is_directory(run_or_sweep, ignored) ? fs::path(run_or_sweep) / "sweep.json"
                                                                : fs::path(run_or_sweep);
  const Json json = parse(path);
  require_current_names(path, json);
  const bool is_sweep = json["format"] == kSweepFormat;
  if (is_sweep && !image.empty())
    throw InputError("--image: found with a sweep; allowed: with one run's statistics");
  const fs::path named = is_sweep ? fs::absolute(path).parent_path() : path;
  const std::string title = (is_sweep ? "Sweep " : "Run ") + named.stem().string();
  if (!image.empty() && json["format"] == kRunStatisticsFormat)
    throw InputError("--image: found with statistics of `csx600 run`; allowed: with a render's");
  Json data = {{"title", title}, {is_sweep ? "sweep" : "run", json}};
  if (!image.empty()) data["image"] = image_address(image);
  namespace assets = report_assets;
  return fill(assets::page_html(),
              {{"TITLE", for_html(title)},
               {"STYLE", assets::page_css()},
               {"DATA", for_script(data.dump(-1, ' ', true, Json::error_handler_t::replace))},
               {"LIBRARY", assets::echarts_js()},
               {"COMMON", assets::common_js()},
               {"RUN", assets::run_js()},
               {"SWEEP", assets::sweep_js()}});
}

}  // namespace testbench
