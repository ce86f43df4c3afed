#include "firmware/path_tracer/resident/resident_tracer.hpp"

#include <algorithm>
#include <numeric>

#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {
namespace {

/// Instructions of the control unit for a round: tests and loop (assumed).
constexpr std::uint64_t kRoundInstructions = 24;

void require_plain(const Layout& layout, const Work& work) {
  const auto refuse = [](const std::string& found) {
    throw ProgramError("resident_paths: found " + found +
                       "; allowed with it are scenes of diffuse triangles without textures, lit by triangles "
                       "alone, none of which lie on one another, and the same samples for every pixel");
  };
  const Features& features = layout.features;
  if (!features.lobes.only_diffuse()) refuse("a material that is not only diffuse");
  if (features.textures.any() || features.coverage) refuse("textures or coverage");
  if (features.environment || features.lights.without_triangles()) refuse("light that no triangle emits");
  if (features.normals) refuse("normals that vary over triangles");
  if (features.multiple_importance) refuse("estimator mis");
  if (layout.layers.any) refuse("triangles that lie on one another");
  if (work.listed_samples > 0) refuse("a list of samples");
}

cn::Machine& checked_machine(cn::Machine& machine, const ProgramConfig& config, const Layout& layout,
                             const Work& work) {
  validate(config);
  require_plain(layout, work);
  return with_semaphores_and_stack(machine);
}

int pixels_of(cn::Machine& machine, const Layout& layout) {
  const CameraRecord& camera = *machine.read_mono(layout.camera);
  return camera.width * camera.height;
}

std::uint64_t count_of(const PathMasks& masks) {
  std::uint64_t count = 0;
  for (const cn::LaneMask& mask : masks) count += std::uint64_t(mask.count());
  return count;
}

}  // namespace

ResidentTracer::ResidentTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                               const Layout& layout, const Work& work)
    : machine_(checked_machine(machine, config, layout, work)),
      kernels_(kernels.resident()),
      config_(config),
      layout_(layout),
      camera_rays_(work, pixels_of(machine, layout)),
      paths_(config.resident_paths),
      surfaces_(
          machine.poly_memory().allocate("surfaces", layout.triangle_count * int{sizeof(SurfaceRecord)})),
      lights_(machine.poly_memory().allocate("lights", layout.light_count * int{sizeof(LightRecord)})),
      path_records_(machine.poly_memory().allocate("paths", paths_ * int{sizeof(ResidentPath)})),
      number_{machine.poly_memory().allocate("ascending numbers", sizeof(std::int32_t)).offset_bytes},
      results_(machine, kernels.resident(), layout),
      loaded_(machine.allocate_semaphore("scene loaded")),
      segments_(std::size_t(paths_) * std::size_t(machine.num_pes())) {
  if (paths_ > 1)
    vectors_ = machine.poly_memory().allocate("vectors", kSearchVectors * 4 * int{sizeof(double)});
  const int pixels = camera_rays_.pixels();
  if (pixels > 1 && std::gcd(config.pixel_stride, pixels) != 1)
    throw ProgramError("pixel_stride: found " + std::to_string(config.pixel_stride) +
                       ", which has a divisor in common with the " + std::to_string(pixels) +
                       " pixels of the film; allowed is any number without");
}

void ResidentTracer::run(const Progress& progress) {
  load_scene();
  results_.begin();
  for (int place = 0; place < paths_; ++place) ended_[std::size_t(place)] = all_pes();
  start_paths();
  ended_ = {};  // no path was in those places
  while (is_anything_left()) {
    if (progress && !progress(camera_rays_.issued())) camera_rays_.stop();
    machine_.issue_mono(kRoundInstructions);
    search();
    shade();
    if (machine_.count(nearly_full_) > 0) results_.flush();
    start_paths();
  }
  results_.flush();
  results_.announce();
  counts_.paths = camera_rays_.issued();
}

/// All PEs ask for the same bytes, piece by piece.
void ResidentTracer::load(cn::PolySpan to, cn::MonoAddress from) {
  if (to.size_bytes == 0) return;
  machine_.async_copy_m2p(loaded_, to, cn::MonoPlaces::array(from, 0), all_pes());
  machine_.sem_wait(loaded_);
}

void ResidentTracer::load_scene() {
  machine_.set_label({"scene load", 0});
  load(surfaces_, layout_.surfaces.address);
  load(lights_, layout_.lights.address);
}

void ResidentTracer::start_paths() {
  machine_.set_label({"path start", 0});
  const auto remaining = static_cast<std::int32_t>(std::min<std::uint64_t>(
      camera_rays_.remaining(), std::uint64_t(machine_.num_pes()) * std::uint64_t(paths_)));
  PathMasks started{};
  if (remaining > 0) {
    const int ended = machine_.number_ascending(ended_.data(), paths_, number_);
    ResidentStartArguments arguments;
    arguments.paths = path_records_;
    arguments.path_count = paths_;
    arguments.ended = &ended_;
    arguments.number = number_;
    arguments.remaining = std::min(remaining, ended);
    arguments.camera = machine_.read_mono(layout_.camera);
    arguments.camera_rays = {camera_rays_.next_pixel(), camera_rays_.next_sample(),
                             config_.pixel_stride % camera_rays_.pixels()};
    arguments.sampler = config_.sampler;
    arguments.seed = config_.seed;
    arguments.started = &started;
    machine_.run(kernels_.start, arguments, all_pes());
    camera_rays_.issue(std::uint64_t(arguments.remaining));
  }
  for (std::size_t place = 0; place < std::size_t(paths_); ++place)
    live_[place] = live_[place].without(ended_[place]).with(started[place]);
}

void ResidentTracer::search() {
  machine_.set_label({"segment search", 0});
  search(path_records_.part(&ResidentPath::segment), live_);
  machine_.set_label({"shadow ray search", 0});
  if (pes_with(casts_).any()) search(path_records_.part(&ResidentPath::shadow), casts_);
}

void ResidentTracer::search(PolyPointer<ResidentRay> rays, const PathMasks& wanted) {
  ResidentSearchArguments arguments;
  arguments.rays = rays;
  arguments.vectors = vectors_;
  arguments.wanted = &wanted;
  arguments.triangle_count = layout_.triangle_count;
  arguments.triangles = read_triangles(machine_, layout_, 0, layout_.triangle_count);
  arguments.reach = layout_.reach;
  machine_.run(paths_ > 1 ? kernels_.search_by_vectors : kernels_.search, arguments, pes_with(wanted));
}

void ResidentTracer::shade() {
  machine_.set_label({"shading", 0});
  PathMasks reflecting{};
  count_searched();
  nearly_full_ = {};
  ResidentShadeArguments arguments;
  arguments.paths = path_records_;
  arguments.path_count = paths_;
  arguments.surfaces = PolyPointer<SurfaceRecord>(surfaces_);
  arguments.lights = PolyPointer<LightRecord>(lights_);
  arguments.casts_shadow_rays = config_.casts_shadow_rays() && layout_.light_count > 0;
  if (arguments.casts_shadow_rays) arguments.light_table = read_light_table(machine_, layout_);
  arguments.cull_shadow_rays = config_.cull_shadow_rays;
  arguments.sampler = config_.sampler;
  arguments.light_sampling = config_.light_sampling;
  arguments.seed = config_.seed;
  arguments.roulette_start = config_.roulette_start;
  arguments.max_survival = config_.max_survival;
  arguments.results = results_.buffer();
  arguments.result_count = results_.count();
  arguments.live = &live_;
  arguments.casts = &casts_;
  arguments.ended = &ended_;
  arguments.reflecting = &reflecting;
  arguments.nearly_full = &nearly_full_;
  machine_.run(kernels_.shade, arguments, all_pes());
  if (arguments.casts_shadow_rays) counts_.culled_shadow_rays += count_of(reflecting) - count_of(casts_);
  count_ended();
}

/// Statistics of the simulator; the chip does not count, so this is free.
void ResidentTracer::count_searched() {
  const std::uint64_t segments = count_of(live_);
  const std::uint64_t shadow_rays = count_of(casts_);
  counts_.segments += segments;
  counts_.shadow_rays += shadow_rays;
  if (segments + shadow_rays > 0) counts_.rays.add(segments + shadow_rays);
  ++counts_.steps;
}

/// The same.
void ResidentTracer::count_ended() {
  std::vector<std::uint64_t>& paths = counts_.paths_by_segments;
  for (int place = 0; place < paths_; ++place)
    for (int pe = 0; pe < machine_.num_pes(); ++pe) {
      std::uint32_t& segments = segments_[std::size_t(place * machine_.num_pes() + pe)];
      segments += live_[std::size_t(place)][pe] ? 1 : 0;
      if (!ended_[std::size_t(place)][pe]) continue;
      if (segments >= paths.size()) paths.resize(segments + 1);
      ++paths[segments];
      segments = 0;
    }
}

bool ResidentTracer::is_anything_left() const {
  return pes_with(live_).any() || pes_with(ended_).any();
}

cn::LaneMask ResidentTracer::pes_with(const PathMasks& masks) const {
  cn::LaneMask pes;
  for (const cn::LaneMask& mask : masks) pes = pes.with(mask);
  return pes;
}

}  // namespace path_tracer
