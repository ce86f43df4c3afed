#pragma once

#include "testbench/machine/timing_stream.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/run/render.hpp"

namespace testbench {

/// A render that was run once, for other chips to be timed with.
struct Recording {
  MonoImage image;      ///< what the host uploads
  TimingStream stream;  ///< what the firmware then asks of its machine
  RenderResult result;  ///< film and counts; no chip
};

/// Renders natively and records. Throws as render_natively() does.
Recording record_render(const Scene& scene, const RenderOptions& options);

/// What render_on_chip() would return, to the cycle and in every statistic, without running a kernel. Only
/// parameters may differ from the recorded run's that cannot change its stream (ParameterInfo::effect). At
/// most one a process. Throws as render_on_chip() does.
RenderResult replay_on_chip(const Recording& recording, const RenderOptions& options);

}  // namespace testbench
