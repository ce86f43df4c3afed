#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "firmware/path_tracer/program/layout.hpp"
#include "testbench/film/film.hpp"

namespace testbench {

/// Fetches the halves of the results as the firmware announces them and puts finished paths on the film.
class ResultReader {
 public:
  /// Copies bytes out of mono memory.
  using Read = std::function<void(cn::MonoAddress from, void* to, std::size_t bytes)>;

  ResultReader(const path_tracer::Layout& layout, Film& film) : layout_(layout), film_(film) {}

  /// The next half, which the firmware has announced.
  void fetch(const Read& read);

 private:
  const path_tracer::Layout& layout_;
  Film& film_;
  std::vector<path_tracer::RadianceRecord> records_;
  int half_ = 0;
};

/// Throws RunError when the film refused a sample: no run may end with a radiance that is not finite,
/// negative or beyond the film's range.
void require_no_rejected_samples(const Film& film);

}  // namespace testbench
