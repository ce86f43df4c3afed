#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "testbench/sweep/replay.hpp"
#include "testbench/sweep/sweep_points.hpp"

namespace testbench {

/// How the work on a point is to be done.
enum class PointMode : std::uint8_t { full, replay, audit };

/// Runs one point and returns a PointStore line: status "done" with `how`, `audited`, `simulator_cpu_seconds`
/// and the statistics file's content without its section `simulator`. At most one a process. Throws as
/// render_on_chip() does, and RunError when an audit finds a difference.
/// @param recording of the point's stream; may be null for PointMode::full
std::string run_point(const SweepPoint& point, const Recording* recording, PointMode mode);

/// The line of a point that failed; it keeps the first line of the message.
nlohmann::ordered_json failed_point(const std::string& message);

/// The first number or text that differs between two files of statistics, as "path: a, b"; "" when equal.
std::string first_difference(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

}  // namespace testbench
