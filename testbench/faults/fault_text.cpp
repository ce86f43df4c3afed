#include "testbench/faults/fault_text.hpp"

#include <charconv>
#include <sstream>

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// A key of a fault's text, of those that its kind has.
struct FaultKey {
  const char* name;
  bool has;
  std::uint64_t most;  ///< largest value
};

std::vector<FaultKey> keys_of(const model::FaultKindInfo& kind) {
  constexpr std::uint64_t kMostCycles = std::uint64_t{1} << 60;
  return {{"cycle", true, kMostCycles},
          {"pe", kind.has_pe, 1023},
          {"address", kind.has_address, std::uint64_t{1} << 60},
          {"bit", kind.bits > 0, std::uint64_t(kind.bits) - 1},
          {"late", kind.has_late_cycles, kMostCycles}};
}

std::uint64_t number_of(const std::string& place, const std::string& text, std::uint64_t most) {
  const bool is_hexadecimal = text.rfind("0x", 0) == 0;
  const char* const end = text.data() + text.size();
  std::uint64_t number = 0;
  const auto [stop, error] =
      std::from_chars(text.data() + (is_hexadecimal ? 2 : 0), end, number, is_hexadecimal ? 16 : 10);
  if (error != std::errc() || stop != end || number > most)
    throw InputError(place + ": found '" + text + "', allowed is an integer from 0 to " +
                     std::to_string(most));
  return number;
}

void set(model::Fault& fault, const std::string& key, std::uint64_t value) {
  if (key == "cycle") fault.cycle = value;
  if (key == "pe") fault.pe = int(value);
  if (key == "address") fault.address = value;
  if (key == "bit") fault.bit = int(value);
  if (key == "late") fault.late_cycles = value;
}

std::vector<std::string> split_at_commas(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

void require_place(const model::Fault& fault, const model::ChipConfig& chip) {
  const auto require = [&](const char* key, std::uint64_t found, std::uint64_t end) {
    if (found >= end)
      throw InputError("--fault " + text_of(fault) + ": " + key + ": found " + std::to_string(found) +
                       ", allowed on this chip is below " + std::to_string(end));
  };
  const model::FaultKindInfo& kind = info_of(fault.kind);
  if (kind.has_pe) require("pe", std::uint64_t(fault.pe), std::uint64_t(chip.chip.pes));
  if (fault.kind == model::FaultKind::poly_sram)
    require("address", fault.address, std::uint64_t(chip.poly.sram_bytes));
  if (fault.kind == model::FaultKind::ddr || fault.kind == model::FaultKind::ddr_double)
    require("address", fault.address, chip.ddr.size_bytes);
}

}  // namespace

std::string fault_kind_names() {
  std::string names;
  for (const model::FaultKindInfo& info : model::kFaultKinds)
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  return names;
}

model::FaultKind fault_kind_of(const std::string& name) {
  for (const model::FaultKindInfo& info : model::kFaultKinds)
    if (info.name == name) return info.kind;
  throw InputError("kind of fault: found '" + name + "', allowed is one of " + fault_kind_names());
}

model::Fault fault_of(const std::string& text) {
  const std::vector<std::string> parts = split_at_commas(text);
  model::Fault fault;
  fault.kind = fault_kind_of(parts.empty() ? "" : parts[0]);
  const std::string place = "--fault " + text + ": ";
  std::vector<FaultKey> missing = keys_of(info_of(fault.kind));
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::size_t equals = parts[i].find('=');
    const std::string name = parts[i].substr(0, equals);
    bool known = false;
    for (FaultKey& key : missing) {
      if (!key.has || key.name != name || equals == std::string::npos) continue;
      set(fault, name, number_of(std::string(place).append(name), parts[i].substr(equals + 1), key.most));
      key.has = false;
      known = true;
    }
    if (!known)
      throw InputError(place + "found '" + parts[i] + "', allowed is each of " + text_of({fault.kind}) +
                       " once");
  }
  for (const FaultKey& key : missing)
    if (key.has) throw InputError(place + "found no " + key.name + "=, allowed is one");
  return fault;
}

std::string text_of(const model::Fault& fault) {
  const model::FaultKindInfo& kind = info_of(fault.kind);
  std::string text = std::string(kind.name) + ",cycle=" + std::to_string(fault.cycle);
  if (kind.has_pe) text += ",pe=" + std::to_string(fault.pe);
  if (kind.has_address) text += ",address=" + std::to_string(fault.address);
  if (kind.bits > 0) text += ",bit=" + std::to_string(fault.bit);
  if (kind.has_late_cycles) text += ",late=" + std::to_string(fault.late_cycles);
  return text;
}

void require_faults(const RenderOptions& options) {
  if (options.faults.empty()) return;
  if (options.timing == model::TimingStyle::approximately_timed)
    throw InputError("--fault: found with --timing at, allowed is lt");
  if (options.chip.board.chips > 1 || options.chip.chip.arrays > 1)
    throw InputError("--fault: found with board.chips or chip.arrays above 1, allowed is one array");
  for (const model::Fault& fault : options.faults) require_place(fault, options.chip);
}

}  // namespace testbench
