#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "testbench/sweep/point_store.hpp"
#include "testbench/sweep/sweep_points.hpp"

namespace testbench {

/// What a sweep writes into its directory.
inline constexpr const char* kSweepFiles[] = {"sweep.json", "sweep.csv", "columns.csv", "points.jsonl"};

inline constexpr const char* kSweepFormat = "csx600-sweep-1";

/// Whether tables have the results of each kernel.
enum class KernelColumns : bool { left_out, shown };

/// All points in the order of the sweep, those that are not finished as status "missing":
/// { format, keys, axes: [[keys that change together]], base, points: [{ inputs, status, error, chosen,
/// results: { name: number } }] }. The same bytes for the same sweep, however it was run.
nlohmann::ordered_json sweep_json(const Sweep& sweep, const PointStore& store,
                                  KernelColumns kernels = KernelColumns::left_out);

/// Texts of CSV files.
struct SweepTables {
  std::string points;  ///< one a row: inputs, status, error, what was chosen, every result that any point has
  std::string columns;  ///< the dictionary of its columns (columns_csv())
};

/// @param json of sweep_json()
SweepTables sweep_tables(const Sweep& sweep, const nlohmann::ordered_json& json);

/// A value of a setting as JSON has it: a number where it is one.
nlohmann::ordered_json typed(const std::string& value);

}  // namespace testbench
