#include "testbench/run/render_parts.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "testbench/run/energy.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

/// Comes before the film's bytes.
struct PartHeader {
  std::uint64_t segments = 0;
  double cpu_seconds = 0;
  bool is_of_chip = false;
  double simulated_seconds = 0;
  double joules = 0;
};

std::string encode(const RenderResult& result) {
  PartHeader header;
  header.segments = result.counts.segments;
  header.cpu_seconds = result.cpu_seconds;
  header.is_of_chip = result.chip.has_value();
  if (header.is_of_chip) {
    header.simulated_seconds = result.chip->seconds();
    header.joules = energy_of(*result.chip).joules();
  }
  std::string bytes(sizeof(header), '\0');
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes + result.film.bytes();
}

PartialRender decode(const Scene& scene, FilmSums sums, const std::string& bytes) {
  PartHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  PartialRender part{Film::from_bytes(scene.film, film_scale(scene), sums, bytes.substr(sizeof(header))),
                     header.segments,
                     header.cpu_seconds,
                     {},
                     {}};
  if (header.is_of_chip) {
    part.simulated_seconds = header.simulated_seconds;
    part.joules = header.joules;
  }
  return part;
}

}  // namespace

std::vector<PartialRender> render_parts(const Scene& scene, const RenderOptions& options, MachineKind machine,
                                        const std::vector<path_tracer::Work>& parts) {
  std::vector<std::function<std::string()>> jobs;
  for (const path_tracer::Work& work : parts) {
    RenderOptions of_part = options;
    of_part.work = work;
    jobs.emplace_back([&scene, of_part, machine] {
      return encode(machine == MachineKind::native ? render_natively(scene, of_part)
                                                   : render_on_chip(scene, of_part));
    });
  }
  std::vector<PartialRender> results;
  for (const std::string& bytes : run_in_processes(jobs, static_cast<int>(jobs.size())))
    results.push_back(decode(scene, options.film_sums, bytes));
  return results;
}

std::vector<path_tracer::Work> split_work(const path_tracer::Work& work, int samples) {
  std::vector<path_tracer::Work> parts;
  for (int done = 0; done < work.samples; done += samples)
    parts.push_back({work.first_sample + done, std::min(samples, work.samples - done)});
  return parts;
}

}  // namespace testbench
