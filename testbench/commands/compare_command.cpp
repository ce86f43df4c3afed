#include <cmath>
#include <cstdio>
#include <memory>

#include "testbench/commands/commands.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/renamed_keys.hpp"
#include "testbench/statistics/statistics_difference.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

struct CompareCommand {
  std::string a;
  std::string b;
  std::vector<std::string> tolerances;
  std::vector<std::string> ignore;
  bool with_simulator = false;

  void run() const;

 private:
  ComparisonRules rules() const;
};

Tolerance parse_tolerance(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
  std::size_t used = 0;
  double relative = -1;
  try {
    relative = std::stod(number, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (equals == 0 || used == 0 || used != number.size() || !(relative >= 0) || !std::isfinite(relative))
    throw InputError("--tolerance: found '" + text +
                     "', allowed is KEYGLOB=REL, for example chip.ddr.*=0.01");
  require_current_key("--tolerance", text.substr(0, equals));
  return {text.substr(0, equals), relative};
}

ComparisonRules CompareCommand::rules() const {
  ComparisonRules rules;
  for (const std::string& text : tolerances) rules.tolerances.push_back(parse_tolerance(text));
  for (const std::string& glob : ignore) require_current_key("--ignore", glob);
  rules.ignore = ignore;
  if (!with_simulator) rules.ignore.push_back(std::string(kSimulatorSection) + ".*");
  return rules;
}

void CompareCommand::run() const {
  const ComparisonRules by = rules();
  const FlatStatistics first = flatten(read_statistics(a));
  const Comparison comparison = compare(first, flatten(read_statistics(b)), by);
  std::fputs(difference_text(comparison.differences).c_str(), stdout);
  const std::string compared = std::to_string(comparison.compared);
  if (!comparison.differences.empty())
    throw RunError(a + " and " + b + " differ in " + std::to_string(comparison.differences.size()) + " of " +
                   compared + " values");
  std::printf("equal: %s values\n", compared.c_str());
}

}  // namespace

void add_compare_command(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("compare", "Compare the statistics of two runs; exit code 1 if they differ");
  const auto state = std::make_shared<CompareCommand>();
  command.add_option("a", state->a, "Statistics of a run")->type_name("FILE")->required();
  command.add_option("b", state->b, "Statistics of another")->type_name("FILE")->required();
  command
      .add_option("--tolerance", state->tolerances,
                  "Numbers under these keys may differ by so much; the last that matches counts")
      ->type_name("KEYGLOB=REL");
  command.add_option("--ignore", state->ignore, "Leave these keys out")->type_name("KEYGLOB");
  command.add_flag("--simulator", state->with_simulator, "Compare the simulator's times and memory, too");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
