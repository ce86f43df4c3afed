#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "testbench/sweep/point_store.hpp"
#include "testbench/sweep/sweep_points.hpp"

namespace testbench {

/// What a sweep writes into its directory.
inline constexpr const char* kSweepFiles[] = {"sweep.json", "sweep.csv", "points.jsonl"};

inline constexpr const char* kSweepFormat = "csx600-sweep-1";

/// All points in the order of the sweep, those that are not finished as status "missing":
/// { format, keys, axes: [[keys that change together]], base, points: [{ inputs, status, error, results: {
/// name: number } }] }. Results are the numbers of the statistics file, named by their path in it, after
/// rates and utilisations made of them. The same bytes for the same sweep, however it was run.
nlohmann::ordered_json sweep_json(const Sweep& sweep, const PointStore& store);

/// The points of sweep_json() as CSV, one a row: inputs, status, error, then every result that any point has.
std::string sweep_csv(const nlohmann::ordered_json& sweep);

/// A value of a setting as JSON has it: a number where it is one.
nlohmann::ordered_json typed(const std::string& value);

}  // namespace testbench
