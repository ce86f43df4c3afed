// csx600 report: pages that hold all they show. Where Chromium is installed, it opens them.

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <regex>

#include "tests/support/command_line.hpp"

namespace report_command_test {

using test_support::CommandResult;
using Words = std::vector<std::string>;

const std::string kScene = CSX600_SCENES_DIR "/cornell_box";

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

class ReportCommand : public test_support::CommandLineFixture {
 protected:
  void make_run() {
    ASSERT_EQ(run({"render", kScene, "--size", "16x16", "--samples", "2", "--stats", "run.json", "--png",
                   "run.png"})
                  .exit_code,
              0);
  }
  void make_sweep(const std::string& axes) {
    write("s.toml", "scene = \"" + kScene + "\"\nsize = \"8x6\"\nsamples = 1\n" + axes);
    run({"sweep", "s.toml", "-o", "out"});
  }
  std::string page(const Words& arguments) {
    Words all = {"report", "-o", "page.html"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult result = run(all);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    const std::string text = read("page.html");
    EXPECT_EQ(count(text, "<script src"), 0u);
    EXPECT_EQ(count(text, "<link"), 0u);
    return text;
  }
  /// The page's elements after its scripts have run; "" without Chromium.
  std::string opened(const std::string& window) {
    if (std::string(CHROMIUM).empty()) return "";
    const std::string command =
        std::string(CHROMIUM) +
        " --headless --no-sandbox --disable-gpu --user-data-dir=" + directory().string() +
        ".chromium --window-size=" + window + " --enable-logging=stderr --dump-dom file://" +
        directory().string() + "/page.html 2>" + directory().string() + ".log";
    std::string text;
    std::FILE* const pipe = popen(command.c_str(), "r");
    std::array<char, 65536> buffer;
    for (std::size_t got = 0; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
      text.append(buffer.data(), got);
    EXPECT_EQ(pclose(pipe), 0);
    EXPECT_EQ(std::system(("! grep CONSOLE " + directory().string() + ".log").c_str()), 0)
        << "console errors";
    std::filesystem::remove(directory().string() + ".log");
    std::filesystem::remove_all(directory().string() + ".chromium");
    return text;
  }
  static int charts(const std::string& elements) {
    std::smatch match;
    EXPECT_EQ(elements.find("data-error"), std::string::npos);
    return std::regex_search(elements, match, std::regex("<body[^>]* data-charts=\"([0-9]+)\""))
               ? std::stoi(match[1])
               : -1;
  }
  void expect_error(const Words& arguments, const Words& parts) {
    Words all = {"report"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult result = run(all);
    EXPECT_EQ(result.exit_code, 2);
    ASSERT_EQ(result.error_lines().size(), 1u) << result.error;
    for (const std::string& part : parts)
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in: " << result.error;
  }
};

TEST_F(ReportCommand, OfARunShowsImageCyclesKernelsAndRoofline) {
  make_run();
  const std::string text = page({"run.json", "--image", "run.png"});
  EXPECT_NE(text.find("data:image/png;base64,iVBORw0KGgo"), std::string::npos);
  for (const char* const window : {"1280,900", "500,900"}) {
    const std::string elements = opened(window);
    if (elements.empty()) GTEST_SKIP() << "no Chromium";
    const int drawn = charts(elements);
    EXPECT_GE(drawn, 3);
    EXPECT_EQ(count(elements, "<svg"), std::size_t(drawn));
    for (const char* const part : {"Where the cycles went", "Kernels", "Roofline", "<img", "intersect"})
      EXPECT_NE(elements.find(part), std::string::npos) << part;
  }
}

TEST_F(ReportCommand, OfASweepShowsItsAxesAndTheParetoFront) {
  make_sweep(
      "[[axis]]\nfirmware.n = [0, 1]\n[[axis]]\nchip.pes = [32, 64]\n[[axis]]\npio.setup_cycles = [50, "
      "500]\n");
  page({"out"});
  const std::string elements = opened("1280,900");
  if (elements.empty()) GTEST_SKIP() << "no Chromium";
  EXPECT_EQ(charts(elements), 2);
  EXPECT_EQ(count(elements, "<svg"), 2u);
  for (const char* const part : {"Over the axes", "Pareto front", "All points", "a line for each"})
    EXPECT_NE(elements.find(part), std::string::npos) << part;
}

TEST_F(ReportCommand, OfASweepWithFailuresAndWordsForValuesOpensToo) {
  make_sweep(
      "[[axis]]\nfirmware.program = [\"segments\", \"full\"]\n[[axis]]\npoly.sram_bytes = [2048, 6144]\n");
  page({"out/sweep.json"});
  const std::string elements = opened("1280,900");
  if (elements.empty()) GTEST_SKIP() << "no Chromium";
  EXPECT_GE(charts(elements), 1);
  EXPECT_NE(elements.find("poly SRAM overflow"), std::string::npos);
}

TEST_F(ReportCommand, OfANativeRunOpensToo) {
  run({"render", kScene, "--size", "8x6", "--native", "--stats", "run.json"});
  page({"run.json"});
  const std::string elements = opened("1280,900");
  if (elements.empty()) GTEST_SKIP() << "no Chromium";
  EXPECT_EQ(charts(elements), 0);
}

TEST_F(ReportCommand, TextOfTheInputStaysText) {
  make_run();
  std::string json = read("run.json");
  json.replace(json.find(kScene), kScene.size(), "</script><b id='broken'>");
  write("run.json", json);
  EXPECT_EQ(page({"run.json"}).find("</script><b"), std::string::npos);
}

TEST_F(ReportCommand, BadInput) {
  expect_error({"none.json"}, {"none.json", "cannot be read"});
  write("x.json", "hello");
  expect_error({"x.json"}, {"x.json", "no JSON"});
  write("x.json", "{\"format\": \"csx600-statistics-0\"}");
  expect_error({"x.json"}, {"x.json", "'csx600-statistics-0'", "csx600-statistics-2", "csx600-sweep-1"});
  write("x.json", "{\"format\": \"csx600-statistics-2\"}");
  expect_error({"x.json"}, {"x.json", "scene"});
  write("out/sweep.json",
        "{\"format\": \"csx600-sweep-1\", \"keys\": [], \"axes\": [], \"base\": {}, \"points\": "
        "[{\"inputs\": {}, "
        "\"status\": \"done\", \"results\": {\"chip.host_link.host_dmas\": 3}}]}");
  expect_error({"out"}, {"out/sweep.json", "chip.host_link.host_dmas", "chip.host_link.transfers"});
  make_run();
  write("no.png", "hello");
  expect_error({"run.json", "--image", "no.png"}, {"--image", "no.png", "PNG"});
  expect_error({"run.json", "-o", "none/page.html"}, {"none/page.html"});
  EXPECT_EQ(std::filesystem::exists(directory() / "report.html"), false);
}

}  // namespace report_command_test
