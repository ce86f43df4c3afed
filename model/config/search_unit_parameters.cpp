#include "model/config/parameter_declaration.hpp"

// The search unit is not the CSX600's: its cycles are those that a pipeline at the chip's clock would take,
// its areas those of its operators, at 130 nm.
//
//   40 nm to 130 nm: (130 / 40)^2 = 10.6 times the area
//   a box:      6 fp32 subtractions, 6 fp32 multiplications, and a tenth for comparisons
//   a triangle: 18 fp64 multiplications, 15 fp64 additions, and a quarter for what tells ties apart
//               (firmware/path_tracer/geometry/triangle.hpp)

namespace model {
namespace {

constexpr std::int64_t kMostCycles = 1'000'000;

/// What is written, and so how the firmware runs, depends on these.
ParameterInfo of_stream(ParameterInfo parameter) {
  parameter.effect = Effect::stream;
  return parameter;
}

}  // namespace

void declare_search_unit(std::vector<ParameterInfo>& table) {
  constexpr auto group = &ChipConfig::search_unit;
  constexpr Confidence assumed = Confidence::assumed;
  using Unit = ChipConfig::SearchUnit;
  table.push_back(of_stream(integer<group, &Unit::units>(
      "search_unit.units", "units", 0, {0, 64}, assumed,
      "fixed-function units that find rays' triangles beside the PEs, as in [RPU]; the CSX600 has none")));
  table.push_back(
      integer<group, &Unit::width>("search_unit.width", "boxes", 4, {1, 8}, assumed,
                                   "boxes that a unit tests at a time: a node of four in one cycle; 1 to 8"));
  table.push_back(integer<group, &Unit::queries_in_flight>(
      "search_unit.queries_in_flight", "queries", 32, {1, 1024}, assumed,
      "rays in flight in each unit, which hide its latencies as threads do in [RPU]; 8 to 64"));
  table.push_back(integer<group, &Unit::node_cycles>(
      "search_unit.node_cycles", "cycles", 16, {1, kMostCycles}, assumed,
      "from the start of a node's last test to the next step: two fp32 operations of 4 stages each, "
      "comparisons, sorting; 8 to 32"));
  table.push_back(integer<group, &Unit::leaf_cycles>(
      "search_unit.leaf_cycles", "cycles", 32, {1, kMostCycles}, assumed,
      "from the start of a leaf's last test to the next step: five fp64 operations of 6 stages each in a "
      "row; 16 to 64"));
  table.push_back(integer<group, &Unit::leaf_interval_cycles>(
      "search_unit.leaf_interval_cycles", "cycles", 1, {1, 1024}, assumed,
      "from the start of a triangle's test to that of the next; a unit with an n-th of the multipliers takes "
      "n"));
  table.push_back(integer<group, &Unit::clock_divider>("search_unit.clock_divider", "cycles", 1, {1, 64},
                                                       assumed, "cycles of the chip for one of the unit's"));
  table.push_back(
      integer<group, &Unit::cache_bytes>("search_unit.cache_bytes", "bytes", 16384, {64, 1 << 24, 64},
                                         assumed, "cache of each unit for nodes and triangles; 4 to 64 KiB"));
  table.push_back(integer<group, &Unit::cache_line_bytes>(
      "search_unit.cache_line_bytes", "bytes", 64, {8, 4096, 8}, assumed, "a line: a packet of the network"));
  table.push_back(integer<group, &Unit::cache_ways>("search_unit.cache_ways", "ways", 4, {1, 64}, assumed,
                                                    "places that a line may have; the oldest is replaced"));
  table.push_back(integer<group, &Unit::cache_hit_cycles>(
      "search_unit.cache_hit_cycles", "cycles", 2, {0, kMostCycles}, assumed,
      "from the look-up of a line, one a cycle, to its data"));
  table.push_back(of_stream(integer<group, &Unit::buffer_bytes>(
      "search_unit.buffer_bytes", "bytes", 131072, {1024, 1 << 24, 64}, assumed,
      "rays and hits of all units together; 104 bytes a ray or more, so bins of 8 blocks of 96 fit")));
  table.push_back(of_stream(integer<group, &Unit::first_address>(
      "search_unit.first_address", "address", std::int64_t{1} << 41,
      {0, std::int64_t{1} << 60, std::int64_t{1} << 16}, assumed,
      "mono address of the buffer's first byte: above the on-chip SRAM, with a hole between")));
  table.push_back(integer<group, &Unit::bytes_per_cycle>(
      "search_unit.bytes_per_cycle", "bytes/cycle", 16, {1, 4096}, assumed,
      "at the buffer's one port, taken as wide as that of the on-chip SRAM"));
  table.push_back(
      integer<group, &Unit::hops>("search_unit.hops", "hops", 2, {0, 64}, assumed,
                                  "from the PIO engine to the buffer, as clear_connect.hops_to_ddr"));
}

void declare_area(std::vector<ParameterInfo>& table) {
  constexpr auto group = &ChipConfig::area;
  constexpr Confidence assumed = Confidence::assumed;
  constexpr Confidence inferred = Confidence::inferred;
  constexpr RealRange kAnyArea = {0, 1e6};
  using Area = ChipConfig::Area;
  table.push_back(real<group, &Area::pe_mm2>("area.pe_mm2", "mm2", 0.8, kAnyArea, inferred,
                                             "a PE with 6 KiB at 130 nm: fp64 multiplier and adder 0.26 "
                                             "[Aladdin], SRAM of 6 KiB 0.19 [CACTI], the rest "
                                             "assumed; 0.6 to 1.0"));
  table.push_back(real<group, &Area::rest_mm2>("area.rest_mm2", "mm2", 80, kAnyArea, assumed,
                                               "mono processor, caches, 128 KiB of on-chip SRAM, network, "
                                               "interfaces and pads; 50 to 130, no die photo is public"));
  table.push_back(real<group, &Area::search_box_mm2>(
      "area.search_box_mm2", "mm2", 0.64, kAnyArea, inferred,
      "tester of a box: 6 x (fp32 add 0.003 + multiply 0.0062) at 40 nm [Aladdin], x 10.6 x 1.1; within a "
      "factor of 2"));
  table.push_back(real<group, &Area::search_leaf_mm2>(
      "area.search_leaf_mm2", "mm2", 5.5, kAnyArea, inferred,
      "tester of a triangle: 18 fp64 multiply 0.0181 + 15 add 0.0061 at 40 nm [Aladdin], x 10.6 x 1.25; "
      "divided by search_unit.leaf_interval_cycles; within a factor of 2"));
  table.push_back(real<group, &Area::search_query_mm2>(
      "area.search_query_mm2", "mm2", 0.02, kAnyArea, inferred,
      "a ray in flight: 200 bytes of ray, hit and stack in SRAM, twice that for ports [CACTI]; within a "
      "factor of 3"));
  table.push_back(
      real<group, &Area::sram_mm2_per_kib>("area.sram_mm2_per_kib", "mm2/KiB", 0.03, kAnyArea, inferred,
                                           "SRAM of PEs beyond 6 KiB, on_chip_sram beyond 128 KiB, search "
                                           "units' caches and buffer: 0.241 for 8 KiB, 0.887 for "
                                           "32, 3.64 for 128 [CACTI]; macros with test logic are up "
                                           "to twice that"));
}

}  // namespace model
