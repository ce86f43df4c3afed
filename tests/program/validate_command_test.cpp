// `csx600 validate` as its users start it.

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "firmware/cn/simd/level.hpp"
#include "tests/support/command_line.hpp"

namespace validate_command_test {

using nlohmann::json;
using test_support::CommandResult;

class ValidateCommand : public test_support::CommandLineFixture {
 protected:
  /// The model's figures by what they are.
  std::map<std::string, double> figures(std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.begin(), {"validate", "--json", "v.json"});
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    std::map<std::string, double> by_name;
    const json all = json::parse(read("v.json"));
    for (const json& figure : all.at("figures")) by_name[figure.at("what")] = figure.at("model");
    return by_name;
  }
};

TEST_F(ValidateCommand, PrintsTablesAndWritesBothFiles) {
  const CommandResult result = run({"validate", "--json", "v.json", "--csv", "v.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(result.error, "");
  for (const char* what :
       {"DGEMM", "Monte Carlo", "2-D FFT", "Himeno", "Where the cycles went", "offset in packet"})
    EXPECT_NE(result.out.find(what), std::string::npos) << what;
  const json all = json::parse(read("v.json"));
  EXPECT_EQ(all.at("figures").size(), 7u);
  for (const json& run_of : all.at("runs")) {
    double percent = 0;
    for (const auto& [cause, of_cause] : run_of.at("percent_of_cycles").items())
      percent += of_cause.get<double>();
    EXPECT_NEAR(percent, 100, 1e-9) << run_of.at("run");
  }
  const std::string csv = read("v.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 8);
}

TEST_F(ValidateCommand, SameFiguresWhateverTheLevelAndTheNumberOfJobs) {
  EXPECT_EQ(run({"validate", "--jobs", "1", "--level", cn::name_of(cn::narrowest_level())}).out,
            run({"validate", "--jobs", "4"}).out);
}

/// Figures that follow from costs by hand.
TEST_F(ValidateCommand, FiguresAreThoseOfTheCosts) {
  const std::map<std::string, double> found = figures();
  // 80 bytes for 96 PEs: 20 for the call, 150 + 96 x 26 cycles, and some to request and wait.
  EXPECT_NEAR(found.at("PIO, 80 B a PE"), 96 * 80 / 2666.0 * 0.21, 0.006);
  // A sample: half of (2 random numbers of 40, 2 conversions of 12, log 90, -2 x 4, sqrt 50, 2 pi x 4,
  // sine and cosine 110, 2 products of 4), then 2 x 4 + exp 90 + 4 + 4, maximum 6, sum 4.
  EXPECT_NEAR(found.at("Monte Carlo, European option"), (80 + 24 + 90 + 4 + 50 + 4 + 110 + 8) / 2.0 + 116, 1);
  // A tile takes 64 rows of B; 88 of 96 PEs do 8 multiply-adds a row; a row takes 12.25 cycles, the end 26.
  // For a row, programmed I/O moves 160 + 2 x 88 words in the time of 40 tiles, in the way of SRAM accesses
  // of 5 cycles a row and 48 a tile. Control and the ends of blocks come on top.
  const double tile = 12.25 * 64 + 26;
  const double kernel = 8 * 64 / tile * 88 / 96;
  const double stolen = (160 + 2 * 88) / (40 * tile / 64) * (5 * 64 + 48) / tile;
  for (const auto& [figure, peak] :
       {std::pair("DGEMM, early library", 48.0), {"DGEMM, later library", 40.32}}) {
    EXPECT_LT(found.at(figure), peak * kernel / (1 + stolen));
    EXPECT_GT(found.at(figure), 0.95 * peak * kernel / (1 + stolen));
  }
}

TEST_F(ValidateCommand, ParametersCanBeChanged) {
  const std::map<std::string, double> plain = figures();
  const std::map<std::string, double> free = figures({"--set", "poly.cycles.fp64_exp=0"});
  EXPECT_NEAR(plain.at("Monte Carlo, European option") - free.at("Monte Carlo, European option"), 90, 0.1);
  EXPECT_EQ(plain.at("DGEMM, early library"), free.at("DGEMM, early library"));
  const std::map<std::string, double> slow_pio = figures({"--set", "pio.per_pe_cycles=300"});
  EXPECT_LT(slow_pio.at("2-D FFT 512 x 512, single precision"),
            0.8 * plain.at("2-D FFT 512 x 512, single precision"));
}

TEST_F(ValidateCommand, WrongInputIsOneLineAndLeavesNothing) {
  const std::vector<std::vector<std::string>> wrong = {{"--set", "pio.setup"},
                                                       {"--set", "pio.setup_cycle=1"},
                                                       {"--csv", "no/such/directory/v.csv"},
                                                       {"--json", "no/such/v.json"},
                                                       {"--set", "poly.sram_bytes=4096"},
                                                       {"--set", "ddr.size_bytes=1048576"},
                                                       {"--set", "chip.pes=48"},
                                                       {"--level", "v9"},
                                                       {"--jobs", "0"}};
  for (std::vector<std::string> arguments : wrong) {
    const std::string argument = arguments[1];
    arguments.insert(arguments.begin(), "validate");
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << argument;
    EXPECT_EQ(result.error_lines().size(), 1u) << result.error;
    EXPECT_EQ(files().size(), 0u) << argument;
  }
}

}  // namespace validate_command_test
