#include "testbench/paper/paper_claims.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/path_tracer/program/program_options.hpp"
#include "firmware/path_tracer/records/records.hpp"
#include "testbench/paper/paper.hpp"

namespace testbench {
namespace {

using path_tracer::Program;
using Runs = ClaimMeasurements;

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[300];
  std::snprintf(buffer, sizeof(buffer), format, values...);
  return buffer;
}

Verdict holds_if(bool holds) {
  return holds ? Verdict::holds : Verdict::fails;
}

Verdict holds_or_partly(bool holds, bool partly) {
  return holds ? Verdict::holds : partly ? Verdict::partly : Verdict::fails;
}

double per_segment(const Runs& runs, const std::string& name) {
  return runs.of(name).cycles_per_segment();
}

double seconds(const Runs& runs, Program program, const char* row) {
  return runs.of(std::string(name_of(program)) + ", " + row).seconds_per_million();
}

/// How many times the cycles of a run another one takes a segment.
double ratio(const Runs& runs, const std::string& name, const std::string& to) {
  return per_segment(runs, name) / per_segment(runs, to);
}

Judgement packets_on_wide_arrays(const Runs& runs) {
  const auto of_width = [&](const char* width) {
    return ratio(runs, std::string("packets width ") + width, std::string("temporary_bin width ") + width);
  };
  const double narrow = of_width("16");
  const double middle = of_width("96");
  const double wide = of_width("256");
  return {
      holds_or_partly(narrow < middle && middle < wide && wide > 1, wide > 1),
      text("packets take %.2f, %.2f, %.2f, %.2f times the cycles of the temporary bin at 16, 32, 96, 256 PEs",
           narrow, of_width("32"), middle, wide)};
}

Judgement packets_after_bounces(const Runs& runs) {
  const auto growth = [&](const char* traversal, const char* segments) {
    return ratio(runs, std::string(traversal) + ", paths of " + segments,
                 std::string(traversal) + ", paths of 1");
  };
  return {
      holds_if(growth("packets", "8") > 1.25 * growth("temporary_bin", "8")),
      text("cycles a segment of paths of 2, 4, 8 against camera rays alone: packets %.2f, %.2f, %.2f times; "
           "temporary bin %.2f, %.2f, %.2f times",
           growth("packets", "2"), growth("packets", "4"), growth("packets", "8"),
           growth("temporary_bin", "2"), growth("temporary_bin", "4"), growth("temporary_bin", "8"))};
}

Judgement any_coherence(const Runs& runs) {
  const double change = ratio(runs, "shuffled", "segments, n = 1") - 1;
  return {
      holds_if(std::abs(change) < 0.01),
      text("camera rays from all over the film in a block instead of neighbours: %+.2f %% cycles a segment",
           100 * change)};
}

Judgement any_width(const Runs& runs) {
  const auto efficiency = [&](const char* chip, int pes) {
    const std::string name = std::string(chip) + "width ";
    return 16 / (ratio(runs, name + std::to_string(pes), name + "16") * pes);
  };
  return {
      holds_or_partly(efficiency("", 256) > 0.8, efficiency("", 32) > 0.8),
      text("speed a PE against 16 PEs at 32, 96, 256: %.2f, %.2f, %.2f with the paper's code; %.2f, %.2f, "
           "%.2f with tuned code, whose PEs wait for turns of PIO",
           efficiency("", 32), efficiency("", 96), efficiency("", 256), efficiency("tuned ", 32),
           efficiency("tuned ", 96), efficiency("tuned ", 256))};
}

Judgement radiance_is_small(const Runs& runs) {
  const double share = 1 - seconds(runs, Program::direct, "n = 1") / seconds(runs, Program::full, "n = 1");
  return {holds_or_partly(share < 0.01, share < 0.05),
          text("%.2f %% at n = 1 (the paper's tables: 0.83 %%)", 100 * share)};
}

/// The mean of the longest path among as many as there are PEs, from the distribution of lengths.
double mean_of_longest(const nlohmann::json& paths_by_segments, int pes) {
  double paths = 0;
  for (const auto& [segments, count] : paths_by_segments.items()) paths += count.get<double>();
  std::vector<std::pair<int, double>> by_length;
  for (const auto& [segments, count] : paths_by_segments.items())
    by_length.emplace_back(std::stoi(segments), count.get<double>());
  std::sort(by_length.begin(), by_length.end());
  double mean = 0;
  double up_to = 0;
  double before = 0;
  for (const auto& [segments, count] : by_length) {
    up_to += count / paths;
    const double none_longer = std::pow(up_to, pes);
    mean += segments * (none_longer - before);
    before = none_longer;
  }
  return mean;
}

Judgement slots_are_refilled(const Runs& runs) {
  const ClaimFigures& run = runs.of("segments, n = 1");
  const double enabled = run.kernel("intersect")["simd_efficiency"].get<double>();
  const double longest = mean_of_longest(run.counts()["paths_by_segments"], run.chip()["pes"].get<int>());
  const double mean = run.segments() / run.counts()["paths"].get<double>();
  return {holds_if(enabled > 0.9 && enabled > 2 * mean / longest),
          text("%.1f %% of the PEs have a ray in the intersect kernel, to the run's end; if a block waited "
               "for its "
               "longest path (%.1f segments, of a mean of %.1f), %.1f %%",
               100 * enabled, longest, mean, 100 * mean / longest)};
}

Judgement appending_loads_no_path(const Runs& runs) {
  const auto loaded = [&](const char* name) {
    const ClaimFigures& run = runs.of(name);
    return run.chip()["pio"]["bytes_mono_to_poly"].get<double>() / run.segments();
  };
  const double vertex = sizeof(path_tracer::VertexRecord);
  return {holds_if(loaded("paths of 8") < loaded("paths of 2") + vertex),
          text("bytes loaded a segment: %.0f of paths of 2, %.0f of paths of 8; a vertex has %.0f",
               loaded("paths of 2"), loaded("paths of 8"), vertex)};
}

Judgement buffering_hides_latency(const Runs& runs) {
  const auto waiting = [&](const char* name) {
    return runs.of(name).chip()["exposed_pio_share"].get<double>();
  };
  const ClaimFigures& run = runs.of("segments, n = 1");
  const double calls =
      run.chip()["control_unit"]["cycles_by_cause"]["transfer_call"].get<double>() / run.cycles();
  return {
      holds_if(waiting("segments, n = 1") < 0.1 * waiting("segments, n = 0")),
      text("waits for I/O: %.1f %% of the run at n = 0, %.2f %% at n = 1. Starting the copies, %.0f %%, is "
           "software and stays",
           100 * waiting("segments, n = 0"), 100 * waiting("segments, n = 1"), 100 * calls)};
}

bool is_allowed(int n, int bin_blocks) {
  path_tracer::ProgramConfig program = paper_program();
  program.n = n;
  program.bin_blocks = bin_blocks;
  try {
    path_tracer::validate(program);
    return true;
  } catch (const path_tracer::ProgramError&) {
    return false;
  }
}

Judgement bins_hold_n_blocks(const Runs&) {
  int least = 1;
  while (!is_allowed(4, least)) ++least;
  return {holds_if(least == 4),
          text("n = 4 is refused below %d blocks; --check-hazards finds no misuse at %d", least, least)};
}

Judgement any_length(const Runs& runs) {
  const auto against_two = [&](const char* name) { return ratio(runs, name, "paths of 2"); };
  const double eight = against_two("paths of 8");
  return {holds_if(eight < 1.01),
          text("cycles a segment of paths of 1, 4, 8 against paths of 2: %.3f, %.3f, %.3f times",
               against_two("paths of 1"), against_two("paths of 4"), eight)};
}

Judgement any_pixels(const Runs& runs) {
  const double change = ratio(runs, "selected pixels", "listed pixels") - 1;
  return {
      holds_or_partly(change < 0.02, change < 0.1),
      text("all paths in every sixteenth pixel: %+.2f %% cycles a segment against all pixels in order, both "
           "from a list of pixels; loading the list: %+.2f %%",
           100 * change, 100 * (ratio(runs, "listed pixels", "segments, n = 1") - 1))};
}

Judgement any_deadline(const Runs& runs) {
  const double change = ratio(runs, "twice the samples", "segments, n = 1") - 1;
  return {
      holds_if(std::abs(change) < 0.03),
      text("a pass of twice the samples takes %+.2f %% cycles a segment, so that the time of a pass is known "
           "before it begins",
           100 * change)};
}

Judgement peak_rate(const Runs& runs) {
  const double peak =
      runs.of("segments, n = 1").chip()["roofline"]["peak_flops_per_second"].get<double>() / 1e9;
  const double clock = runs.of("segments, n = 1").chip()["clock_hz"].get<double>() / 1e6;
  return {holds_or_partly(peak > 47.5, peak > 35),
          text("%.1f GFLOPS at %.0f MHz, %.1f at 250 MHz: an addition and a multiplication a cycle and PE",
               peak, clock, peak * 250 / clock)};
}

Judgement scene_on_the_board(const Runs&) {
  const double triangles = double(1u << 30) / sizeof(path_tracer::TriangleRecord);
  return {holds_if(triangles > 1e6), text("a record of a triangle has %d bytes: 1 GiB holds %.1f million",
                                          int(sizeof(path_tracer::TriangleRecord)), triangles / 1e6)};
}

Judgement numbering(const Runs& runs) {
  const ClaimFigures& run = runs.of("segments, n = 1");
  const nlohmann::json kernel = run.kernel("number_ascending");
  const double numbering_cycles = kernel["cycles"].get<double>() / kernel["runs"].get<double>();
  const nlohmann::json& pio = run.chip()["pio"];
  const double requests =
      pio["requests_mono_to_poly"].get<double>() + pio["requests_poly_to_mono"].get<double>();
  const double copy_cycles = (pio["busy_cycles"].get<double>() +
                              run.chip()["control_unit"]["cycles_by_cause"]["transfer_call"].get<double>()) /
                             requests;
  const ClaimFigures& stream = runs.of("stream");
  const double times_the_cycles = stream.cycles_per_segment() / run.cycles_per_segment();
  const auto bytes = [](const ClaimFigures& of) {
    const nlohmann::json& moved = of.chip()["pio"];
    return (moved["bytes_mono_to_poly"].get<double>() + moved["bytes_poly_to_mono"].get<double>()) /
           of.segments();
  };
  return {
      holds_or_partly(times_the_cycles > 1, numbering_cycles < 2 * copy_cycles),
      text("numbering takes %.0f cycles; a save and a load of a block, %.0f. A stream processor's firmware "
           "takes %.2f times the cycles a segment and %.2f times the bytes",
           numbering_cycles, 2 * copy_cycles, times_the_cycles, bytes(stream) / bytes(run))};
}

Judgement time_falls_with_n(const Runs& runs) {
  std::string figure = "from n = 0 to 1, 2, 3:";
  bool falls = true;
  bool stops = true;
  for (const Program program : kPaperPrograms) {
    const double none = seconds(runs, program, "n = 0");
    const double once = seconds(runs, program, "n = 1");
    const double twice = seconds(runs, program, "n = 2");
    const double thrice = seconds(runs, program, "n = 3");
    falls = falls && once < 0.9 * none;
    stops = stops && std::min(twice, thrice) > 0.99 * once;
    figure += text(" %s %+.1f, %+.1f, %+.1f %%%s", name_of(program), 100 * (once / none - 1),
                   100 * (twice / none - 1), 100 * (thrice / none - 1),
                   program == kPaperPrograms.back() ? "" : ";");
  }
  return {holds_or_partly(falls && stops, falls), figure};
}

Judgement gain_by_direction(const Runs& runs) {
  double loads = 0;
  double saves = 0;
  double both = 0;
  for (const Program program : kPaperPrograms) {
    const double none = seconds(runs, program, "n = 0");
    loads += (1 - seconds(runs, program, "loads") / none) / 3;
    saves += (1 - seconds(runs, program, "saves") / none) / 3;
    both += (1 - seconds(runs, program, "n = 1") / none) / 3;
  }
  const auto is_about_a_tenth = [](double gain) { return gain > 0.07 && gain < 0.14; };
  return {
      holds_or_partly(is_about_a_tenth(loads) && is_about_a_tenth(saves) && both > 0.2,
                      is_about_a_tenth(loads) && is_about_a_tenth(saves) && both > 0.17),
      text(
          "loads %.1f %%, saves %.1f %%, both %.1f %%, means of the programs (the paper's tables: 12, 9, 22)",
          100 * loads, 100 * saves, 100 * both)};
}

Judgement ten_doubles(const Runs& runs) {
  const nlohmann::json& pio = runs.of("segments, n = 1").chip()["pio"];
  const double doubles = (pio["bytes_mono_to_poly"].get<double>() + pio["bytes_poly_to_mono"].get<double>()) /
                         pio["pes"].get<double>() / 8;
  return {holds_if(doubles > 5 && doubles < 20), text("%.1f doubles a PE and copy", doubles)};
}

Judgement image_time(const Runs& runs) {
  const double model = seconds(runs, Program::full, "n = 1") * kPaperImageSegments / 1e6;
  const double error = model / kPaperImageSeconds - 1;
  return {holds_if(std::abs(error) < 0.05),
          text("%.0f s by these runs, paper %.0f s (%+.1f %%)", model, kPaperImageSeconds, 100 * error)};
}

Judgement segments_a_second(const Runs& runs) {
  const double bare = 1e6 / seconds(runs, Program::segments, "n = 1");
  return {holds_if(bare > 150000), text("%.0f a second", bare)};
}

Judgement shaded_segments_a_second(const Runs& runs) {
  const double shaded = 1e6 / seconds(runs, Program::direct, "n = 1");
  return {holds_if(shaded > 700000),
          text("%.0f a second; the paper's own table has 75,930, a tenth of its text", shaded)};
}

Judgement temporary_bin_is_full(const Runs& runs) {
  const auto occupied = [&](const char* name) {
    const nlohmann::json& traversal = runs.of(name).counts()["traversal"];
    return traversal["rays_before_tail"].get<double>() / traversal["lanes_before_tail"].get<double>();
  };
  const double bin = occupied("temporary_bin");
  const double faster = ratio(runs, "brute_force", "temporary_bin");
  return {
      holds_or_partly(bin > 0.95 && faster > 1, faster > 1),
      text("%.1f %% of the PEs have a ray until the last pass; waiting for the slowest of a block: %.1f %%. "
           "%.1f times as fast as a test of every triangle",
           100 * bin, 100 * occupied("lock_step"), faster)};
}

Judgement sub_tree_size(const Runs& runs) {
  const char* const sizes[] = {"1", "2", "4", "8"};
  const char* best = sizes[0];
  std::string figure = "cycles a segment with 1, 2, 4, 8 nodes:";
  for (const char* size : sizes) {
    const std::string name = std::string("sub-tree of ") + size;
    if (per_segment(runs, name) < per_segment(runs, std::string("sub-tree of ") + best)) best = size;
    figure += text(" %.0f", per_segment(runs, name));
  }
  const double smallest = ratio(runs, "sub-tree of 1", std::string("sub-tree of ") + best);
  return {holds_if(smallest > 1.01),
          figure + text("; %s are best, one is %.2f times as slow", best, smallest)};
}

Judgement bidirectional_fits(const Runs& runs) {
  const ClaimFigures& both = runs.of("bidirectional");
  const ClaimFigures& from_lens = runs.of("full, n = 1");
  const auto enabled = [](const ClaimFigures& run) {
    return run.kernel("intersect")["simd_efficiency"].get<double>();
  };
  const auto cycles_per_ray = [](const ClaimFigures& run) { return run.cycles() / run.rays(); };
  const nlohmann::json& rays = both.counts()["bidirectional"];
  const double connections = rays["to_lens"].get<double>() + rays["to_lights"].get<double>() +
                             rays["to_light_vertices"].get<double>();
  return {
      holds_if(enabled(both) > 0.95 * enabled(from_lens)),
      text("%.1f %% of the PEs have a ray in the intersect kernel, of paths from the lens %.1f %%; %.1f "
           "connections a path are %.0f %% of the rays; a ray takes %.2f times the cycles",
           100 * enabled(both), 100 * enabled(from_lens), connections / both.counts()["paths"].get<double>(),
           100 * connections / both.rays(), cycles_per_ray(both) / cycles_per_ray(from_lens))};
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "true";
    case Verdict::partly:
      return "partly";
    case Verdict::fails:
      break;
  }
  return "not so";
}

const std::vector<PaperClaim>& paper_claims() {
  static const std::vector<PaperClaim> claims = {
      {"3", "Packets of rays lose their advantage on wide arrays",
       "their cycles against the temporary bin's rise with the width, and exceed them",
       "csx600 sweep sweeps/tree_simd_width.toml", packets_on_wide_arrays},
      {"3", "and after a few bounces", "packets pay a quarter more for bounces than the temporary bin",
       "csx600 render --traversal packets --roulette-start N --max-survival 1e-300", packets_after_bounces},
      {"3", "Binning does not depend on the coherence of rays", "less than 1 % change",
       "csx600 sweep sweeps/coherence.toml", any_coherence},
      {"3", "so it scales with the width of the array", "256 PEs keep 80 % of the speed a PE of 16",
       "csx600 sweep sweeps/simd_width.toml", any_width},
      {"3.1", "Radiance takes less than 1 % of the computation", "less than 1 %", "csx600 reproduce",
       radiance_is_small},
      {"3.2", "A PE whose path has ended goes on with the next path", "nine in ten PEs have a ray",
       "csx600 render --program segments --stats FILE", slots_are_refilled},
      {"3.2", "A vertex is appended without loading the path",
       "paths of 8 load less than a vertex more a segment than paths of 2",
       "csx600 render --roulette-start N --max-survival 1e-300 --stats FILE", appending_loads_no_path},
      {"3.3", "n-buffering hides the latency of loads and saves",
       "n = 1 leaves a tenth of the waits of n = 0", "csx600 render --program segments --n 1 --stats FILE",
       buffering_hides_latency},
      {"3.3", "A bin must be at least n blocks long", "n blocks are the least that is allowed",
       "csx600 render --n 4 --bin-blocks 3", bins_hold_n_blocks},
      {"3.3", "The length of paths is arbitrary; more bounces suffer no penalty",
       "a segment of paths of 8 costs no more than one of paths of 2",
       "csx600 render --program segments --roulette-start N --max-survival 1e-300", any_length},
      {"3.3", "Selective rendering, with few and incoherent pixels, is as fast",
       "less than 2 % more cycles a segment than all pixels", "csx600 render --importance MAP.exr",
       any_pixels},
      {"4", "The chip has 50 GFLOPS of double precision", "47.5 or more", "csx600 render --stats FILE",
       peak_rate},
      {"4", "The board's memory holds all but the most complex scenes", "a million triangles fit",
       "csx600 params", scene_on_the_board},
      {"4", "PEs that succeed get ascending numbers, where a stream processor unloads and reloads",
       "a stream processor's firmware is slower", "csx600 sweep sweeps/stream_n.toml", numbering},
      {"4.1", "Time falls as n rises, and no further after n = 1",
       "a tenth at n = 1, less than 1 % more after", "csx600 reproduce", time_falls_with_n},
      {"4.1", "Loads or saves alone give around 10 %, both just over 20 %", "7 to 14 %, more than 20 %",
       "csx600 reproduce", gain_by_direction},
      {"4.1", "Loads and saves move around ten doubles a PE", "5 to 20", "csx600 render --stats FILE",
       ten_doubles},
      {"4.1", "The image of 480 x 480 with 1000 segments a pixel takes 3036 s", "within 5 %",
       "csx600 reproduce --image", image_time},
      {"4.1", "Just over 150,000 segments a second", "150,000 or more", "csx600 reproduce",
       segments_a_second},
      {"4.1", "750,000 segments a second with a shadow ray each", "700,000 or more", "csx600 reproduce",
       shaded_segments_a_second},
      {"5", "Time-constrained rendering fits the method", "passes differ by less than 3 % a segment",
       "csx600 render --time-budget 2s", any_deadline},
      {"5", "With a temporary bin, full blocks of rays go through a tree",
       "95 % of the PEs, faster than without a tree", "csx600 render --traversal temporary_bin",
       temporary_bin_is_full},
      {"5", "A sub-tree, not a single node, should be loaded at a time (left open: how large)",
       "more than one node is faster", "csx600 sweep sweeps/treelet_size.toml", sub_tree_size},
      {"5", "Bidirectional path tracing fits the bins",
       "as many PEs have a ray as with paths from the lens, but for a twentieth",
       "csx600 render --paths bidirectional", bidirectional_fits},
  };
  return claims;
}

}  // namespace testbench
