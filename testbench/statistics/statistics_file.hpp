#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace testbench {

inline constexpr const char* kStatisticsFormat = "csx600-statistics-2";  ///< of a render
/// Of a firmware that `csx600 run` ran: its options and counters, its work, what the chip counted.
inline constexpr const char* kRunStatisticsFormat = "csx600-run-1";

/// Throws InputError, one line that names the file, for another format than these two.
void require_statistics_format(const std::string& format, const std::string& origin);

/// The values of a statistics file by key, in the order of the file: "chip_config.pio.setup_cycles". An
/// element of an array is called by its "name", or by its index if it has none.
using FlatStatistics = std::vector<std::pair<std::string, nlohmann::ordered_json>>;
FlatStatistics flatten(const nlohmann::ordered_json& statistics);

/// Throws InputError, one line that names the file, when it cannot be read, is not JSON, has another format,
/// calls a counter by an old name (renamed_keys.hpp) or lacks one.
nlohmann::ordered_json read_statistics(const std::string& path);
/// The same for a text that came from `origin`.
nlohmann::ordered_json parse_statistics(const std::string& text, const std::string& origin);

/// Checks the statistics of a sweep's point, which have no section `simulator`, as parse_statistics() does.
void require_point_statistics(const nlohmann::ordered_json& json, const std::string& origin);

/// Text for people: values with units, by group.
std::string statistics_text(const nlohmann::ordered_json& statistics);
/// key,unit,value,meaning
std::string statistics_csv(const nlohmann::ordered_json& statistics);
std::string statistics_json(const nlohmann::ordered_json& statistics);
/// In the form of the suffix of the path: .csv, .txt, otherwise JSON.
std::string statistics_for_file(const std::string& path, const nlohmann::ordered_json& statistics);

inline const std::string& key_of(const FlatStatistics::value_type& value) {
  return value.first;
}
/// The last part of a key: "busy_cycles".
std::string name_of(const std::string& key);
/// The group of a key: "counts", "chip.pio", "chip.pe_array.kernels.intersect".
std::string group_of(const std::string& key);
/// The unit of a key, "" for what the run was asked to do.
std::string unit_of(const std::string& key);
/// Strings without quotes, the rest as JSON writes it.
std::string value_of(const nlohmann::ordered_json& value);

/// Puts the items of a group together; groups and keys stay in their order otherwise. key_of() knows the key
/// of an item.
template <class Item>
std::vector<Item> grouped(const std::vector<Item>& items) {
  std::unordered_map<std::string, std::size_t> place_of;
  std::vector<std::vector<Item>> by_group;
  for (const Item& item : items) {
    const auto [place, is_first] = place_of.emplace(group_of(key_of(item)), by_group.size());
    if (is_first) by_group.emplace_back();
    by_group[place->second].push_back(item);
  }
  std::vector<Item> all;
  for (const std::vector<Item>& group : by_group) all.insert(all.end(), group.begin(), group.end());
  return all;
}

}  // namespace testbench
