#include "testbench/run/area.hpp"

namespace testbench {

double Area::mm2() const {
  double sum = 0;
  for (const Part& part : parts) sum += part.mm2;
  return sum;
}

Area area_of(const model::ChipConfig& config) {
  const model::ChipConfig::Area& area = config.area;
  const model::ChipConfig::SearchUnit& unit = config.search_unit;
  Area of;
  of.parts.push_back({"pes", area.pe_mm2 * config.chip.pes * config.chip.arrays});
  of.parts.push_back({"rest", area.rest_mm2});
  if (unit.units == 0) return of;
  constexpr double kKib = 1024;
  const double testers = area.search_box_mm2 * unit.width + area.search_leaf_mm2 / unit.leaf_interval_cycles;
  of.parts.push_back({"search_unit_tests", testers * unit.units});
  of.parts.push_back({"search_unit_queries", area.search_query_mm2 * unit.queries_in_flight * unit.units});
  of.parts.push_back(
      {"search_unit_caches", area.sram_mm2_per_kib * double(unit.cache_bytes) / kKib * unit.units});
  of.parts.push_back({"search_unit_buffer", area.sram_mm2_per_kib * double(unit.buffer_bytes) / kKib});
  return of;
}

}  // namespace testbench
