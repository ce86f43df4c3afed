#include "testbench/validation/validation.hpp"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "firmware/examples/fft.hpp"
#include "firmware/examples/firmwares.hpp"
#include "firmware/examples/pio_sweep.hpp"
#include "model/csx600.hpp"
#include "model/time/run_until_idle.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/validation/example_runs.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using examples::PioSweep;

constexpr const char* kShipped = "csx600";
constexpr const char* kDesign = "csx600_250mhz";

/// A chip with filled mono memory whose firmware starts at cycle 0, since no published figure includes the
/// host.
class BareChip {
 public:
  BareChip(const model::ChipConfig& config, const std::vector<std::uint8_t>& mono,
           const std::vector<std::uint8_t>& scratchpad = {})
      : chip_("csx600", config) {
    if (mono.size() > config.ddr.size_bytes)
      throw InputError("validation needs " + std::to_string(mono.size()) +
                       " bytes of mono memory, ddr.size_bytes allows " +
                       std::to_string(config.ddr.size_bytes));
    std::memcpy(this->mono(), mono.data(), mono.size());
    if (!scratchpad.empty())
      std::memcpy(chip_.on_chip_sram->memory().data(), scratchpad.data(), scratchpad.size());
  }

  void run(const std::function<void(cn::Machine&)>& firmware) {
    chip_.control_unit.load(firmware);
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
    chip_.control_unit.start();
    model::run_until_idle();
    try {
      chip_.control_unit.rethrow_failure();
    } catch (const cn::PolyMemoryOverflow& error) {
      throw InputError(error.what());
    } catch (const cn::MachineFault& fault) {
      throw RunError(fault.what());
    }
  }

  std::uint8_t* mono() { return chip_.mono_ddr->memory().data(); }
  model::Cycles now() const { return chip_.control_unit.now(); }
  const model::ControlStatistics& statistics() const { return chip_.control_unit.statistics(); }

 private:
  model::Csx600 chip_;
};

/// The result of a run as JSON: cycles by cause, and the work done.
std::string run_example(const model::ChipConfig& config, const ExampleRun& run) {
  BareChip chip(config, run.mono, run.scratchpad);
  chip.run(run.firmware);
  run.check(chip.mono());
  Json json;
  json["work"] = run.work;
  json["cycles"] = chip.statistics().total();
  json["pes"] = config.chip.pes;
  json["clock_hz"] = config.chip.clock_hz;
  for (int cause = 0; cause < model::kCycleCauses; ++cause)
    json["by_cause"][model::cycle_cause_name(model::CycleCause(cause))] =
        chip.statistics().cycles[std::size_t(cause)];
  return json.dump();
}

constexpr int kSweepPes[] = {1, 8, 32, 96};
constexpr int kSweepBytes[] = {8, 32, 80, 256, 1024, 4096};
constexpr int kSweepOffsets[] = {0, 56};
constexpr int kSweepRepeats = 16;

/// Bytes per cycle of `repeats` transfers that took `cycles`.
double rate(const PioSweep::Pattern& pattern, int repeats, model::Cycles cycles) {
  return double(pattern.pes) * pattern.bytes * repeats / double(cycles);
}

class SweepRun {
 public:
  explicit SweepRun(const model::ChipConfig& config) : config_(config), chip_(config, source()) {}

  std::string run() {
    chip_.run([this](cn::Machine& machine) {
      PioSweep sweep(machine, *std::max_element(std::begin(kSweepBytes), std::end(kSweepBytes)));
      for (const int pes : kSweepPes)
        for (const int bytes : kSweepBytes)
          for (const int offset : kSweepOffsets)
            if (pes <= machine.num_pes()) measure(sweep, pes, bytes, offset);
    });
    return points_.dump();
  }

 private:
  static constexpr std::uint64_t kCopy = std::uint64_t{4} << 20;

  static std::vector<std::uint8_t> source() {
    std::vector<std::uint8_t> bytes(kCopy);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(i * 167 + (i >> 8) * 13 + 1);
    return bytes;
  }

  void measure(PioSweep& sweep, int pes, int bytes, int offset) {
    // Pieces lie apart, each at the same offset within a packet.
    PioSweep::Pattern pattern{pes, bytes, std::uint64_t(offset), std::uint64_t(bytes / 64 + 2) * 64};
    const model::Cycles start = chip_.now();
    sweep.load(pattern, kSweepRepeats);
    const model::Cycles loaded = chip_.now();
    pattern.address += kCopy;
    sweep.save(pattern, kSweepRepeats);
    const model::Cycles saved = chip_.now();
    check(pattern);
    points_.push_back({{"pes", pes},
                       {"bytes", bytes},
                       {"offset", offset},
                       {"load", rate(pattern, kSweepRepeats, loaded - start) * config_.chip.clock_hz},
                       {"save", rate(pattern, kSweepRepeats, saved - loaded) * config_.chip.clock_hz}});
  }

  void check(const PioSweep::Pattern& pattern) {
    for (int pe = 0; pe < pattern.pes; ++pe) {
      std::uint8_t* const copy = chip_.mono() + pattern.address + std::uint64_t(pe) * pattern.stride_bytes;
      if (std::memcmp(copy, copy - kCopy, std::size_t(pattern.bytes)) != 0)
        throw RunError("PIO sweep: the piece of PE " + std::to_string(pe) + " of " +
                       std::to_string(pattern.bytes) + " bytes came back changed");
      std::memset(copy, 0, std::size_t(pattern.bytes));
    }
  }

  model::ChipConfig config_;
  BareChip chip_;
  Json points_ = Json::array();
};

std::vector<TransferPoint> transfers(const Json& points) {
  std::vector<TransferPoint> transfers;
  for (const Json& point : points)
    transfers.push_back(
        {point.at("pes"), point.at("bytes"), point.at("offset"), point.at("load"), point.at("save")});
  return transfers;
}

const TransferPoint& transfer(const std::vector<TransferPoint>& points, int bytes, int offset) {
  const auto is_it = [&](const TransferPoint& point) {
    return point.bytes_per_pe == bytes && point.packet_offset_bytes == offset;
  };
  // Points with the most PEs come last.
  const auto found = std::find_if(points.rbegin(), points.rend(), is_it);
  if (found == points.rend()) throw RunError("PIO sweep has no point of " + std::to_string(bytes) + " bytes");
  return *found;
}

CycleShares shares(const std::string& run, const std::string& chip, const Json& result) {
  CycleShares shares{run, chip, {}};
  for (const auto& [cause, cycles] : result.at("by_cause").items()) {
    const double percent = 100 * cycles.get<double>() / result.at("cycles").get<double>();
    if (percent > 0) shares.percent.emplace_back(cause, percent);
  }
  return shares;
}

double work_per_second(const Json& result) {
  return result.at("work").get<double>() * result.at("clock_hz").get<double>() /
         result.at("cycles").get<double>();
}

double cycles_per_sample_and_pe(const Json& result) {
  return result.at("cycles").get<double>() * result.at("pes").get<double>() / result.at("work").get<double>();
}

/// An upper bound for Himeno, which does 34 operations per cell and moves at least 13 floats in and 1 out, at
/// the bandwidth of small misaligned pieces.
double himeno_bound_flops(const TransferPoint& small) {
  constexpr double kOperations = 34;
  constexpr double kBytes = 14 * 4;
  return kOperations / kBytes * std::max(small.load_bytes_per_second, small.save_bytes_per_second);
}

struct Job {
  const char* name;
  const char* preset;
  std::function<std::string(const model::ChipConfig&)> run;
};

std::vector<Job> make_jobs(cn::Level level) {
  const auto multiply = [=](const model::ChipConfig& chip) {
    return run_example(chip, dgemm_run(examples::validated_dgemm(), chip.chip.pes, level));
  };
  const auto sample = [=](const model::ChipConfig& chip) {
    return run_example(chip, monte_carlo_run(examples::validated_monte_carlo(), chip.chip.pes, level));
  };
  const auto transform = [=](const model::ChipConfig& chip) {
    return run_example(chip, fft_run(examples::kValidatedFftImages, chip.chip.pes, level));
  };
  const auto sweep = [](const model::ChipConfig& chip) { return SweepRun(chip).run(); };
  return {{"DGEMM", kDesign, multiply},    {"DGEMM", kShipped, multiply},  {"Monte Carlo", kShipped, sample},
          {"2-D FFT", kDesign, transform}, {"PIO sweep", kShipped, sweep}, {"PIO sweep", kDesign, sweep}};
}

std::vector<Figure> make_figures(const std::vector<Json>& results,
                                 const std::vector<TransferPoint>& shipped) {
  const std::vector<TransferPoint> design = transfers(results[5]);
  const TransferPoint& large = transfer(design, 4096, 0);
  const TransferPoint& small = transfer(shipped, 80, 0);
  const TransferPoint& misaligned = transfer(shipped, 80, 56);
  constexpr double kGiga = 1e-9;
  const std::string path =
      "a third of the kernel's cycles are steps of B along the PE-to-PE path, which overlap with nothing: 16 "
      "doubles of registers hold 8 sums, so each vector of B is used twice in a PE; by that alone 58 % of "
      "the "
      "peak, and each word of programmed I/O takes a cycle from all PEs' loads and stores (stolen below)";
  const std::string stolen =
      "the PIO engine moves 8 bytes a cycle at most, which by itself bounds it to 5.3, and each word it "
      "moves "
      "takes a cycle from all PEs' loads and stores (stolen below)";
  return {
      {"DGEMM, early library", "GFLOPS", kDesign, work_per_second(results[0]) * kGiga, Published::value, 25,
       25, "ClearSpeed white paper; Kent State slides; Beowulf list 2006", path},
      {"DGEMM, later library", "GFLOPS", kShipped, work_per_second(results[1]) * kGiga, Published::value, 33,
       33, "ClearSpeed, Technology page", path},
      {"Monte Carlo, European option", "cycles/sample/PE", kShipped, cycles_per_sample_and_pe(results[2]),
       Published::value, 292, 308, "ClearSpeed, Monte Carlo benchmark, 1 to 4 boards, as cycles at 210 MHz",
       ""},
      {"2-D FFT 512 x 512, single precision", "GFLOPS", kDesign, work_per_second(results[3]) * kGiga,
       Published::value, 6, 6, "Beowulf list 2006: 12 a board; 5 N log2 N operations", stolen},
      {"PIO, 4096 B a PE", "GB/s", kDesign, large.load_bytes_per_second * kGiga, Published::at_least, 2.1,
       2.1, "inferred from the FFT: two passes, read and written", ""},
      {"PIO, 80 B a PE", "GB/s", kShipped, small.load_bytes_per_second * kGiga, Published::value, 0.61, 0.61,
       "not measured: the reference's own estimate from assumed costs", ""},
      {"Himeno, if memory is all it waits for", "GFLOPS", kShipped, himeno_bound_flops(misaligned) * kGiga,
       Published::at_most, 0.66, 0.66, "Nishikawa et al., ICPP 2007: below 1/50 of sustained", ""},
  };
}

model::ChipConfig checked_chip(const ValidationOptions& options, const char* preset) {
  model::ChipConfig chip = options.chip(preset);
  constexpr int kPesPerGroup = 1 << examples::kGroupBits;
  if (chip.chip.pes % kPesPerGroup != 0)
    throw InputError("chip.pes: found " + std::to_string(chip.chip.pes) +
                     ", validation's FFT allows multiples of " + std::to_string(kPesPerGroup));
  return chip;
}

}  // namespace

double Figure::error_percent() const {
  const bool too_low = model < published_low && kind != Published::at_most;
  const bool too_high = model > published_high && kind != Published::at_least;
  if (!too_low && !too_high) return 0;
  return 100 * (model / (too_low ? published_low : published_high) - 1);
}

Validation validate(const ValidationOptions& options, const std::function<void(double)>& progress) {
  const std::vector<Job> jobs = make_jobs(options.level);
  std::vector<std::function<std::string()>> runs;
  for (const Job& job : jobs)
    runs.emplace_back([run = job.run, chip = checked_chip(options, job.preset)] { return run(chip); });
  std::vector<Json> results;
  for (const std::string& result : run_in_processes(runs, options.jobs, [&](int finished) {
         if (progress) progress(finished / double(runs.size()));
       }))
    results.push_back(Json::parse(result));
  Validation validation;
  validation.transfers = transfers(results[4]);
  validation.figures = make_figures(results, validation.transfers);
  for (std::size_t i = 0; i < jobs.size(); ++i)
    if (results[i].contains("by_cause"))
      validation.shares.push_back(shares(jobs[i].name, jobs[i].preset, results[i]));
  return validation;
}

}  // namespace testbench
