#include <filesystem>
#include <memory>
#include <string>

#include "testbench/film/image_file.hpp"
#include "testbench/golden/golden.hpp"
#include "testbench/report/report_page.hpp"
#include "testbench/statistics/statistics_difference.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/sweep/point_store.hpp"
#include "testbench/sweep/sweep_table.hpp"
#include "tests/fuzz/input_files.hpp"
#include "tests/fuzz/targets.hpp"

namespace fuzz {
namespace {

/// A sweep of two points, loaded once: what is known of it is not what strangers send.
const testbench::Sweep& known_sweep() {
  static const std::unique_ptr<testbench::Sweep> sweep = [] {
    write_file("known.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    testbench::SweepFile file;
    file.path = "known.toml";
    file.base = {{"scene", "known.obj", "known.toml:1"}};
    file.axes = {{{"samples"}, {{{"samples", "1", "known.toml:3"}}, {{"samples", "2", "known.toml:3"}}}}};
    return std::make_unique<testbench::Sweep>(file, std::vector<testbench::Setting>());
  }();
  return *sweep;
}

/// The input with the points' identities, which follow from all parameters of the program, for "@0" and "@1".
std::string with_identities(std::string_view input, const testbench::Sweep& sweep) {
  std::string text(input);
  for (std::size_t point = 0; point < sweep.points().size(); ++point) {
    const std::string name = "@" + std::to_string(point);
    for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos;)
      text.replace(at, name.size(), sweep.points()[point].id);
  }
  return text;
}

}  // namespace

void read_golden_table(std::string_view input) {
  write_file("table.csv", input);
  const testbench::GoldenTables tables = testbench::read_golden(".");
  testbench::golden_moves(testbench::golden_verdicts({}, tables));
  if (tables.size() != 1) fail("another number of tables than files");
}

void read_statistics(std::string_view input) {
  write_parts(input, {"a.json", "b.json"});
  const nlohmann::ordered_json a = testbench::read_statistics("a.json");
  for (const char* const file : {"a.csv", "a.txt", "a.json"}) testbench::statistics_for_file(file, a);
  if (!testbench::compare(testbench::flatten(a), testbench::flatten(a), {}).differences.empty())
    fail("statistics that differ from themselves");
  const bool is_alone = !std::filesystem::exists("b.json");
  const nlohmann::ordered_json b = is_alone ? a : testbench::read_statistics("b.json");
  const testbench::ComparisonRules rules = {{{"chip.*", 0.5}}, {"simulator.*"}, {{"*_cycles", 10}}};
  testbench::difference_text(
      testbench::compare(testbench::flatten(a), testbench::flatten(b), rules).differences);
}

void read_points(std::string_view input) {
  const testbench::Sweep& sweep = known_sweep();
  write_file("points.jsonl", with_identities(input, sweep));
  const testbench::PointStore store(".", "build");
  testbench::sweep_tables(sweep, testbench::sweep_json(sweep, store));
}

void read_report(std::string_view input) {
  write_file("sweep.json", input);
  testbench::report_page(".", "");
}

void read_exr(std::string_view input) {
  write_file("image.exr", input);
  const testbench::RadianceImage image = testbench::read_exr_rgb("image.exr");
  if (image.rgb.size() != 3 * std::size_t(image.width) * std::size_t(image.height))
    fail("another number of pixels");
  testbench::read_exr_film("image.exr");
}

}  // namespace fuzz
