#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <systemc>

#include "testbench/commands/commands.hpp"
#include "testbench/system/error.hpp"

namespace {

constexpr int kRunFailed = 1;
constexpr int kWrongInput = 2;

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
}

int run(int argc, char** argv) {
  CLI::App app("A SystemC model of the ClearSpeed CSX600 that runs a binned, n-buffered path tracer",
               "csx600");
  app.require_subcommand(1);
  try {
    add_commands(app);
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::Error& error) {
    std::fprintf(stderr, "csx600: %s (see csx600 --help)\n", error.what());
    return kWrongInput;
  } catch (const testbench::InputError& error) {
    std::fprintf(stderr, "csx600: %s\n", error.what());
    return kWrongInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "csx600: %s\n", error.what());
    return kRunFailed;
  }
  return 0;
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
