#include "testbench/run/energy.hpp"

#include "testbench/run/technology.hpp"

namespace testbench {
namespace {

using cn::InstructionClass;

constexpr double kPico = 1e-12;
/// A PIO word at the SRAM's port is two of the PE's.
constexpr double kPeWordsPerPioWord = 2;

bool has_cause_of_its_own(InstructionClass c) {
  return c == InstructionClass::sram || c == InstructionClass::sram_vector_load ||
         c == InstructionClass::swazzle || c == InstructionClass::swazzle_vector4 ||
         c == InstructionClass::mono;
}

class Causes {
 public:
  explicit Causes(const ChipStatistics& statistics)
      : run_(statistics),
        table_(statistics.config.energy),
        seconds_(statistics.total_seconds()),
        technology_(technology_factors(statistics.config.technology)),
        scale_(table_.chip_scale * kPico * technology_.energy) {}

  std::vector<Energy::Cause> all() {
    add_instructions();
    const model::ChipConfig& config = run_.config;
    const double poly_sram = sram_access_factor(config.poly.sram_bytes, kReferencePolySramBytes);
    const double pio_words = double(run_.poly_sram.words_in + run_.poly_sram.words_out) * kPeWordsPerPioWord;
    chip("poly_sram",
         poly_sram * (executed(InstructionClass::sram) + executed(InstructionClass::sram_vector_load) +
                      scale_ * pio_words * table_.picojoules[std::size_t(InstructionClass::sram)]));
    chip("swazzle", executed(InstructionClass::swazzle) + executed(InstructionClass::swazzle_vector4));
    chip("pe_clock", scale_ * table_.pe_clock_picojoules * pes() * double(run_.total_cycles));
    chip("control_unit", scale_ * table_.control_unit_picojoules * double(busy_cycles()));
    chip("pio",
         scale_ * table_.pio_picojoules_per_byte * double(run_.pio.bytes_to_poly + run_.pio.bytes_to_mono));
    chip("clear_connect",
         network(config.clear_connect.hops_to_ddr, double(network_bytes()) - sram_bytes()) +
             network(config.on_chip_sram.hops, sram_bytes()) +
             network(config.search_unit.hops - config.clear_connect.hops_to_ddr, search_bytes()));
    if (run_.on_chip_sram.accesses > 0)
      chip("on_chip_sram",
           scale_ * table_.on_chip_sram_picojoules_per_byte * sram_bytes() *
               sram_access_factor(double(config.on_chip_sram.size_bytes), kReferenceOnChipSramBytes));
    if (search_units() > 0) chip("search_unit", search_joules());
    chip("leakage", leakage_watts() * seconds_);
    add_ddr();
    return std::move(causes_);
  }

 private:
  void chip(const std::string& name, double joules) { causes_.push_back({name, joules, false}); }
  void ddr(const std::string& name, double joules) { causes_.push_back({name, joules, true}); }

  double leakage_watts() const {
    const model::ChipConfig& config = run_.config;
    const double sram_kib =
        added_poly_sram_kib(config) * pes() + added_on_chip_sram_kib(config) * config.board.chips;
    return technology_.leakage *
           (table_.leakage_watts * config.board.chips + table_.leakage_watts_per_pe * pes() +
            table_.search_leakage_watts * search_units() + table_.sram_leakage_watts_per_kib * sram_kib);
  }
  /// Of all arrays and chips.
  int pes() const { return run_.config.chip.pes * run_.arrays(); }
  /// Energy of enabled PEs. The code quality factor stands for that many more instructions of the same mix.
  double executed(InstructionClass c) const {
    return scale_ * run_.config.poly.code_quality_factor * table_.picojoules[std::size_t(c)] *
           double(run_.all_kernels.executed[c]);
  }

  std::uint64_t network_bytes() const {
    return run_.bus_pio.bytes + run_.bus_control.bytes + run_.bus_host.bytes + run_.bus_search_unit.bytes;
  }
  double sram_bytes() const { return double(run_.on_chip_sram.bytes_read + run_.on_chip_sram.bytes_written); }
  /// Through the port of the search units' buffer.
  double search_bytes() const { return double(run_.search_unit.bytes_read + run_.search_unit.bytes_written); }
  int search_units() const { return run_.config.search_unit.units * run_.config.board.chips; }
  double search_joules() const {
    const model::SearchStatistics& search = run_.search_unit;
    const double unit_cycles =
        double(run_.total_cycles) * search_units() / run_.config.search_unit.clock_divider;
    const double lines = double(search.cache_hits + search.cache_joins) + 2 * double(search.cache_misses);
    return scale_ *
           (table_.search_box_picojoules * double(search.node_tests) +
            table_.search_leaf_picojoules * double(search.leaf_tests) +
            table_.search_line_picojoules * lines + table_.search_picojoules_per_byte * search_bytes() +
            table_.search_clock_picojoules * unit_cycles);
  }
  /// Energy of `bytes` that went from node to node `hops` times.
  double network(int hops, double bytes) const {
    return scale_ * table_.clear_connect_picojoules * hops * bytes;
  }

  void add_instructions() {
    for (std::size_t i = 0; i < cn::kInstructionClasses; ++i) {
      const auto c = static_cast<InstructionClass>(i);
      if (!has_cause_of_its_own(c) && run_.all_kernels.executed[c] != 0)
        chip(std::string(cn::kInstructionClassNames[i]), executed(c));
    }
  }

  model::Cycles busy_cycles() const {
    return run_.control.total() - run_.control.exposed_pio() - run_.control[model::CycleCause::wait_host];
  }

  void add_ddr() {
    ddr("ddr_activate", kPico * table_.ddr_activate_picojoules * double(run_.ddr.page_misses));
    ddr("ddr_read", kPico * table_.ddr_read_picojoules * double(run_.ddr.bytes_read));
    ddr("ddr_write", kPico * table_.ddr_write_picojoules * double(run_.ddr.bytes_written));
    ddr("ddr_refresh", kPico * table_.ddr_refresh_picojoules * double(run_.ddr.refreshes));
    ddr("ddr_background", table_.ddr_background_watts * run_.config.board.chips * seconds_);
  }

  const ChipStatistics& run_;
  const model::ChipConfig::Energy& table_;
  double seconds_;
  TechnologyFactors technology_;
  double scale_;
  std::vector<Energy::Cause> causes_;
};

double sum(const std::vector<Energy::Cause>& causes, bool in_ddr) {
  double joules = 0;
  for (const Energy::Cause& cause : causes)
    if (cause.in_ddr == in_ddr) joules += cause.joules;
  return joules;
}

}  // namespace

double Energy::chip_joules() const {
  return sum(causes, false);
}

double Energy::ddr_joules() const {
  return sum(causes, true);
}

Energy energy_of(const ChipStatistics& statistics) {
  return {Causes(statistics).all(), statistics.total_seconds()};
}

}  // namespace testbench
