// Kernels of the path tracer as the firmware runs them, at each x86-64 level that this machine executes.

#include <benchmark/benchmark.h>

#include <random>

#include "firmware/path_tracer/geometry/triangle_record.hpp"
#include "firmware/path_tracer/kernels/kernels.hpp"

namespace {

using namespace path_tracer;

constexpr int kPes = 96;
constexpr int kTriangles = 38;
constexpr double kReach = 4.0;

/// Rays and triangles of a unit box.
class KernelBench {
 public:
  KernelBench() : memory(kPes, 6144), triangles(kTriangles) {
    for (int w = 0; w < 6144 / 8 - 2; ++w)
      for (int pe = 0; pe < kPes; ++pe) word(pe, 8 * w) = number();
    for (std::int32_t i = 0; i < kTriangles; ++i)
      triangles[std::size_t(i)] = triangle_record(point(), point(), point(), {i / 2, i, kReach});
  }
  double& word(int pe, int offset_bytes) { return reinterpret_cast<double&>(memory.word(pe, offset_bytes)); }

  cn::PolyMemory memory;
  std::vector<TriangleRecord> triangles;
  cn::LaneMask all = cn::LaneMask::first(kPes);
  cn::IssueTree issued;

 private:
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  vec3<double> point() { return {number(), number(), number()}; }
  std::mt19937 random_{1};
};

template <class Arguments>
void run(benchmark::State& state, KernelBench& bench, const cn::Kernel<Arguments>& kernel,
         const Arguments& arguments, double operations) {
  for (auto _ : state) {
    kernel.run(arguments, bench.memory, bench.all, bench.issued);
    benchmark::ClobberMemory();
  }
  state.counters["each"] = benchmark::Counter(
      operations * kPes, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void intersect(benchmark::State& state, Level level, bool prefiltered) {
  KernelBench bench;
  LaneMask hit;
  IntersectArguments arguments;
  arguments.ray = PolyPointer<RayRecord>(0);
  arguments.hit = PolyPointer<HitRecord>(512);
  arguments.surface_place = {1024};
  arguments.triangles = bench.triangles.data();
  arguments.triangle_count = kTriangles;
  const Prefilter prefilter = make_prefilter(bench.triangles.data(), kTriangles, kReach);
  if (prefiltered) arguments.prefilter = &prefilter;
  arguments.reach = kReach;
  arguments.hit_something = &hit;
  run(state, bench, kernels(level).intersect, arguments, kTriangles);
}

void scatter(benchmark::State& state, Level level, Sampler sampler, bool casts_shadow_rays) {
  KernelBench bench;
  LaneMask casts;
  ScatterArguments arguments;
  arguments.hit = PolyPointer<HitRecord>(0);
  arguments.surface = PolyPointer<SurfaceRecord>(512);
  arguments.path = PolyPointer<PathRecord>(1024);
  arguments.light = PolyPointer<LightRecord>(2048);
  arguments.scatter = PolyPointer<ScatterRecord>(1536);
  arguments.shadow_ray = PolyPointer<RayRecord>(3072);
  arguments.lighting = PolyPointer<LightingRecord>(3584);
  arguments.sampler = sampler;
  arguments.light_sampling = sampler == Sampler::sobol ? LightSampling::solid_angle : LightSampling::area;
  arguments.casts_shadow_rays = casts_shadow_rays;
  arguments.casts = &casts;
  run(state, bench, kernels(level).scatter, arguments, 1);
}

void fold(benchmark::State& state, Level level) {
  KernelBench bench;
  FoldArguments arguments;
  arguments.path = {{0}, {8}, {16}, {24}, {32}};
  arguments.vertices = PolyPointer<VertexRecord>(512);
  arguments.earlier = PolyPointer<FoldRecord>(1024);
  arguments.sum = PolyPointer<FoldRecord>(1536);
  arguments.radiance = PolyPointer<RadianceRecord>(2048);
  arguments.flushed = PolyPointer<FoldRecord>(2560);
  run(state, bench, kernels(level).fold, arguments, kVerticesPerLoad);
}

struct Registration {
  Registration() {
    for (const Level level : cn::usable_levels()) {
      const std::string name = cn::name_of(level);
      using std::string;
      benchmark::RegisterBenchmark((string("intersect, each triangle and PE/") + name).c_str(), intersect,
                                   level, false);
      benchmark::RegisterBenchmark((string("intersect, prefiltered, each triangle and PE/") + name).c_str(),
                                   intersect, level, true);
      benchmark::RegisterBenchmark((string("scatter, philox, no light, each PE/") + name).c_str(), scatter,
                                   level, Sampler::philox, false);
      benchmark::RegisterBenchmark((string("scatter, philox, light by area, each PE/") + name).c_str(),
                                   scatter, level, Sampler::philox, true);
      benchmark::RegisterBenchmark((string("scatter, sobol, light by angle, each PE/") + name).c_str(),
                                   scatter, level, Sampler::sobol, true);
      benchmark::RegisterBenchmark((string("fold, each vertex and PE/") + name).c_str(), fold, level);
    }
  }
} const registration;

}  // namespace
