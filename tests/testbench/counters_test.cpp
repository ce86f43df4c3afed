// Each counter is declared once: tests JSON, CSV and text made from the declarations, and sums of a run's
// counters.

#include "testbench/statistics/counters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "testbench/statistics/render_report.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace counters_test {

using nlohmann::ordered_json;
using path_tracer::Program;
using testbench::Counter;
using testbench::RenderOptions;
using testbench::RenderResult;

/// Splits a CSV text into lines of cells. A quoted cell may contain commas.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, {""});
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"') {
      rows.back().back() += text[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == ',') {
      rows.back().emplace_back();
    } else if (!quoted && c == '\n') {
      rows.push_back({""});
    } else {
      rows.back().back() += c;
    }
  }
  rows.pop_back();
  return rows;
}

class CountersOfRuns : public test_support::SystemCFixture {
 protected:
  static RenderResult on_chip(const RenderOptions& options) {
    new_context();
    return testbench::render_on_chip(test_support::small_cornell_box({17, 5}), options);
  }
  static ordered_json statistics(const RenderOptions& options) {
    return testbench::render_statistics({"scene", options, false}, on_chip(options));
  }
  static ordered_json statistics() { return statistics(test_support::render_options(Program::full, 24)); }
};

TEST(CounterDeclarations, HaveUniqueNamesKnownUnitsAndMeanings) {
  std::set<std::string> keys;
  for (const Counter& counter : testbench::all_counters()) {
    EXPECT_TRUE(keys.insert(counter.key).second) << counter.key << " twice";
    EXPECT_NE(std::find(testbench::kCounterUnits.begin(), testbench::kCounterUnits.end(), counter.unit),
              testbench::kCounterUnits.end())
        << counter.key << ": unit " << counter.unit;
    EXPECT_GT(counter.meaning.size(), 8u) << counter.key;
  }
  EXPECT_GT(keys.size(), 90u);
}

TEST(CounterDeclarations, DescriptionNamesEachWithItsUnitAndMeaning) {
  const std::string text = testbench::describe_counters();
  std::istringstream lines(text);
  std::string line;
  for (const Counter& counter : testbench::all_counters()) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(line.rfind(counter.key + " ", 0), 0u) << line;
    EXPECT_NE(line.find(" " + counter.unit + " "), std::string::npos) << line;
    EXPECT_NE(line.find(counter.meaning), std::string::npos) << line;
  }
}

/// Statistics of a run through a tree, with lobes, on a chip with a search unit; other runs have no rays by
/// pass, plain ones no lobes, and other chips no queries. Rays of bidirectional paths are from another run.
TEST_F(CountersOfRuns, EachDeclarationIsInJsonCsvAndText) {
  RenderOptions options = test_support::render_options(Program::full, 24);
  options.program.traversal = path_tracer::Traversal::refill;
  options.program.built_for = 1;
  options.chip.search_unit.units = 1;
  ASSERT_STREQ(path_tracer::kBuiltForTable[1].name, "glossy");
  ordered_json json = statistics(options);
  RenderOptions both_ends = test_support::render_options(Program::full, 24);
  both_ends.program.paths = path_tracer::Paths::bidirectional;
  json["counts"]["bidirectional"] = statistics(both_ends)["counts"]["bidirectional"];
  const auto flat = testbench::flatten(json);
  std::map<const Counter*, std::string> example;
  for (const auto& [key, value] : flat)
    if (const Counter* const counter = testbench::find_counter(key)) example[counter] = key;
  std::map<std::string, std::vector<std::string>> csv;
  for (const auto& row : parse_csv(testbench::statistics_csv(json))) {
    ASSERT_EQ(row.size(), 4u) << row[0];
    csv[row[0]] = row;
  }
  EXPECT_EQ(csv.size(), flat.size() + 1);  // one line per counter and the header
  const std::string text = testbench::statistics_text(json);
  for (const Counter& declared : testbench::all_counters()) {
    const Counter* const counter = testbench::find_counter(declared.key);
    ASSERT_EQ(counter, &declared) << declared.key << " is hidden by " << counter->key;
    ASSERT_EQ(example.count(counter), 1u) << declared.key << " has no value in JSON";
    const std::string& key = example[counter];
    ASSERT_EQ(csv.count(key), 1u) << key;
    EXPECT_EQ(csv[key][1], declared.unit) << key;
    EXPECT_EQ(csv[key][3], declared.meaning) << key;
    const std::string group = testbench::group_of(key);
    const std::size_t place = text.find(group == "run" ? "  " + key + " " : "\n" + group + "\n");
    ASSERT_NE(place, std::string::npos) << key;
    const std::size_t line = text.find("  " + key.substr(key.rfind('.') + 1) + " ", place);
    ASSERT_NE(line, std::string::npos) << key;
    const std::string shown = text.substr(line, text.find('\n', line) - line);
    EXPECT_NE(shown.find(csv[key][2]), std::string::npos) << shown << " of " << key;
    if (declared.unit != "-" && declared.unit != "count") {
      EXPECT_NE(shown.find(" " + declared.unit), std::string::npos) << shown;
    }
  }
}

TEST_F(CountersOfRuns, WhatHasNoDeclarationIsWhatTheRunWasAskedToDo) {
  for (const auto& [key, value] : testbench::flatten(statistics())) {
    if (testbench::find_counter(key) != nullptr) continue;
    const std::string root = key.substr(0, key.find('.'));
    const std::set<std::string> inputs = {"format",  "scene",  "width",       "height",      "firmware",
                                          "machine", "timing", "chip_preset", "chip_config", "image_sha256"};
    EXPECT_EQ(inputs.count(root), 1u) << key;
  }
}

TEST_F(CountersOfRuns, ParametersOfTheChipAreKeysOfTheirOwn) {
  std::map<std::string, ordered_json> flat;
  for (const auto& [key, value] : testbench::flatten(statistics())) flat[key] = value;
  EXPECT_EQ(flat.at("chip_config.pio.setup_cycles"), 150);
  EXPECT_EQ(flat.at("chip_config.poly.cycles.fp64_add"), 4);
  EXPECT_EQ(flat.at("chip_config.pio.arbitration"), "reads_overtake_writes");
}

/// Relations between the counters that hold for every run.
void expect_sums(const RenderResult& result, const std::string& name) {
  const testbench::ChipStatistics& chip = *result.chip;
  EXPECT_EQ(chip.control.total(), chip.firmware_cycles) << name;
  const ordered_json json = testbench::to_json(chip);
  std::uint64_t exposed = json["control_unit"]["exposed_wait_after_last_kernel_cycles"];
  std::uint64_t cycles = 0;
  for (const ordered_json& kernel : json["pe_array"]["kernels"]) {
    exposed += kernel["exposed_wait_cycles"].get<std::uint64_t>();
    cycles += kernel["cycles"].get<std::uint64_t>();
    EXPECT_EQ(kernel["exposed_wait_cycles"].get<std::uint64_t>(),
              kernel["wait_load_cycles"].get<std::uint64_t>() +
                  kernel["wait_save_cycles"].get<std::uint64_t>() +
                  kernel["wait_pio_queue_cycles"].get<std::uint64_t>());
    std::uint64_t runs = 0;
    for (const auto& [enabled, count] : kernel["runs_by_enabled_pes"].items())
      runs += count.get<std::uint64_t>();
    EXPECT_EQ(runs, kernel["runs"].get<std::uint64_t>()) << name << ", " << kernel["name"];
  }
  EXPECT_EQ(exposed, chip.control.exposed_pio()) << name;
  EXPECT_LE(chip.all_kernels.waited_before.total(), chip.control.exposed_pio()) << name;
  EXPECT_EQ(cycles, chip.control[model::CycleCause::poly]) << name;
  std::uint64_t paths = 0;
  std::uint64_t segments = 0;
  for (std::size_t i = 0; i < result.counts.paths_by_segments.size(); ++i) {
    paths += result.counts.paths_by_segments[i];
    segments += i * result.counts.paths_by_segments[i];
  }
  EXPECT_EQ(paths, result.counts.paths) << name;
  EXPECT_EQ(segments, result.counts.segments) << name;
  std::uint64_t rays = 0;
  for (const std::uint64_t of_interval : result.counts.rays.intervals()) rays += of_interval;
  EXPECT_EQ(rays, result.counts.segments + result.counts.shadow_rays) << name;
}

TEST_F(CountersOfRuns, AddUpForEveryProgramBufferingAndTiming) {
  for (const Program program : {Program::segments, Program::direct, Program::full})
    for (const int n : {0, 1, 3})
      for (const bool saves : {false, true})
        for (const auto timing : {model::TimingStyle::loosely_timed, model::TimingStyle::approximately_timed})
          for (const int bin_blocks : {3, 8}) {
            RenderOptions options = test_support::render_options(program, 24);
            options.program.n = n;
            options.program.buffer_saves = saves;
            options.program.bin_blocks = bin_blocks;
            options.timing = timing;
            expect_sums(on_chip(options), "program " + std::to_string(int(program)) + ", n " +
                                              std::to_string(n) + (saves ? ", both" : ", loads") +
                                              ", timing " + std::to_string(int(timing)));
          }
}

TEST_F(CountersOfRuns, NeitherBufferingNorTimingChangesPathLengthsAndLanes) {
  RenderOptions options = test_support::render_options(Program::full, 24);
  const ordered_json expected = statistics(options);
  for (const int n : {0, 2}) {
    options.program.n = n;
    options.timing = model::TimingStyle::approximately_timed;
    const ordered_json other = statistics(options);
    EXPECT_EQ(other["counts"], expected["counts"]);
    for (std::size_t i = 0; i < expected["chip"]["pe_array"]["kernels"].size(); ++i) {
      const ordered_json& kernel = expected["chip"]["pe_array"]["kernels"][i];
      for (const char* key : {"runs", "issued", "flops", "sram_bytes", "runs_by_enabled_pes"})
        EXPECT_EQ(other["chip"]["pe_array"]["kernels"][i][key], kernel[key]) << kernel["name"] << ' ' << key;
    }
  }
}

TEST(PassCounts, KeepEverySumInFewIntervals) {
  path_tracer::PassCounts counts;
  std::uint64_t sum = 0;
  for (std::uint64_t pass = 0; pass < 1000; ++pass) {
    counts.add(pass);
    sum += pass;
    ASSERT_LE(counts.intervals().size(), path_tracer::PassCounts::kMaxIntervals);
    std::uint64_t found = 0;
    for (const std::uint64_t interval : counts.intervals()) found += interval;
    ASSERT_EQ(found, sum);
  }
  EXPECT_EQ(counts.passes(), 1000u);
  EXPECT_EQ(counts.passes_per_interval(), 16u);
  EXPECT_EQ(counts.intervals().size(), 63u);
  EXPECT_EQ(counts.intervals()[1], 16u * 16 + 120);  // 16 + ... + 31
}

std::string refusal(const std::string& text) {
  try {
    testbench::parse_statistics(text, "run.json");
    return "";
  } catch (const testbench::InputError& error) {
    return error.what();
  }
}

TEST_F(CountersOfRuns, FilesThatAreNoStatisticsAreRefusedByName) {
  const std::string whole = testbench::statistics_json(statistics());
  EXPECT_EQ(refusal(whole), "");
  EXPECT_EQ(refusal(""), "run.json: found an empty file; allowed: a statistics file");
  EXPECT_EQ(refusal(" \n"), "run.json: found an empty file; allowed: a statistics file");
  EXPECT_EQ(refusal("[1, 2]"), "run.json: found no JSON object; allowed: a statistics file");
  for (const double share : {0.1, 0.5, 0.99}) {
    const std::string part = whole.substr(0, std::size_t(share * double(whole.size())));
    const auto lines = 1 + std::count(part.begin(), part.end(), '\n');
    EXPECT_EQ(refusal(part), "run.json:" + std::to_string(lines) +
                                 ": found no JSON object that is whole; allowed: a statistics file");
  }
  EXPECT_EQ(refusal("{}"),
            "run.json: format: found 'no format', allowed is 'csx600-statistics-2' or 'csx600-run-1'");
  ordered_json other = ordered_json::parse(whole);
  other["format"] = "csx600-statistics-9";
  EXPECT_EQ(
      refusal(other.dump()),
      "run.json: format: found 'csx600-statistics-9', allowed is 'csx600-statistics-2' or 'csx600-run-1'");
  other = ordered_json::parse(whole);
  other["chip"]["pio"].erase("setup_cycles");
  EXPECT_EQ(refusal(other.dump()),
            "run.json: chip.pio.setup_cycles: missing; allowed is a whole statistics file");
  other["chip"] = 7;
  EXPECT_NE(refusal(other.dump()).find("missing"), std::string::npos);
  other = ordered_json::parse(whole);
  other.erase("machine");
  EXPECT_EQ(refusal(other.dump()), "run.json: machine: missing; allowed is a whole statistics file");
}

}  // namespace counters_test
