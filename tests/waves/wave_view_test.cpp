#include "model/waves/wave_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "tests/support/test_chip.hpp"

namespace wave_view_test {

using model::ViewOptions;
using model::WaveSignal;

ViewOptions options() {
  ViewOptions view;
  view.view_file = "run.gtkw";
  view.wave_file = "run.vcd";
  view.signals = model::wave_instances(test_support::test_chip());
  view.first_picoseconds = 5'000'000;
  view.span_picoseconds = 1'000'000;
  view.filter_files = {{WaveSignal::control_state, "run.state.txt"},
                       {WaveSignal::control_kernel, "run.kernels.txt"}};
  return view;
}

std::vector<std::string> lines_of(const ViewOptions& view) {
  std::stringstream text;
  model::write_wave_view(text, view);
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// The names that the view takes from the trace file.
std::vector<std::string> signals_of(const std::vector<std::string>& lines) {
  std::vector<std::string> names;
  for (const std::string& line : lines)
    if (line.rfind("+{", 0) == 0) names.push_back(line.substr(line.find("} ") + 2));
  return names;
}

TEST(WaveSignals, TableIsInTheOrderOfItsIdsAndNamesAreUnique) {
  const auto& table = model::wave_signal_table();
  ASSERT_EQ(table.size(), std::size_t(model::kWaveSignals));
  std::set<std::string> paths;
  std::vector<std::string_view> scopes;
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_EQ(std::size_t(table[i].id), i);
    EXPECT_TRUE(paths.insert(table[i].path()).second) << table[i].path();
    EXPECT_FALSE(table[i].meaning.empty()) << table[i].path();
    if (scopes.empty() || scopes.back() != table[i].scope) scopes.push_back(table[i].scope);
  }
  EXPECT_EQ(std::set<std::string_view>(scopes.begin(), scopes.end()).size(), scopes.size())
      << "signals of a scope follow each other";
}

TEST(WaveSignals, NamedValuesFitTheirSignals) {
  for (const auto& signal : model::wave_signal_table())
    for (const auto& value : signal.fixed_names)
      EXPECT_TRUE(signal.width == 64 || value.value >> signal.width == 0)
          << signal.path() << " " << value.name;
}

TEST(WaveSignals, TableOfTheReadmeIsTheGeneratedOne) {
  const std::string file = CSX600_SOURCE_DIR "/waves/README.md";
  std::ifstream in(file);
  ASSERT_TRUE(in) << file;
  std::string table;
  bool in_section = false;  // of the signals; there are other tables
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("## ", 0) == 0) in_section = line == "## Signals";
    if (in_section && !line.empty() && line[0] == '|') table += line + "\n";
  }
  EXPECT_EQ(table, model::wave_signal_markdown());
}

TEST(WaveView, ShowsEverySignalOnceUnderItsNameInTheFile) {
  const std::vector<std::string> names = signals_of(lines_of(options()));
  std::vector<std::string> expected;
  for (const auto& signal : options().signals)
    expected.push_back("csx600." + signal.path +
                       (signal.info->width == 1 ? "" : "[" + std::to_string(signal.info->width - 1) + ":0]"));
  EXPECT_EQ(names, expected);
}

TEST(WaveView, GroupsAreClosedInTheOrderTheyWereOpened) {
  const std::vector<std::string> lines = lines_of(options());
  std::vector<std::string> opened;
  std::string open;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] == "@800200") {
      EXPECT_EQ(open, "");
      open = lines.at(i + 1);
      opened.push_back(open);
    } else if (lines[i] == "@1000200") {
      EXPECT_EQ(lines.at(i + 1), open);
      open.clear();
    }
  }
  EXPECT_EQ(open, "");
  EXPECT_EQ(opened, (std::vector<std::string>{"-bins", "-control unit", "-PE array", "-programmed I/O",
                                              "-ClearConnect", "-DDR", "-on-chip SRAM", "-host link"}));
}

TEST(WaveView, FiltersStandBeforeTheirSignals) {
  const std::vector<std::string> lines = lines_of(options());
  const auto kernel = std::find(lines.begin(), lines.end(), "+{kernel} csx600.control.kernel[15:0]");
  ASSERT_NE(kernel, lines.end());
  EXPECT_EQ(*(kernel - 1), "^2 run.kernels.txt");
  EXPECT_EQ(*(kernel - 3), "@2024") << "right-justified decimal through a file filter";
  const auto semaphore = std::find(lines.begin(), lines.end(), "+{semaphore} csx600.control.semaphore[7:0]");
  ASSERT_NE(semaphore, lines.end());
  EXPECT_EQ(*(semaphore - 2), "@24") << "no filter was given";
}

TEST(WaveView, OpensAtTheGivenTime) {
  const std::vector<std::string> lines = lines_of(options());
  EXPECT_NE(std::find(lines.begin(), lines.end(), "[timestart] 5000000"), lines.end());
  ViewOptions twice = options();
  twice.span_picoseconds *= 2;
  const auto zoom = [](const ViewOptions& view) {
    for (const std::string& line : lines_of(view))
      if (line[0] == '*') return std::stod(line.substr(1));
    return 0.0;
  };
  EXPECT_NEAR(zoom(options()) - zoom(twice), 1.0, 1e-4) << "a step of one zooms by two";
}

TEST(WaveView, NamesNoDirectory) {
  for (const std::string& line : lines_of(options()))
    EXPECT_TRUE(line.find('/') == std::string::npos || line == "-programmed I/O") << line;
  for (const char* const name : {"/tmp/run.vcd", ""}) {
    ViewOptions view = options();
    view.wave_file = name;
    EXPECT_THROW(lines_of(view), std::invalid_argument) << name;
    view = options();
    view.filter_files[0].second = name;
    EXPECT_THROW(lines_of(view), std::invalid_argument) << name;
    view = options();
    view.view_file = name;
    EXPECT_THROW(lines_of(view), std::invalid_argument) << name;
  }
}

TEST(WaveView, EmptySpanIsRefused) {
  ViewOptions view = options();
  view.span_picoseconds = 0;
  EXPECT_THROW(lines_of(view), std::invalid_argument);
}

TEST(ValueFilter, OneLineAValue) {
  std::stringstream text;
  model::write_value_filter(text, {{0, "idle"}, {255, "none"}});
  EXPECT_EQ(text.str(), "0 idle\n255 none\n");
}

}  // namespace wave_view_test
