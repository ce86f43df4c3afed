#include "testbench/faults/fault_campaign.hpp"

#include <algorithm>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>

#include "firmware/plug_in/random.hpp"
#include "testbench/faults/fault_text.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/system/workers.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPollMilliseconds = 100;  ///< the longest that a request to stop waits
constexpr std::uint64_t kWatchdogFactor = 4;

/// Random numbers of one run, of up to 16, which depend on no other run.
class RunRandom {
 public:
  RunRandom(std::uint64_t seed, std::uint64_t number) : index_((seed << 36) + number * 16) {}

  /// An integer in [0, end), end below 2^53.
  std::uint64_t below(std::uint64_t end) { return std::uint64_t(double(end) * plug_in::random_of(index_++)); }

 private:
  std::uint64_t index_;
};

RenderOptions options_with(const FaultCampaign& campaign, const FaultFreeRun& fault_free,
                           const model::Fault& fault) {
  RenderOptions options = campaign.options;
  options.faults = {fault};
  std::uint64_t& watchdog = options.chip.chip.watchdog_cycles;
  const std::uint64_t longest = kWatchdogFactor * fault_free.firmware_cycles;
  watchdog = watchdog == 0 ? longest : std::min(watchdog, longest);
  return options;
}

std::string line_of(std::uint64_t number, const model::Fault& fault, const FaultResult& result) {
  return json_text({{"number", number},
                    {"kind", info_of(fault.kind).name},
                    {"fault", text_of(fault)},
                    {"outcome", kFaultOutcomes[std::size_t(result.outcome)].name},
                    {"differing_pixels", result.differing_pixels},
                    {"largest_difference", result.largest_difference},
                    {"extra_cycles", result.extra_cycles},
                    {"message", result.message}});
}

/// One run, whatever it does to its process.
std::string run_one(const FaultCampaign& campaign, const FaultFreeRun& fault_free, std::uint64_t number,
                    double limit_seconds) {
  const model::Fault fault = fault_of_run(campaign, fault_free, number);
  const auto work = [&] {
    const RenderResult result = render_on_chip(*campaign.scene, options_with(campaign, fault_free, fault));
    FaultResult compared = compare_with(fault_free.rgb, result);
    compared.extra_cycles = std::int64_t(result.chip->firmware_cycles - fault_free.firmware_cycles);
    return line_of(number, fault, compared);
  };
  try {
    return run_in_processes({work}, 1, {}, limit_seconds)[0];
  } catch (const std::exception& error) {
    return line_of(number, fault, stopped_by(first_line(error.what())));
  }
}

}  // namespace

FaultFreeRun run_without_faults(const FaultCampaign& campaign, double limit_seconds) {
  const auto work = [&] {
    const RenderResult result = render_on_chip(*campaign.scene, campaign.options);
    return json_text({{"rgb", result.film.rgb()},
                      {"image_sha256", result.film.sha256()},
                      {"firmware_cycles", result.chip->firmware_cycles},
                      {"cpu_seconds", result.cpu_seconds}});
  };
  const Json json = Json::parse(run_in_processes({work}, 1, {}, limit_seconds)[0]);
  return {json["rgb"].get<std::vector<double>>(), json["image_sha256"].get<std::string>(),
          json["firmware_cycles"].get<model::Cycles>(), json["cpu_seconds"].get<double>()};
}

model::Fault fault_of_run(const FaultCampaign& campaign, const FaultFreeRun& fault_free,
                          std::uint64_t number) {
  RunRandom random(campaign.seed, number);
  const model::ChipConfig& chip = campaign.options.chip;
  model::Fault fault;
  fault.kind = campaign.kinds[number % campaign.kinds.size()];
  const model::FaultKindInfo& kind = info_of(fault.kind);
  fault.cycle = random.below(fault_free.firmware_cycles);
  if (kind.has_pe) fault.pe = int(random.below(std::uint64_t(chip.chip.pes)));
  if (fault.kind == model::FaultKind::poly_sram)
    fault.address = random.below(std::uint64_t(chip.poly.sram_bytes));
  else if (fault.kind == model::FaultKind::poly_register)
    fault.address = random.below(std::uint64_t(chip.poly.sram_bytes) / 8);
  else if (kind.has_address)
    fault.address = random.below(campaign.options.image->layout.total_bytes);
  if (kind.bits > 0) fault.bit = int(random.below(std::uint64_t(kind.bits)));
  // Late within the time of a few requests: what is later meets its waiter as what is lost does.
  constexpr std::uint64_t kMostLateCycles = 100'000;
  if (kind.has_late_cycles) fault.late_cycles = 1 + random.below(kMostLateCycles);
  return fault;
}

bool run_campaign(const FaultCampaign& campaign, const FaultFreeRun& fault_free, int count, int jobs,
                  double limit_seconds, FaultStore& store, const RenderProgress& progress) {
  std::deque<std::uint64_t> left;
  for (std::uint64_t number = 0; number < std::uint64_t(count); ++number)
    if (!store.has(number)) left.push_back(number);
  std::size_t open = left.size();
  const double all = double(std::max<std::size_t>(open, 1));
  Workers workers(int(std::min(std::size_t(jobs), open)), [&] {
    return [&](const std::string& order) {
      return run_one(campaign, fault_free, std::stoull(order), limit_seconds);
    };
  });
  std::deque<int> idle;
  for (int worker = 0; worker < int(std::min(std::size_t(jobs), open)); ++worker) idle.push_back(worker);
  while (open > 0) {
    if (!progress(1 - double(open) / all)) return false;
    for (; !idle.empty() && !left.empty(); idle.pop_front(), left.pop_front())
      workers.send(idle.front(), std::to_string(left.front()));
    const std::optional<Workers::Reply> reply = workers.next(kPollMilliseconds);
    if (!reply) continue;
    if (!reply->text) throw RunError("a process of the campaign has ended; the same command goes on");
    store.add(*reply->text);
    --open;
    idle.push_back(reply->worker);
  }
  return true;
}

}  // namespace testbench
