#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/path_tracer/program/run_counts.hpp"
#include "model/pe_array/pe_array.hpp"

namespace testbench {

struct ChipStatistics;
struct RenderResult;

/// What counters count in. "-" is a ratio, "count" a number of what the name says.
inline constexpr std::array<std::string_view, 12> kCounterUnits = {
    "-", "count", "cycles", "s", "Hz", "bytes", "bytes/s", "flop/s", "flop/byte", "J", "W", "mm2"};

enum class CounterKind : std::uint8_t {
  counted,  ///< by the chip, the firmware or the simulator
  derived,  ///< from others and from the chip's parameters
  told,     ///< a sentence about them for people, which no comparison looks at
};

/// The section of what the simulator took: time and memory of this process. It differs from run to run.
inline constexpr const char* kSimulatorSection = "simulator";

/// One counter of a run. JSON, CSV and text take name, unit and meaning from here and from nowhere else.
struct Counter {
  std::string key;  ///< the path in the statistics file, joined by dots; "*" stands for any name
  std::string unit;
  std::string meaning;
  CounterKind kind = CounterKind::counted;
};

/// A counter and where its value comes from. The value of a key that ends in ".*" is an object.
template <class Source>
struct CounterOf {
  Counter counter;  ///< its key begins at the source
  nlohmann::ordered_json (*read)(const Source&);
};
template <class Source>
using Counters = std::vector<CounterOf<Source>>;

/// A kernel and the width of the array that it ran on.
struct KernelOnArray {
  const model::KernelStatistics& kernel;
  int num_pes;
};

/// What a firmware outside this tree says it did, and the chip that it did it on; nullptr for a native run.
struct WorkDone {
  double amount;
  std::string unit;
  const ChipStatistics* chip;
};

const Counters<RenderResult>& run_counters();                 ///< keys begin at the file's root
const Counters<path_tracer::RunCounts>& firmware_counters();  ///< "counts."
const Counters<ChipStatistics>& chip_counters();              ///< "chip."
const Counters<KernelOnArray>& kernel_counters();             ///< "chip.pe_array.kernels.*."
const Counters<WorkDone>& work_counters();                    ///< "work.", in statistics of `csx600 run` only

/// Every declaration of a render's, with whole keys, in the order of the file.
const std::vector<Counter>& all_counters();
/// The declarations that only a run of a firmware outside this tree has.
const std::vector<Counter>& all_work_counters();
/// The declaration of a value in the statistics file; nullptr if it has none (what the run was asked to do).
/// Each chip of a board has the counters of "chip.": "chips.csx600_1.ddr.page_hits" is "chip.ddr.page_hits".
const Counter* find_counter(std::string_view key);

/// Name, unit and meaning of every counter.
std::string describe_counters();

/// Puts the values where their keys say.
template <class Source>
void write_counters(const Counters<Source>& counters, const Source& source, nlohmann::ordered_json& json) {
  for (const CounterOf<Source>& counter : counters) {
    std::string path = counter.counter.key;
    if (path.size() > 1 && path.substr(path.size() - 2) == ".*") path.resize(path.size() - 2);
    for (char& c : path)
      if (c == '.') c = '/';
    json[nlohmann::ordered_json::json_pointer("/" + path)] = counter.read(source);
  }
}

}  // namespace testbench
