#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

#include "testbench/plug_in/plug_in_run.hpp"
#include "testbench/sweep/replay.hpp"
#include "testbench/sweep/sweep_points.hpp"

namespace testbench {

/// How the work on a point is to be done.
enum class PointMode : std::uint8_t { full, replay, audit };

/// A run of a point's stream, for other chips to be timed with.
using PointRecording = std::variant<Recording, PlugInRecording>;

/// Runs the point natively and records. Throws as record_render() or record_plug_in() does.
PointRecording record_point(const SweepPoint& point);

/// Runs one point and returns a PointStore line: status "done" with `how`, `audited`, `simulator_cpu_seconds`
/// and the statistics file's content without its section `simulator`. At most one a process. Throws as
/// render_on_chip() or run_plug_in() does, and RunError when an audit finds a difference.
/// @param recording of the point's stream; may be null for PointMode::full
std::string run_point(const SweepPoint& point, const PointRecording* recording, PointMode mode);

/// The line of a point that failed; it keeps the first line of the message.
nlohmann::ordered_json failed_point(const std::string& message);

/// The first number or text that differs between two files of statistics, as "path: a, b"; "" when equal.
std::string first_difference(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

}  // namespace testbench
