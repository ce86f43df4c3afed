#include "testbench/statistics/roofline.hpp"

#include <algorithm>

namespace testbench {
namespace {

using cn::InstructionClass;

double peak_flops_per_cycle(const model::ChipConfig& config) {
  double peak = 0;
  for (std::size_t i = 0; i < cn::kInstructionClasses; ++i)
    if (config.poly.cycles[i] > 0)
      peak = std::max(peak, flops_of(static_cast<InstructionClass>(i)) / config.poly.cycles[i]);
  return peak * config.chip.pes;
}

double pio_bytes_per_cycle(const model::ChipConfig::Pio& pio) {
  return pio.bytes_per_cycle * (pio.arbitration == model::PioArbitration::queue_per_direction ? 2 : 1);
}

}  // namespace

int flops_of(InstructionClass instruction) {
  switch (instruction) {
    case InstructionClass::fp64_add:
    case InstructionClass::fp64_mul:
    case InstructionClass::fp64_div:
    case InstructionClass::fp64_sqrt:
    case InstructionClass::fp64_sincos:
    case InstructionClass::fp64_exp:
    case InstructionClass::fp64_log:
    case InstructionClass::fp64_atan2:
    case InstructionClass::fp32_add:
    case InstructionClass::fp32_mul:
    case InstructionClass::fp32_div:
    case InstructionClass::fp32_sqrt:
      return 1;
    case InstructionClass::fp64_add_vector4:
    case InstructionClass::fp64_mul_vector4:
    case InstructionClass::fp32_add_vector4:
    case InstructionClass::fp32_mul_vector4:
      return 4;
    case InstructionClass::fp64_multiply_add_vector4:
    case InstructionClass::fp32_multiply_add_vector4:
      return 8;
    default:
      return 0;
  }
}

double flops_of(const cn::IssueCounts& executed) {
  double sum = 0;
  for (std::size_t i = 0; i < cn::kInstructionClasses; ++i)
    sum += double(executed.by_class[i]) * flops_of(static_cast<InstructionClass>(i));
  return sum;
}

const Roof& Roofline::nearest() const {
  return *std::max_element(roofs.begin(), roofs.end(),
                           [](const Roof& a, const Roof& b) { return a.share() < b.share(); });
}

const Roof& Roofline::roof(std::string_view name) const {
  return *std::find_if(roofs.begin(), roofs.end(), [name](const Roof& roof) { return roof.name == name; });
}

double Roofline::attainable_flops_per_second() const {
  const double share = nearest().share();
  return share > 0 ? roof("pe_array").attained_per_second / share : roof("pe_array").peak_per_second;
}

double Roofline::intensity(std::string_view name) const {
  const double bytes = roof(name).amount;
  return bytes > 0 ? flops() / bytes : 0;
}

Roofline roofline_of(const ChipStatistics& statistics) {
  const model::ChipConfig& config = statistics.config;
  Roofline roofline;
  const auto add = [&](std::string_view name, double amount, double peak_per_cycle) {
    const double seconds = statistics.seconds();
    roofline.roofs.push_back(
        {name, amount, seconds > 0 ? amount / seconds : 0, peak_per_cycle * config.chip.clock_hz});
  };
  const int arrays = statistics.arrays();
  add("pe_array", flops_of(statistics.all_kernels.executed), arrays * peak_flops_per_cycle(config));
  add("pio", double(statistics.pio.bytes_to_poly + statistics.pio.bytes_to_mono),
      arrays * pio_bytes_per_cycle(config.pio));
  add("clear_connect",
      double(statistics.bus_pio.bytes + statistics.bus_control.bytes + statistics.bus_host.bytes),
      2.0 * arrays * config.clear_connect.bytes_per_cycle);
  add("ddr", double(statistics.ddr.bytes_read + statistics.ddr.bytes_written),
      double(config.board.chips) * config.ddr.bytes_per_cycle);
  return roofline;
}

}  // namespace testbench
