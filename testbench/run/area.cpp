#include "testbench/run/area.hpp"

#include "testbench/run/technology.hpp"

namespace testbench {
namespace {

void add_search_unit(const model::ChipConfig& config, Area& of) {
  const model::ChipConfig::Area& area = config.area;
  const model::ChipConfig::SearchUnit& unit = config.search_unit;
  constexpr double kKib = 1024;
  const double testers = area.search_box_mm2 * unit.width + area.search_leaf_mm2 / unit.leaf_interval_cycles;
  of.parts.push_back({"search_unit_tests", testers * unit.units});
  of.parts.push_back({"search_unit_queries", area.search_query_mm2 * unit.queries_in_flight * unit.units});
  of.parts.push_back(
      {"search_unit_caches", area.sram_mm2_per_kib * double(unit.cache_bytes) / kKib * unit.units});
  of.parts.push_back({"search_unit_buffer", area.sram_mm2_per_kib * double(unit.buffer_bytes) / kKib});
}

}  // namespace

double Area::mm2() const {
  double sum = 0;
  for (const Part& part : parts) sum += part.mm2;
  return sum;
}

Area area_of(const model::ChipConfig& config) {
  const model::ChipConfig::Area& area = config.area;
  const int pes = config.chip.pes * config.chip.arrays;
  Area of;
  of.parts.push_back({"pes", (area.pe_mm2 + area.sram_mm2_per_kib * added_poly_sram_kib(config)) * pes});
  of.parts.push_back({"rest", area.rest_mm2 + area.sram_mm2_per_kib * added_on_chip_sram_kib(config)});
  if (config.search_unit.units > 0) add_search_unit(config, of);
  const double scale = technology_factors(config.technology).area;
  for (Area::Part& part : of.parts) part.mm2 *= scale;
  return of;
}

}  // namespace testbench
