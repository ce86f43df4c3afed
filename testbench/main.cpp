#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <systemc>

#include "testbench/commands/commands.hpp"
#include "testbench/commands/exit_codes.hpp"
#include "testbench/commands/version.hpp"
#include "testbench/system/error.hpp"

namespace {

void add_commands(CLI::App& app) {
  testbench::add_render_command(app);
  testbench::add_reproduce_command(app);
  testbench::add_calibrate_command(app);
  testbench::add_params_command(app);
  testbench::add_scene_command(app);
  testbench::add_bench_command(app);
  testbench::add_validate_command(app);
  testbench::add_waves_command(app);
  testbench::add_sweep_command(app);
  testbench::add_report_command(app);
  testbench::add_stats_command(app);
  testbench::add_compare_command(app);
  testbench::add_golden_command(app);
  testbench::add_completion_command(app);
  testbench::add_man_command(app);
}

int run(int argc, char** argv) {
  CLI::App app("A SystemC model of the ClearSpeed CSX600 that runs a binned, n-buffered path tracer",
               "csx600");
  app.require_subcommand(1);
  app.set_version_flag("--version", testbench::version_text(), "Print the version and exit");
  try {
    add_commands(app);
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::Error& error) {
    std::fprintf(stderr, "csx600: %s (see csx600 --help)\n", error.what());
    return testbench::kWrongInput.code;
  } catch (const testbench::InputError& error) {
    std::fprintf(stderr, "csx600: %s\n", error.what());
    return testbench::kWrongInput.code;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "csx600: %s\n", testbench::kOutOfMemory);
    return testbench::kRunFailed.code;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "csx600: %s\n", error.what());
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
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 0);
  return sc_core::sc_elab_and_sim(argc, argv);
}
