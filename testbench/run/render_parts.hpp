#pragma once

#include <optional>
#include <vector>

#include "testbench/run/render.hpp"

namespace testbench {

/// What is kept of a render that ran in a process of its own.
struct PartialRender {
  Film film;
  std::uint64_t segments = 0;
  double cpu_seconds = 0;                   ///< spent on rendering
  std::optional<double> simulated_seconds;  ///< of a run on the chip
  std::optional<double> joules;             ///< of a run on the chip: chip and memory
};

enum class MachineKind : std::uint8_t { native, chip };

/// Renders each part of the work in a process of its own, all at the same time, and returns them in order;
/// `options.work` is replaced. Throws as render_on_chip() does.
std::vector<PartialRender> render_parts(const Scene& scene, const RenderOptions& options, MachineKind machine,
                                        const std::vector<path_tracer::Work>& parts);

/// Splits work into parts of at most `samples` samples a pixel.
std::vector<path_tracer::Work> split_work(const path_tracer::Work& work, int samples);

}  // namespace testbench
