#include "testbench/statistics/render_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/path_tracer/materials/lobe_table.hpp"
#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/paper/paper.hpp"
#include "testbench/run/energy.hpp"
#include "testbench/run/technology.hpp"
#include "testbench/run/timing_name.hpp"
#include "testbench/statistics/chip_config_json.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/statistics/roofline.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/statistics/verdict.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

Json value_json(const path_tracer::OptionValue& value) {
  return std::visit([](const auto& held) { return Json(held); }, value);
}

/// Every option of the firmware, and the samples: of a run with a list, a pixel's mean number.
Json firmware_json(const RenderOptions& options) {
  Json json;
  for (const path_tracer::ProgramOption& option : path_tracer::program_options())
    json[option.name] = value_json(option.read(options.program));
  json["samples"] = options.work.samples;
  return json;
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

using Rows = std::vector<std::pair<std::string, std::string>>;

void add_energy_row(const RenderResult& result, Rows& rows) {
  const Energy energy = energy_of(*result.chip);
  const std::uint64_t rays = result.counts.segments + result.counts.shadow_rays;
  for (const std::string& note : technology_notes(result.chip->config)) rows.emplace_back("note", note);
  rows.emplace_back("energy", text("%.4g J", energy.joules()) +
                                  text(result.chips.empty() ? " (%.1f W chip" : " (%.1f W chips",
                                       energy.chip_joules() / energy.seconds) +
                                  text(", %.1f W DDR)", energy.ddr_joules() / energy.seconds) +
                                  text(", %.0f rays/J", double(rays) / energy.joules()));
}

void add_roofline_row(const ChipStatistics& chip, Rows& rows) {
  const Roofline roofline = roofline_of(chip);
  std::string row;
  for (const Roof& roof : roofline.roofs)
    row += text("%.2f", roof.attained_per_second * 1e-9) + text(" of %.1f G", roof.peak_per_second * 1e-9) +
           (roof.name == "pe_array" ? "flop/s" : "B/s " + std::string(roof.name)) + ", ";
  rows.emplace_back("roofline", row + "nearest roof " + std::string(roofline.nearest().name) +
                                    text(" at %.1f %%", 100 * roofline.nearest().share()));
}

/// "pe_array 43.0 %, pio 92.8 %, ...": units that did anything.
void add_verdict_rows(const ChipStatistics& chip, Rows& rows) {
  const Verdict verdict = verdict_of(chip);
  std::string row;
  for (const UnitUse& use : verdict.units)
    if (use.share > 0)
      row += (row.empty() ? "" : ", ") + std::string(use.name) + text(" %.1f %%", 100 * use.share);
  rows.emplace_back("busy", row);
  rows.emplace_back("verdict", verdict.reason + " (csx600 sensitivity: what a change does)");
}

/// "2 chips: 0.012 s and 61.2 % utilisation, ...": how evenly the work was divided.
void add_board_row(const std::vector<ChipStatistics>& chips, Rows& rows) {
  std::string row = std::to_string(chips.size()) + " chips";
  for (const ChipStatistics& chip : chips)
    row += (&chip == &chips.front() ? ": " : ", ") + text("%.6f s", chip.seconds()) +
           text(" at %.1f %%", 100 * chip.pe_utilisation());
  rows.emplace_back("board", row + " PE utilisation; counts are sums");
}

void add_chip_rows(const RenderResult& result, Rows& rows) {
  const ChipStatistics& chip = *result.chip;
  if (!result.chips.empty()) add_board_row(result.chips, rows);
  rows.emplace_back("simulated time",
                    text("%.6f s", chip.seconds()) + text(" (%.0f cycles)", double(chip.firmware_cycles)));
  rows.emplace_back("simulated segments/s", text("%.0f", double(result.counts.segments) / chip.seconds()));
  rows.emplace_back("PE utilisation", text("%.2f %%", 100 * chip.pe_utilisation()));
  rows.emplace_back("SIMD efficiency", text("%.2f %%", 100 * chip.simd_efficiency()));
  rows.emplace_back("exposed PIO", text("%.2f %% of the time", 100 * chip.exposed_pio_share()));
  rows.emplace_back("DDR bandwidth", text("%.1f MB/s", chip.ddr_bytes_per_second() * 1e-6));
  add_energy_row(result, rows);
  add_roofline_row(chip, rows);
  add_verdict_rows(chip, rows);
}

void add_simulator_rows(const RenderRequest& request, const RenderResult& result, Rows& rows) {
  const double rate = double(result.counts.segments) / result.cpu_seconds;
  const double silicon = silicon_segments_per_second(request.options.program.program);
  rows.emplace_back("simulator time",
                    text("%.2f s CPU", result.cpu_seconds) + text(", %.2f s wall", result.wall_seconds));
  rows.emplace_back("simulator segments/s", text("%.0f", rate));
  rows.emplace_back("faster than the silicon",
                    text("%.1f times", rate / silicon) + text(" (paper: %.0f segments/s)", silicon));
}

/// "3412 of 15818 shadow rays": how often something was skipped.
std::string of_all(std::uint64_t skipped, std::uint64_t rest, const char* what) {
  return std::to_string(skipped) + " of " + std::to_string(skipped + rest) + " " + what;
}

void add_skips_row(const RenderResult& result, Rows& rows) {
  const path_tracer::RunCounts& counts = result.counts;
  const TextureUses& textures = result.textures;
  std::string row = of_all(counts.culled_shadow_rays, counts.shadow_rays, "shadow rays, ") +
                    of_all(counts.skipped_blocks, counts.blocks, "blocks of slots");
  if (textures.all > 0)
    row += ", " + of_all(textures.constant, textures.all - textures.constant, "textures, of one colour");
  rows.emplace_back("skipped", row + " (csx600 bench skips: what that saves)");
}

/// How much of the PEs each lobe's instructions had use for.
void add_lobes_row(const path_tracer::RunCounts& counts, Rows& rows) {
  std::string row;
  for (std::size_t i = 0; i < counts.lobes.size(); ++i)
    if (counts.lobes[i].blocks > 0)
      row += (row.empty() ? "" : ", ") + std::string(path_tracer::kLobeTable[i].name) +
             text(" %.0f %%", 100 * counts.lobes[i].simd_efficiency());
  if (!row.empty()) rows.emplace_back("SIMD efficiency of lobes", row);
}

void add_traversal_row(const RenderRequest& request, const RenderResult& result, Rows& rows) {
  const path_tracer::RunCounts& counts = result.counts;
  const path_tracer::ProgramConfig& program = request.options.program;
  std::string row = name_of(program.traversal);
  const double rays = double(counts.segments + counts.shadow_rays);
  if (program.hands_rays_to_unit() && result.chip) {
    const model::SearchStatistics& unit = result.chip->search_unit;
    row += text(": %.2f nodes", double(unit.nodes) / rays) +
           text(", %.2f triangles tested a ray", double(unit.leaf_tests) / rays) +
           text(", the unit busy %.0f %% of the time",
                100 * double(unit.busy_cycles) /
                    (double(result.chip->firmware_cycles) * result.chip->config.search_unit.units *
                     result.chip->config.board.chips));
  } else if (program.walks_tree()) {
    row += text(": %.2f leaves", double(counts.traversal.leaf_loads) / rays) +
           text(", %.2f treelets loaded a ray", double(counts.traversal.treelet_loads) / rays);
  }
  if (!request.traversal_reason.empty()) row += " (" + request.traversal_reason + ")";
  rows.emplace_back("traversal", row);
}

void add_connections_row(const path_tracer::RunCounts& counts, Rows& rows) {
  const path_tracer::ConnectionCounts& of = counts.connections;
  if (of.light_segments + of.all() == 0) return;
  const auto paths = double(counts.paths);
  rows.emplace_back("bidirectional",
                    text("%.2f light segments", double(of.light_segments) / paths) +
                        text(" and %.2f connections a path", double(of.all()) / paths) +
                        text(" (%.2f to the lens", double(of.to_lens) / paths) +
                        text(", %.2f to lights", double(of.to_lights) / paths) +
                        text(", %.2f to light vertices)", double(of.to_light_vertices) / paths) +
                        text(", %.0f %% of the rays",
                             100 * double(of.all()) / double(counts.segments + counts.shadow_rays)));
}

}  // namespace

Json render_statistics(const RenderRequest& request, const RenderResult& result) {
  Json json;
  json["format"] = kStatisticsFormat;
  json["scene"] = request.scene;
  json["width"] = result.film.size().width;
  json["height"] = result.film.size().height;
  if (request.triangles > 0) json["triangles"] = request.triangles;
  json["firmware"] = firmware_json(request.options);
  if (!request.traversal_reason.empty()) json["traversal_chosen_because"] = request.traversal_reason;
  if (result.is_partial) json["partial"] = true;
  json["machine"] = request.native ? "native" : "chip";
  json["timing"] = request.native ? "none" : timing_name(request.options.timing);
  if (!request.importance.empty()) json["importance"] = request.importance;
  json["chip_preset"] = request.options.chip.preset;
  json["chip_config"] = chip_config_json(request.options.chip);
  Json measured;
  write_counters(run_counters(), result, measured);
  const Json simulator = measured[kSimulatorSection];
  measured.erase(kSimulatorSection);
  json.update(measured);
  json["image_sha256"] = result.film.sha256();
  json["counts"] = to_json(result.counts);
  if (result.chip) json["chip"] = to_json(*result.chip);
  for (std::size_t i = 0; i < result.chips.size(); ++i)
    json["chips"]["csx600_" + std::to_string(i)] = to_json(result.chips[i]);
  json[kSimulatorSection] = simulator;
  return json;
}

std::string render_table(const RenderRequest& request, const RenderResult& result) {
  Rows rows;
  const path_tracer::RunCounts& counts = result.counts;
  if (request.triangles > 0) rows.emplace_back("triangles", text("%.0f", double(request.triangles)));
  rows.emplace_back("path segments", text("%.0f", double(counts.segments)) +
                                         text(" of %.0f paths", double(counts.paths)) +
                                         text(", %.0f shadow rays", double(counts.shadow_rays)));
  add_traversal_row(request, result, rows);
  add_connections_row(counts, rows);
  add_skips_row(result, rows);
  add_lobes_row(counts, rows);
  if (result.chip) add_chip_rows(result, rows);
  add_simulator_rows(request, result, rows);
  std::string table;
  for (const auto& [label, value] : rows) {
    char name[32];
    std::snprintf(name, sizeof(name), "  %-24s ", label.c_str());
    table += name + value + '\n';
  }
  return table;
}

std::map<std::string, std::string> render_provenance(const RenderRequest& request,
                                                     const RenderResult& result) {
  std::map<std::string, std::string> provenance = {
      {"csx600.scene", request.scene},
      {"csx600.firmware", json_text(firmware_json(request.options))},
      {"csx600.machine", request.native ? "native" : "chip " + request.options.chip.preset},
      {"csx600.segments", std::to_string(result.counts.segments)},
      {"csx600.image_sha256", result.film.sha256()}};
  if (!request.importance.empty()) provenance["csx600.importance"] = request.importance;
  return provenance;
}

}  // namespace testbench
