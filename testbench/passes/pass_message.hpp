#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "testbench/run/render.hpp"

namespace testbench {

/// The paths of a pass: those of `work`, or a list if there is one.
struct PassWork {
  path_tracer::Work work{0, 0};
  std::vector<path_tracer::CameraSampleRecord> list = {};

  bool empty() const { return work.samples == 0 && list.empty(); }
  std::uint64_t paths(int pixels) const {
    return list.empty() ? std::uint64_t(work.samples) * std::uint64_t(pixels) : list.size();
  }
};

void take_work(const PassWork& work, RenderOptions& options);

/// As bytes that work_of() of the same build reads, to send a pass to other ranks.
std::string to_message(const PassWork& work);
PassWork work_of(const std::string& message);

}  // namespace testbench
