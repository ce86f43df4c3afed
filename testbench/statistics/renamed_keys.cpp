#include "testbench/statistics/renamed_keys.hpp"

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

bool is_at_or_below(std::string_view key, std::string_view section) {
  return key.substr(0, section.size()) == section &&
         (key.size() == section.size() || key[section.size()] == '.');
}

}  // namespace

const std::vector<RenamedKey>& renamed_keys() {
  static const std::vector<RenamedKey> keys = {
      {"host", "simulator"},  // the chip's parameters host.* are chip_config.host.* in statistics
      {"chip.host_link.host_dmas", "chip.host_link.transfers"},
      {"chip.pe_array.kernels.replace", "chip.pe_array.kernels.continue_paths"},
  };
  return keys;
}

std::string new_name_of(std::string_view key) {
  for (const RenamedKey& renamed : renamed_keys())
    if (is_at_or_below(key, renamed.old_key))
      return std::string(renamed.new_key).append(key.substr(renamed.old_key.size()));
  return "";
}

void require_current_key(const std::string& origin, std::string_view key) {
  const std::string new_name = new_name_of(key);
  if (new_name.empty()) return;
  throw InputError(origin + ": " + std::string(key) + ": found the key's old name, allowed is " + new_name);
}

void require_current_keys(const std::string& origin, const FlatStatistics& statistics) {
  for (const auto& [key, value] : statistics) require_current_key(origin, key);
}

}  // namespace testbench
