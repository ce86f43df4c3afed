#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace testbench {

inline constexpr const char* kStatisticsFormat = "csx600-statistics-1";

/// The values of a statistics file by key, in the order of the file. What an array's elements are called
/// comes from their "name", or is their index; the chip's parameters are keys of their own
/// ("chip_config.pio.setup_cycles").
using FlatStatistics = std::vector<std::pair<std::string, nlohmann::ordered_json>>;
FlatStatistics flatten(const nlohmann::ordered_json& statistics);

/// Throws InputError, one line that names the file, when it cannot be read, is not JSON, has another format
/// or lacks a counter.
nlohmann::ordered_json read_statistics(const std::string& path);
/// The same of a text that came from `origin`.
nlohmann::ordered_json parse_statistics(const std::string& text, const std::string& origin);

/// For people: values with units, by group.
std::string statistics_text(const nlohmann::ordered_json& statistics);
/// key,unit,value,meaning
std::string statistics_csv(const nlohmann::ordered_json& statistics);
std::string statistics_json(const nlohmann::ordered_json& statistics);
/// By the suffix of the path: .csv, .txt, otherwise JSON.
std::string statistics_for_file(const std::string& path, const nlohmann::ordered_json& statistics);

/// What a key belongs to: "counts", "chip.pio", "chip.pe_array.kernels.intersect".
std::string group_of(const std::string& key);
/// Its unit, "" for what the run was asked to do.
std::string unit_of(const std::string& key);
/// Strings without quotes, the rest as JSON writes it.
std::string value_of(const nlohmann::ordered_json& value);

}  // namespace testbench
