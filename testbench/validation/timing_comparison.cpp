#include "testbench/validation/timing_comparison.hpp"

#include "model/config/chip_parameters.hpp"

namespace testbench {
namespace {

using path_tracer::Program;

struct Sweep {
  const char* key;
  std::vector<const char*> values;
};

/// The alternatives that the parameter table suggests, if any; else from a quarter to four times the default
/// and beyond.
const std::vector<Sweep>& sweeps() {
  static const std::vector<Sweep> all = {{"pio.per_pe_cycles", {"0", "4", "30", "60"}},
                                         {"ddr.page_miss_cycles", {"20", "120", "400"}},
                                         {"clear_connect.bytes_per_cycle", {"1", "2", "4", "16"}},
                                         {"chip.pes", {"16", "32", "192", "256"}}};
  return all;
}

}  // namespace

std::vector<TimingPoint> timing_points(const RenderOptions& base) {
  std::vector<TimingPoint> points;
  constexpr std::pair<Program, const char*> kPrograms[] = {
      {Program::segments, "segments"}, {Program::direct, "direct"}, {Program::full, "full"}};
  for (const auto& [program, name] : kPrograms) {
    for (const int n : {0, 1, 2}) {
      TimingPoint point{std::string(name) + ", n = " + std::to_string(n), base};
      point.options.program.program = program;
      point.options.program.n = n;
      points.push_back(point);
    }
  }
  for (const Sweep& sweep : sweeps()) {
    for (const char* value : sweep.values) {
      TimingPoint point{std::string(sweep.key) + " = " + value, base};
      point.options.program.program = Program::full;
      point.options.program.n = 1;
      model::set_parameter(point.options.chip, sweep.key, value, "timing_points");
      points.push_back(point);
    }
  }
  return points;
}

}  // namespace testbench
