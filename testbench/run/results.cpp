#include "testbench/run/results.hpp"

#include "testbench/system/error.hpp"

namespace testbench {

void ResultReader::fetch(const Read& read) {
  path_tracer::ResultsHeader header;
  read(layout_.results_header[half_].address, &header, sizeof(header));
  records_.resize(std::size_t(header.records));
  read(layout_.results[half_].address, records_.data(),
       records_.size() * sizeof(path_tracer::RadianceRecord));
  constexpr std::size_t kAhead = 16;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const path_tracer::RadianceRecord& record = records_[i];
    if (i + kAhead < records_.size()) film_.prefetch(records_[i + kAhead].pixel);
    if (record.pixel < 0) continue;
    const glm::dvec3 radiance(record.radiance.x, record.radiance.y, record.radiance.z);
    if (record.sample == path_tracer::kSplatSample)
      film_.add_splat(record.pixel, radiance);
    else
      film_.add(record.pixel, radiance);
  }
  half_ = 1 - half_;
}

void require_no_rejected_samples(const Film& film) {
  const RejectedSamples& rejected = film.rejected();
  if (film.rejected_samples() == 0) return;
  throw RunError("the film refused " + std::to_string(film.rejected_samples()) +
                 " samples: " + std::to_string(rejected.not_finite) + " not finite, " +
                 std::to_string(rejected.negative) + " negative, " + std::to_string(rejected.too_large) +
                 " above " + std::to_string(film.max_radiance()));
}

}  // namespace testbench
