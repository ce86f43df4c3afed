#include <cmath>
#include <cstdio>
#include <memory>

#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/statistics/renamed_keys.hpp"
#include "testbench/statistics/statistics_difference.hpp"
#include "testbench/statistics/test_report.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

struct CompareCommand {
  std::string a;
  std::string b;
  std::vector<std::string> tolerances;
  std::vector<std::string> absolute;
  std::vector<std::string> ignore;
  bool with_simulator = false;
  OutputFiles outputs;

  void run() const;

 private:
  ComparisonRules rules() const;
  nlohmann::ordered_json json_of(const Comparison& comparison) const;
};

struct KeyAndNumber {
  std::string glob;
  double number;
};

/// The value of `option`, which is a pattern of keys, "=" and a number of 0 or more.
KeyAndNumber key_and_number(const std::string& option, const std::string& text, const std::string& form) {
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
    throw InputError(option + ": found '" + text + "', allowed is " + form);
  require_current_key(option, text.substr(0, equals));
  return {text.substr(0, equals), relative};
}

ComparisonRules CompareCommand::rules() const {
  ComparisonRules rules;
  for (const std::string& text : tolerances) {
    const auto [glob, number] =
        key_and_number("--tolerance", text, "KEYGLOB=REL, for example chip.ddr.*=0.01");
    rules.tolerances.push_back({glob, number});
  }
  for (const std::string& text : absolute) {
    const auto [glob, number] =
        key_and_number("--absolute", text, "KEYGLOB=DISTANCE, for example chip.ddr.page_hits=10");
    rules.absolute.push_back({glob, number});
  }
  for (const std::string& glob : ignore) require_current_key("--ignore", glob);
  rules.ignore = ignore;
  if (!with_simulator) rules.ignore.push_back(std::string(kSimulatorSection) + ".*");
  return rules;
}

nlohmann::ordered_json CompareCommand::json_of(const Comparison& comparison) const {
  return {{"a", a},
          {"b", b},
          {"compared", comparison.keys.size()},
          {"differences", differences_json(comparison.differences)}};
}

void CompareCommand::run() const {
  const ComparisonRules by = rules();
  outputs.require_writable();
  outputs.require_no_input({{"the first run", a}, {"the second run", b}});
  const FlatStatistics first = flatten(read_statistics(a));
  const Comparison comparison = compare(first, flatten(read_statistics(b)), by);
  std::fputs(difference_text(comparison.differences).c_str(), stdout);
  if (comparison.keys.empty())
    throw InputError("--ignore: found that it leaves no value to compare, allowed are keys that leave one");
  outputs.write("--junit", [&] { return junit_xml(a + " against " + b, cases_of(comparison)); });
  outputs.write("--json", [&] { return json_text(json_of(comparison), 1) + "\n"; });
  const std::string compared = std::to_string(comparison.keys.size());
  if (!comparison.differences.empty())
    throw RunError(a + " and " + b + " differ in " + std::to_string(comparison.differences.size()) + " of " +
                   compared + " values");
  std::printf("equal: %s values\n", compared.c_str());
}

}  // namespace

void add_compare_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("compare",
                                          "Compare the statistics of two runs; exit code 1 if they differ. "
                                          "Of a scene's path, the last name counts");
  const auto state = std::make_shared<CompareCommand>();
  command.add_option("a", state->a, "Statistics of a run")->type_name("FILE")->required();
  command.add_option("b", state->b, "Statistics of another")->type_name("FILE")->required();
  command
      .add_option("--tolerance", state->tolerances,
                  "Numbers under these keys may differ by so much; the last that matches counts")
      ->type_name("KEYGLOB=REL");
  command
      .add_option("--absolute", state->absolute,
                  "Or by so much in the key's own unit; the last that matches counts")
      ->type_name("KEYGLOB=DISTANCE");
  command.add_option("--ignore", state->ignore, "Leave these keys out")->type_name("KEYGLOB");
  command.add_flag("--simulator", state->with_simulator, "Compare the simulator's times and memory, too");
  state->outputs.add_to(command, "--junit", "Every value as a case of a JUnit test suite");
  state->outputs.add_to(command, "--json", "The values that differ");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
