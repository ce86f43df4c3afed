#include <cstdio>
#include <filesystem>
#include <memory>

#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/files/atomic_file.hpp"
#include "testbench/report/report_page.hpp"
#include "testbench/sweep/sweep_table.hpp"

namespace testbench {
namespace {

struct ReportCommand {
  std::string input;
  std::string image;
  std::string output = "report.html";

  void run() const {
    require_outputs_apart({{"--output", output}}, inputs());
    require_writable(output);
    write_bytes_atomically(output, report_page(input, image));
    std::printf("%s: one page that opens offline\n", output.c_str());
  }

 private:
  /// The page is of sweep.json alone, but the other files are results as well.
  std::vector<InputName> inputs() const {
    std::vector<InputName> files = {{"the input", input}, {"--image", image}};
    for (const char* const name : kSweepFiles)
      files.emplace_back("the sweep", (std::filesystem::path(input) / name).string());
    return files;
  }
};

}  // namespace

void add_report_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("report", "Show a run or a sweep as one page for a browser");
  const auto state = std::make_shared<ReportCommand>();
  command.add_option("input", state->input, "Statistics file of a run, or directory of a sweep")
      ->type_name("FILE")
      ->required();
  command.add_option("--image", state->image, "PNG of the run to show")->type_name("FILE");
  command.add_option("-o,--output", state->output, "HTML file to write")
      ->check(error_of_no_file, "")
      ->type_name("FILE")
      ->capture_default_str();
  command.callback([state] { state->run(); });
}

}  // namespace testbench
