#include "testbench/statistics/counters.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "firmware/path_tracer/materials/lobe_table.hpp"
#include "testbench/run/energy.hpp"
#include "testbench/run/render.hpp"
#include "testbench/system/simulator_time.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using path_tracer::LobeCount;
using path_tracer::RunCounts;

std::uint64_t rays(const RenderResult& run) {
  return run.counts.segments + run.counts.shadow_rays;
}

/// Null for a native run, which has neither clock nor energy.
Json per_joule(const RenderResult& run, std::uint64_t count) {
  if (!run.chip) return nullptr;
  return double(count) / energy_of(*run.chip).joules();
}

Json samples_a_pixel(const RenderResult& run) {
  const PixelSamples samples = run.film.samples();
  return {{"fewest", samples.fewest}, {"mean", samples.mean}, {"most", samples.most}};
}

Json paths_by_segments(const RunCounts& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < counts.paths_by_segments.size(); ++i)
    if (counts.paths_by_segments[i] != 0) json[std::to_string(i)] = counts.paths_by_segments[i];
  return json;
}

/// Paths that trace their first, second, ... segment: those that are at least so long.
Json paths_alive(const RunCounts& counts) {
  Json json = Json::object();
  std::uint64_t alive = 0;
  for (const std::uint64_t paths : counts.paths_by_segments) alive += paths;
  for (std::size_t i = 1; i < counts.paths_by_segments.size(); ++i) {
    alive -= counts.paths_by_segments[i - 1];
    json[std::to_string(i)] = alive;
  }
  return json;
}

/// Empty of a run without light paths.
Json bidirectional_rays(const RunCounts& counts) {
  const path_tracer::ConnectionCounts& of = counts.connections;
  if (of.light_segments + of.all() == 0) return Json::object();
  return {{"light_segments", of.light_segments},
          {"to_lens", of.to_lens},
          {"to_lights", of.to_lights},
          {"to_light_vertices", of.to_light_vertices}};
}

/// An object with what `read` says of each lobe that a kernel has issued.
template <class Read>
Json by_lobe(const RunCounts& counts, const Read& read) {
  Json json = Json::object();
  for (std::size_t i = 0; i < counts.lobes.size(); ++i)
    if (counts.lobes[i].blocks != 0)
      json[std::string(path_tracer::kLobeTable[i].name)] = read(counts.lobes[i]);
  return json;
}

template <class Source>
void append(const std::string& prefix, const Counters<Source>& counters, std::vector<Counter>& all) {
  for (const CounterOf<Source>& counter : counters) {
    all.push_back(counter.counter);
    all.back().key.insert(0, prefix);
  }
}

std::vector<std::string_view> parts_of(std::string_view key) {
  std::vector<std::string_view> parts;
  for (std::size_t dot; (dot = key.find('.')) != std::string_view::npos; key.remove_prefix(dot + 1))
    parts.push_back(key.substr(0, dot));
  parts.push_back(key);
  return parts;
}

bool matches(std::string_view declared, std::string_view key) {
  const auto names = parts_of(declared);
  const auto parts = parts_of(key);
  return names.size() == parts.size() &&
         std::equal(names.begin(), names.end(), parts.begin(),
                    [](std::string_view name, std::string_view part) { return name == "*" || name == part; });
}

}  // namespace

const Counters<RenderResult>& run_counters() {
  using Run = RenderResult;
  static const Counters<Run> counters = {
      {{"simulated_seconds", "s", "time from the firmware's start to its end; null for a native run"},
       [](const Run& run) { return run.chip ? Json(run.chip->seconds()) : Json(); }},
      {{"simulated_cycles", "cycles", "the same in cycles of the chip"},
       [](const Run& run) { return run.chip ? Json(run.chip->firmware_cycles) : Json(); }},
      {{"segments", "count", "path segments traced"},
       [](const Run& run) { return Json(run.counts.segments); }},
      {{"rays", "count", "segments and shadow rays"}, [](const Run& run) { return Json(rays(run)); }},
      {{"rays_per_joule", "-", "rays by the energy of chip and DDR; null for a native run",
        CounterKind::derived},
       [](const Run& run) { return per_joule(run, rays(run)); }},
      {{"segments_per_joule", "-", "segments by the energy of chip and DDR; null for a native run",
        CounterKind::derived},
       [](const Run& run) { return per_joule(run, run.counts.segments); }},
      {{"samples_a_pixel.*", "-",
        "paths of the pixel with the fewest, of the mean one, of the one with the most",
        CounterKind::derived},
       samples_a_pixel},
      {{"textures.used", "count", "textures of materials that triangles have, one for each field"},
       [](const Run& run) { return Json(run.textures.all); }},
      {{"textures.constant", "count", "of these, textures of one colour, which became factors"},
       [](const Run& run) { return Json(run.textures.constant); }},
      {{"simulator.cpu_seconds", "s", "CPU time of the simulator, without loading and writing"},
       [](const Run& run) { return Json(run.cpu_seconds); }},
      {{"simulator.wall_seconds", "s", "the same by the wall clock"},
       [](const Run& run) { return Json(run.wall_seconds); }},
      {{"simulator.peak_bytes", "bytes", "memory of the process at most"},
       [](const Run&) { return Json(peak_bytes()); }},
      {{"simulator.segments_per_cpu_second", "-", "how fast the model renders", CounterKind::derived},
       [](const Run& run) { return Json(double(run.counts.segments) / run.cpu_seconds); }}};
  return counters;
}

const Counters<RunCounts>& firmware_counters() {
  static const Counters<RunCounts> counters = {
      {{"paths", "count", "camera paths"}, [](const RunCounts& c) { return Json(c.paths); }},
      {{"segments", "count", "path segments traced"}, [](const RunCounts& c) { return Json(c.segments); }},
      {{"shadow_rays", "count", "shadow rays traced"},
       [](const RunCounts& c) { return Json(c.shadow_rays); }},
      {{"culled_shadow_rays", "count", "hits without a shadow ray: dark, or their light faces away"},
       [](const RunCounts& c) { return Json(c.culled_shadow_rays); }},
      {{"folds", "count", "paths flushed because their slot was full"},
       [](const RunCounts& c) { return Json(c.folds); }},
      {{"blocks", "count", "blocks of slots processed, over all passes"},
       [](const RunCounts& c) { return Json(c.blocks); }},
      {{"skipped_blocks", "count", "blocks of slots that were empty and so skipped"},
       [](const RunCounts& c) { return Json(c.skipped_blocks); }},
      {{"steps", "count", "stages run on a block"}, [](const RunCounts& c) { return Json(c.steps); }},
      {{"paths_by_segments.*", "count", "paths that ended with so many segments"}, paths_by_segments},
      {{"paths_alive_by_segment.*", "count", "paths that traced a first, second, ... segment",
        CounterKind::derived},
       paths_alive},
      {{"passes", "count", "times that all live blocks went through the bins"},
       [](const RunCounts& c) { return Json(c.rays.passes()); }},
      {{"passes_per_interval", "count",
        "passes of each interval of rays_by_interval; the last interval may have fewer"},
       [](const RunCounts& c) { return Json(c.rays.passes_per_interval()); }},
      {{"rays_by_interval.*", "count", "rays, summed over the passes of each interval of time"},
       [](const RunCounts& c) { return Json(c.rays.intervals()); }},
      {{"lobes.blocks.*", "count", "blocks for which the part of kernel shade with this lobe was issued"},
       [](const RunCounts& c) { return by_lobe(c, [](const LobeCount& of) { return of.blocks; }); }},
      {{"lobes.wanted_lanes.*", "count", "PEs of these blocks at a hit whose material has the lobe"},
       [](const RunCounts& c) { return by_lobe(c, [](const LobeCount& of) { return of.wanted_lanes; }); }},
      {{"lobes.simd_efficiency.*", "-", "wanted share of all PEs of these blocks", CounterKind::derived},
       [](const RunCounts& c) {
         return by_lobe(c, [](const LobeCount& of) { return of.simd_efficiency(); });
       }},
      {{"bidirectional.*", "count",
        "of bidirectional paths: segments of light paths, and the shadow rays of connections from light "
        "paths "
        "to the lens, from eye paths to points of lights and to vertices of light paths"},
       bidirectional_rays},
      {{"traversal.leaf_loads", "count", "leaves that a ray loaded, with a tree"},
       [](const RunCounts& c) { return Json(c.traversal.leaf_loads); }},
      {{"traversal.treelet_loads", "count", "treelets that a ray loaded"},
       [](const RunCounts& c) { return Json(c.traversal.treelet_loads); }},
      {{"traversal.rays_by_pass.*", "count",
        "rays that went through the traversal bin for the first, second, ... time, after their start as pass "
        "0"},
       [](const RunCounts& c) { return Json(c.traversal.rays); }},
      {{"traversal.lanes_by_pass.*", "count", "PEs of the blocks that these rays filled"},
       [](const RunCounts& c) { return Json(c.traversal.lanes); }},
      {{"traversal.rays_before_tail", "count",
        "rays that went through the traversal bin until 95 % of those in the ray queue had finished"},
       [](const RunCounts& c) { return Json(c.traversal.rays_before_tail); }},
      {{"traversal.lanes_before_tail", "count", "PEs of the blocks that these rays filled"},
       [](const RunCounts& c) { return Json(c.traversal.lanes_before_tail); }}};
  return counters;
}

const Counters<WorkDone>& work_counters() {
  using Work = WorkDone;
  static const Counters<Work> counters = {
      {{"amount", "-", "what the firmware says it did, in work.unit"},
       [](const Work& work) { return Json(work.amount); }},
      {{"unit", "-", "what the firmware counts its work in", CounterKind::derived},
       [](const Work& work) { return Json(work.unit); }},
      {{"per_second", "-", "work by simulated_seconds; null for a native run", CounterKind::derived},
       [](const Work& work) { return work.chip ? Json(work.amount / work.chip->seconds()) : Json(); }},
      {{"per_second_with_host", "-", "the same by the time that includes upload and download",
        CounterKind::derived},
       [](const Work& work) { return work.chip ? Json(work.amount / work.chip->total_seconds()) : Json(); }},
      {{"per_joule", "-", "work by the energy of chip and DDR; null for a native run", CounterKind::derived},
       [](const Work& work) {
         return work.chip ? Json(work.amount / energy_of(*work.chip).joules()) : Json();
       }}};
  return counters;
}

const std::vector<Counter>& all_counters() {
  static const std::vector<Counter> counters = [] {
    std::vector<Counter> all;
    append("", run_counters(), all);
    append("counts.", firmware_counters(), all);
    append("chip.", chip_counters(), all);
    append("chip.pe_array.kernels.*.", kernel_counters(), all);
    return all;
  }();
  return counters;
}

const std::vector<Counter>& all_work_counters() {
  static const std::vector<Counter> counters = [] {
    std::vector<Counter> all;
    append("work.", work_counters(), all);
    return all;
  }();
  return counters;
}

const Counter* find_counter(std::string_view key) {
  constexpr std::string_view kOfChips = "chips.";
  if (key.substr(0, kOfChips.size()) == kOfChips) {
    const std::size_t dot = key.find('.', kOfChips.size());
    return dot == std::string_view::npos ? nullptr : find_counter("chip" + std::string(key.substr(dot)));
  }
  for (const std::vector<Counter>* const counters : {&all_counters(), &all_work_counters()})
    for (const Counter& counter : *counters)
      if (matches(counter.key, key)) return &counter;
  return nullptr;
}

std::string describe_counters() {
  std::vector<Counter> all = all_counters();
  all.insert(all.end(), all_work_counters().begin(), all_work_counters().end());
  std::size_t key_width = 0;
  for (const Counter& counter : all) key_width = std::max(key_width, counter.key.size());
  std::ostringstream out;
  for (const Counter& counter : all)
    out << std::left << std::setw(int(key_width) + 2) << counter.key << std::setw(11) << counter.unit
        << counter.meaning << (counter.kind == CounterKind::derived ? " (derived)" : "") << '\n';
  return out.str();
}

Json to_json(const RunCounts& counts) {
  Json json;
  write_counters(firmware_counters(), counts, json);
  return json;
}

}  // namespace testbench
