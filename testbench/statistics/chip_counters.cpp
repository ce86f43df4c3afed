#include "testbench/run/area.hpp"
#include "testbench/run/energy.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/roofline.hpp"
#include "testbench/statistics/verdict.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using Chip = ChipStatistics;
constexpr CounterKind kDerived = CounterKind::derived;

Json cycles_by_cause(const Chip& chip) {
  Json cycles = Json::object();
  for (int i = 0; i < model::kCycleCauses; ++i)
    cycles[model::cycle_cause_name(model::CycleCause(i))] = chip.control.cycles[std::size_t(i)];
  return cycles;
}

Json joules_by_cause(const Chip& chip) {
  Json joules = Json::object();
  for (const Energy::Cause& cause : energy_of(chip).causes) joules[cause.name] = cause.joules;
  return joules;
}

Json square_millimetres_by_part(const Chip& chip) {
  Json area = Json::object();
  for (const Area::Part& part : area_of(chip.config).parts) area[part.name] = part.mm2;
  return area;
}

/// A chip without a search unit has none of its counters.
Json search_counts(const Chip& chip) {
  Json counts = Json::object();
  if (chip.config.search_unit.units == 0) return counts;
  const model::SearchStatistics& of = chip.search_unit;
  counts["queries"] = of.queries;
  counts["nodes"] = of.nodes;
  counts["leaves"] = of.leaves;
  counts["node_tests"] = of.node_tests;
  counts["leaf_tests"] = of.leaf_tests;
  counts["cache_hits"] = of.cache_hits;
  counts["cache_joins"] = of.cache_joins;
  counts["cache_misses"] = of.cache_misses;
  return counts;
}

Json search_cycles(const Chip& chip) {
  Json cycles = Json::object();
  if (chip.config.search_unit.units == 0) return cycles;
  const model::SearchStatistics& of = chip.search_unit;
  cycles["busy"] = of.busy_cycles;
  cycles["stalled"] = of.stalled_cycles;
  cycles["node_tests"] = of.node_cycles;
  cycles["leaf_tests"] = of.leaf_cycles;
  cycles["answer_wait"] = of.answer_wait_cycles;
  cycles["network_wait"] = chip.bus_search_unit.waiting_cycles;
  return cycles;
}

Json search_bytes(const Chip& chip) {
  Json bytes = Json::object();
  if (chip.config.search_unit.units == 0) return bytes;
  const model::SearchStatistics& of = chip.search_unit;
  bytes["fetched"] = of.bytes_fetched;
  bytes["written"] = of.bytes_written;
  bytes["read"] = of.bytes_read;
  return bytes;
}

Json watts(const Chip& chip, double joules) {
  return chip.total_cycles > 0 ? joules / chip.total_seconds() : 0;
}

Json non_zero(const cn::IssueCounts& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < cn::kInstructionClasses; ++i)
    if (counts.by_class[i] != 0) json[std::string(cn::kInstructionClassNames[i])] = counts.by_class[i];
  return json;
}

/// None, eighths of the PEs, and all: "0", "1-12", ..., "85-95", "96".
Json runs_by_enabled_pes(const KernelOnArray& of) {
  constexpr int kBuckets = 8;
  const std::vector<std::uint64_t>& runs = of.kernel.runs_by_enabled_pes;
  Json json = Json::object();
  json["0"] = runs.front();
  for (int bucket = 0; bucket < kBuckets; ++bucket) {
    const int first = of.num_pes * bucket / kBuckets + 1;
    const int last = std::min(of.num_pes * (bucket + 1) / kBuckets, of.num_pes - 1);
    if (first > last) continue;
    std::uint64_t sum = 0;
    for (int pes = first; pes <= last; ++pes) sum += runs[std::size_t(pes)];
    json[first == last ? std::to_string(first) : std::to_string(first) + "-" + std::to_string(last)] = sum;
  }
  json[std::to_string(of.num_pes)] = runs.back();
  return json;
}

/// Bytes that the SRAM accesses of enabled PEs moved.
std::uint64_t sram_bytes(const cn::IssueCounts& executed) {
  constexpr std::uint64_t kWordBytes = 4;
  return kWordBytes *
         (executed[cn::InstructionClass::sram] + executed[cn::InstructionClass::sram_vector_load]);
}

Counters<Chip> unit_counters() {
  return {
      {{"clock_hz", "Hz", "the chip's clock"}, [](const Chip& c) { return Json(c.config.chip.clock_hz); }},
      {{"pes", "count", "processing elements"}, [](const Chip& c) { return Json(c.config.chip.pes); }},
      {{"total_cycles", "cycles", "from the first cycle of the upload to the last of the download"},
       [](const Chip& c) { return Json(c.total_cycles); }},
      {{"pe_utilisation", "-", "share of the firmware's time in which kernels ran", kDerived},
       [](const Chip& c) { return Json(c.pe_utilisation()); }},
      {{"simd_efficiency", "-", "enabled share of the issued lane-cycles", kDerived},
       [](const Chip& c) { return Json(c.simd_efficiency()); }},
      {{"exposed_pio_share", "-",
        "share of the firmware's time in which the control unit only waited for programmed I/O", kDerived},
       [](const Chip& c) { return Json(c.exposed_pio_share()); }},
      {{"ddr_bytes_per_second", "bytes/s", "rate of bytes through the DDR's data bus", kDerived},
       [](const Chip& c) { return Json(c.ddr_bytes_per_second()); }},
      {{"control_unit.cycles_by_cause.*", "cycles",
        "the firmware's time by what the control unit did; the sum is simulated_cycles"},
       cycles_by_cause},
      {{"control_unit.mono_instructions", "count", "instructions of the control unit outside kernels"},
       [](const Chip& c) { return Json(c.control.mono_instructions); }},
      {{"control_unit.data_cache_hits", "count", "lines of mono data found in the cache"},
       [](const Chip& c) { return Json(c.control.data_cache_hits); }},
      {{"control_unit.data_cache_misses", "count", "lines fetched from mono memory"},
       [](const Chip& c) { return Json(c.control.data_cache_misses); }},
      {{"control_unit.thread_switches", "count", "switches from one hardware thread to another"},
       [](const Chip& c) { return Json(c.control.thread_switches); }},
      {{"control_unit.exposed_wait_after_last_kernel_cycles", "cycles",
        "waits for programmed I/O that no kernel follows"},
       [](const Chip& c) { return Json((c.control.pio_waits() - c.all_kernels.waited_before).total()); }},
      {{"pio.requests_mono_to_poly", "count", "requests that load"},
       [](const Chip& c) { return Json(c.pio.requests_to_poly); }},
      {{"pio.requests_poly_to_mono", "count", "requests that save"},
       [](const Chip& c) { return Json(c.pio.requests_to_mono); }},
      {{"pio.empty_requests", "count", "requests without an enabled PE, not among the others"},
       [](const Chip& c) { return Json(c.pio.empty_requests); }},
      {{"pio.bytes_mono_to_poly", "bytes", "loaded, in all PEs"},
       [](const Chip& c) { return Json(c.pio.bytes_to_poly); }},
      {{"pio.bytes_poly_to_mono", "bytes", "saved, in all PEs"},
       [](const Chip& c) { return Json(c.pio.bytes_to_mono); }},
      {{"pio.pes", "count", "PEs that took part, summed over requests"},
       [](const Chip& c) { return Json(c.pio.pes); }},
      {{"pio.busy_cycles", "cycles", "cycles in which the engine served requests: setup, PEs and memory"},
       [](const Chip& c) { return Json(c.pio.busy_cycles()); }},
      {{"pio.setup_cycles", "cycles", "setup of requests, before their first PE"},
       [](const Chip& c) { return Json(c.pio.setup_cycles); }},
      {{"pio.pe_cycles", "cycles", "taking PEs one by one, misalignment included"},
       [](const Chip& c) { return Json(c.pio.pe_cycles); }},
      {{"pio.memory_wait_cycles", "cycles", "cycles in which the engine waited for the memory"},
       [](const Chip& c) { return Json(c.pio.memory_wait_cycles); }},
      {{"pio.queue_wait_cycles", "cycles",
        "time from enqueueing to the start of service, summed over requests"},
       [](const Chip& c) { return Json(c.pio.queue_wait_cycles); }},
      {{"pio.max_queue_depth", "count", "most requests that waited at a time"},
       [](const Chip& c) { return Json(c.pio.max_queue_depth); }},
      {{"poly_sram.peak_bytes", "bytes", "most bytes of a PE that were in use"},
       [](const Chip& c) { return Json(c.poly_sram.peak_bytes); }},
      {{"poly_sram.words_in", "count", "8-byte words written by programmed I/O, in all PEs"},
       [](const Chip& c) { return Json(c.poly_sram.words_in); }},
      {{"poly_sram.words_out", "count", "8-byte words read by programmed I/O, in all PEs"},
       [](const Chip& c) { return Json(c.poly_sram.words_out); }},
      {{"poly_sram.port_cycles", "cycles", "cycles in which programmed I/O held the SRAM port, in all PEs"},
       [](const Chip& c) { return Json(c.poly_sram.port_cycles); }},
      {{"clear_connect.pio.bytes", "bytes", "payload of the PIO engine's packets"},
       [](const Chip& c) { return Json(c.bus_pio.bytes); }},
      {{"clear_connect.pio.packets", "count", "packets of the PIO engine"},
       [](const Chip& c) { return Json(c.bus_pio.packets); }},
      {{"clear_connect.pio.waiting_cycles", "cycles",
        "time that the PIO engine's packets waited for the ports to memories"},
       [](const Chip& c) { return Json(c.bus_pio.waiting_cycles); }},
      {{"clear_connect.control.bytes", "bytes", "payload of the control unit's packets"},
       [](const Chip& c) { return Json(c.bus_control.bytes); }},
      {{"clear_connect.control.packets", "count", "packets of the control unit"},
       [](const Chip& c) { return Json(c.bus_control.packets); }},
      {{"clear_connect.control.waiting_cycles", "cycles",
        "time that the control unit's packets waited for the ports to memories"},
       [](const Chip& c) { return Json(c.bus_control.waiting_cycles); }},
      {{"clear_connect.host.bytes", "bytes", "payload of the host link's packets"},
       [](const Chip& c) { return Json(c.bus_host.bytes); }},
      {{"clear_connect.host.packets", "count", "packets of the host link"},
       [](const Chip& c) { return Json(c.bus_host.packets); }},
      {{"clear_connect.host.waiting_cycles", "cycles",
        "time that the host link's packets waited for the ports to memories"},
       [](const Chip& c) { return Json(c.bus_host.waiting_cycles); }},
      {{"ddr.page_hits", "count", "accesses to an open page"},
       [](const Chip& c) { return Json(c.ddr.page_hits); }},
      {{"ddr.page_misses", "count", "accesses that opened their page first"},
       [](const Chip& c) { return Json(c.ddr.page_misses); }},
      {{"ddr.bytes_read", "bytes", "read by PIO engine, control unit and host"},
       [](const Chip& c) { return Json(c.ddr.bytes_read); }},
      {{"ddr.bytes_written", "bytes", "written by PIO engine, control unit and host"},
       [](const Chip& c) { return Json(c.ddr.bytes_written); }},
      {{"ddr.busy_cycles", "cycles", "cycles in which the data bus transferred"},
       [](const Chip& c) { return Json(c.ddr.busy_cycles); }},
      {{"ddr.turn_rounds", "count", "changes of the data bus's direction"},
       [](const Chip& c) { return Json(c.ddr.turn_rounds); }},
      {{"ddr.refreshes", "count", "refreshes of all banks"},
       [](const Chip& c) { return Json(c.ddr.refreshes); }},
      {{"on_chip_sram.accesses", "count", "accesses of PIO engine, control unit and host"},
       [](const Chip& c) { return Json(c.on_chip_sram.accesses); }},
      {{"on_chip_sram.bytes_read", "bytes", "read by PIO engine, control unit and host"},
       [](const Chip& c) { return Json(c.on_chip_sram.bytes_read); }},
      {{"on_chip_sram.bytes_written", "bytes", "written by PIO engine, control unit and host"},
       [](const Chip& c) { return Json(c.on_chip_sram.bytes_written); }},
      {{"on_chip_sram.busy_cycles", "cycles", "cycles in which its port transferred"},
       [](const Chip& c) { return Json(c.on_chip_sram.busy_cycles); }},
      {{"search_unit.counts.*", "count",
        "of a chip with search units: queries (rays), steps through nodes and leaves, tests of their boxes "
        "and triangles; lines found in the caches, on the way for another query, or fetched"},
       search_counts},
      {{"search_unit.cycles.*", "cycles",
        "summed over search units: with queries in flight (busy), all of which waited for memory (stalled), "
        "in which tests began; time that reads of answers waited, and lines for the network"},
       search_cycles},
      {{"search_unit.bytes.*", "bytes",
        "fetched from mono memory by search units; written to and read from their buffer"},
       search_bytes},
      {{"host_link.bytes_uploaded", "bytes", "from the host to mono memory"},
       [](const Chip& c) { return Json(c.host_link.bytes_uploaded); }},
      {{"host_link.bytes_downloaded", "bytes", "from mono memory to the host"},
       [](const Chip& c) { return Json(c.host_link.bytes_downloaded); }},
      {{"host_link.transfers", "count", "transfers of the host link"},
       [](const Chip& c) { return Json(c.host_link.transfers); }},
      {{"host_link.busy_cycles", "cycles", "cycles in which the host link transferred"},
       [](const Chip& c) { return Json(c.host_link.busy_cycles); }}};
}

Counters<Chip> energy_counters() {
  return {
      {{"energy.joules", "J",
        "energy of chip and DDR, from the first cycle of the upload to the last of the download"},
       [](const Chip& c) { return Json(energy_of(c).joules()); }},
      {{"energy.chip_joules", "J", "energy of the chip alone, comparable with the vendor's power figure",
        kDerived},
       [](const Chip& c) { return Json(energy_of(c).chip_joules()); }},
      {{"energy.ddr_joules", "J", "energy of the memory devices", kDerived},
       [](const Chip& c) { return Json(energy_of(c).ddr_joules()); }},
      {{"energy.watts", "W", "average power of chip and DDR", kDerived},
       [](const Chip& c) { return watts(c, energy_of(c).joules()); }},
      {{"energy.chip_watts", "W", "average power of the chip alone", kDerived},
       [](const Chip& c) { return watts(c, energy_of(c).chip_joules()); }},
      {{"energy.ddr_watts", "W", "average power of the memory devices", kDerived},
       [](const Chip& c) { return watts(c, energy_of(c).ddr_joules()); }},
      {{"energy.joules_by_cause.*", "J",
        "energy of an instruction class in enabled PEs or of a part of the chip; the sum is energy.joules",
        kDerived},
       joules_by_cause}};
}

Counters<Chip> area_counters() {
  return {{{"area.mm2_by_part.*", "mm2", "area of the parts of a chip, to first order", kDerived},
           square_millimetres_by_part},
          {{"area.mm2", "mm2", "area of all chips", kDerived},
           [](const Chip& c) { return Json(area_of(c.config).mm2() * c.config.board.chips); }}};
}

Counters<Chip> roofline_counters() {
  return {
      {{"roofline.flops", "count", "floating-point operations in enabled PEs; a routine is one"},
       [](const Chip& c) { return Json(roofline_of(c).flops()); }},
      {{"roofline.flops_per_second", "flop/s", "rate of floating-point operations in enabled PEs", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).roof("pe_array").attained_per_second); }},
      {{"roofline.peak_flops_per_second", "flop/s",
        "PEs x clock x the most operations that an instruction class does a cycle", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).roof("pe_array").peak_per_second); }},
      {{"roofline.pio_bytes_per_second", "bytes/s", "rate of bytes moved by programmed I/O", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).roof("pio").attained_per_second); }},
      {{"roofline.peak_pio_bytes_per_second", "bytes/s", "most bytes that the engine moves", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).roof("pio").peak_per_second); }},
      {{"roofline.flops_per_pio_byte", "flop/byte",
        "arithmetic intensity: operations for each byte moved by programmed I/O", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).intensity("pio")); }},
      {{"roofline.clear_connect_bytes_per_second", "bytes/s", "rate of bytes through the network", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).roof("clear_connect").attained_per_second); }},
      {{"roofline.peak_clear_connect_bytes_per_second", "bytes/s", "bandwidth of a node's link, both ways",
        kDerived},
       [](const Chip& c) { return Json(roofline_of(c).roof("clear_connect").peak_per_second); }},
      {{"roofline.flops_per_clear_connect_byte", "flop/byte",
        "arithmetic intensity: operations for each byte through the network", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).intensity("clear_connect")); }},
      {{"roofline.ddr_bytes_per_second", "bytes/s", "rate of bytes through the DDR's data bus", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).roof("ddr").attained_per_second); }},
      {{"roofline.peak_ddr_bytes_per_second", "bytes/s", "bandwidth of the data bus", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).roof("ddr").peak_per_second); }},
      {{"roofline.flops_per_ddr_byte", "flop/byte",
        "arithmetic intensity: operations for each byte through the DDR's data bus", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).intensity("ddr")); }},
      {{"roofline.nearest_roof", "-", "the roof that the run came nearest to", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).nearest().name); }},
      {{"roofline.nearest_roof_share", "-", "share of that roof's peak that the run attained", kDerived},
       [](const Chip& c) { return Json(roofline_of(c).nearest().share()); }},
      {{"roofline.attainable_flops_per_second", "flop/s", "where the nearest roof would stop this program",
        kDerived},
       [](const Chip& c) { return Json(roofline_of(c).attainable_flops_per_second()); }}};
}

Json shares_of_units(const Chip& chip) {
  Json shares = Json::object();
  for (const UnitUse& use : verdict_of(chip).units) shares[std::string(use.name)] = use.share;
  return shares;
}

Counters<Chip> verdict_counters() {
  return {{{"verdict.busy.*", "-",
            "share of the firmware's time in which a unit was busy: kernels; setup, turns of PEs and waits "
            "for memory of "
            "programmed I/O; bytes of the network's link; the DDR's data bus; the on-chip SRAM's port; the "
            "control unit's "
            "own work; the host link, with upload and download",
            kDerived},
           shares_of_units},
          {{"verdict.critical", "-", "the unit that was busy longest", kDerived},
           [](const Chip& c) { return Json(verdict_of(c).critical); }},
          {{"verdict.reason", "-", "how it spent its time, and who waited for it", CounterKind::told},
           [](const Chip& c) { return Json(verdict_of(c).reason); }}};
}

}  // namespace

const Counters<Chip>& chip_counters() {
  static const Counters<Chip> counters = [] {
    Counters<Chip> all = unit_counters();
    for (const Counters<Chip>& more :
         {energy_counters(), area_counters(), roofline_counters(), verdict_counters()})
      all.insert(all.end(), more.begin(), more.end());
    return all;
  }();
  return counters;
}

const Counters<KernelOnArray>& kernel_counters() {
  using Of = KernelOnArray;
  static const Counters<Of> counters = {
      {{"runs", "count", "runs of the kernel"}, [](const Of& of) { return Json(of.kernel.runs); }},
      {{"cycles", "cycles", "cycles of the kernel's code, without stolen ones"},
       [](const Of& of) { return Json(of.kernel.cycles); }},
      {{"simd_efficiency", "-", "enabled share of the issued lane-cycles", kDerived},
       [](const Of& of) { return Json(of.kernel.simd_efficiency(of.num_pes)); }},
      {{"sram_bytes", "bytes", "read from and written to poly SRAM by enabled PEs"},
       [](const Of& of) { return Json(sram_bytes(of.kernel.executed)); }},
      {{"flops", "count", "floating-point operations in enabled PEs; a routine is one"},
       [](const Of& of) { return Json(flops_of(of.kernel.executed)); }},
      {{"exposed_wait_cycles", "cycles",
        "time between the previous kernel and this one in which the control unit only waited for programmed "
        "I/O"},
       [](const Of& of) { return Json(of.kernel.waited_before.total()); }},
      {{"wait_load_cycles", "cycles", "part of exposed_wait_cycles: for loads"},
       [](const Of& of) { return Json(of.kernel.waited_before.load); }},
      {{"wait_save_cycles", "cycles", "part of exposed_wait_cycles: for saves"},
       [](const Of& of) { return Json(of.kernel.waited_before.save); }},
      {{"wait_pio_queue_cycles", "cycles", "part of exposed_wait_cycles: to queue a request"},
       [](const Of& of) { return Json(of.kernel.waited_before.queue); }},
      {{"issued.*", "count", "instructions by class; SRAM classes in 4-byte words"},
       [](const Of& of) { return non_zero(of.kernel.issued); }},
      {{"runs_by_enabled_pes.*", "count", "runs that began with so many PEs enabled"}, runs_by_enabled_pes}};
  return counters;
}

Json to_json(const Chip& statistics) {
  Json kernels = Json::array();
  for (const model::KernelStatistics& kernel : statistics.kernels) {
    Json json = {{"name", kernel.name}};
    write_counters(kernel_counters(), KernelOnArray{kernel, statistics.config.chip.pes}, json);
    kernels.push_back(std::move(json));
  }
  Json json;
  write_counters(chip_counters(), statistics, json);
  json["pe_array"]["kernels"] = std::move(kernels);
  return json;
}

}  // namespace testbench
