#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <sstream>
#include <string>
#include <systemc>
#include <vector>

#include "testbench/commands/commands.hpp"
#include "testbench/commands/exit_codes.hpp"
#include "testbench/commands/usage_error.hpp"
#include "testbench/commands/version.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/standard_output.hpp"

namespace {

void add_commands(CLI::App& app) {
  testbench::add_render_command(app);
  testbench::add_run_command(app);
  testbench::add_reproduce_command(app);
  testbench::add_calibrate_command(app);
  testbench::add_params_command(app);
  testbench::add_scene_command(app);
  testbench::add_bench_command(app);
  testbench::add_validate_command(app);
  testbench::add_waves_command(app);
  testbench::add_sweep_command(app);
  testbench::add_inject_command(app);
  testbench::add_sensitivity_command(app);
  testbench::add_estimate_command(app);
  testbench::add_report_command(app);
  testbench::add_stats_command(app);
  testbench::add_compare_command(app);
  testbench::add_golden_command(app);
  testbench::add_completion_command(app);
  testbench::add_man_command(app);
}

/// Prints help or the version, which CLI11 throws.
void print(const CLI::App& app, const CLI::Success& wanted) {
  std::ostringstream text;
  app.exit(wanted, text, text);
  std::fputs(text.str().c_str(), stdout);
}

void parse_and_run(CLI::App& app, int argc, char** argv) {
  try {
    add_commands(app);
    app.parse(argc, argv);
  } catch (const CLI::Success& wanted) {
    print(app, wanted);
  } catch (const CLI::Error& error) {
    throw testbench::InputError(
        testbench::usage_error_text(app, error, std::vector<std::string>(argv + 1, argv + argc)));
  }
}

int run(int argc, char** argv) {
  CLI::App app("A SystemC model of the ClearSpeed CSX600 that runs a binned, n-buffered path tracer",
               "csx600");
  app.require_subcommand(1);
  app.set_version_flag("--version", testbench::version_text(), "Print the version and exit");
  try {
    parse_and_run(app, argc, argv);
    testbench::finish_standard_output();
  } catch (const testbench::InputError& error) {
    testbench::print_error(error.what());
    if (!error.details().empty()) std::fprintf(stderr, "%s\n", error.details().c_str());
    return testbench::kWrongInput.code;
  } catch (const std::bad_alloc&) {
    testbench::print_error(testbench::kOutOfMemory);
    return testbench::kRunFailed.code;
  } catch (const std::exception& error) {
    testbench::print_error(error.what());
    return testbench::kRunFailed.code;
  }
  return testbench::kDone.code;
}

}  // namespace

int sc_main(int argc, char** argv) {
  return run(argc, argv);
}

/// In place of the one in SystemC's library, which would print its banner into every run.
int main(int argc, char** argv) {
  testbench::prepare_standard_streams();
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 0);
  return sc_core::sc_elab_and_sim(argc, argv);
}
