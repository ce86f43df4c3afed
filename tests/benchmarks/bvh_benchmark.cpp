// Building the tree of boxes: splitting, packing, encoding.

#include <benchmark/benchmark.h>

#include "testbench/bvh/build_bvh.hpp"
#include "testbench/bvh/treelets.hpp"
#include "tests/support/meshes.hpp"

namespace {

using namespace testbench;

/// Triangles that fill the cube with equal density, whatever their number.
std::vector<Triangle> soup(const benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  return test_support::soup(count, 1.0, 0.5 / std::cbrt(double(count)), 1);
}

void build(benchmark::State& state) {
  const std::vector<Triangle> triangles = soup(state);
  Bvh bvh;
  for (auto _ : state) bvh = build_bvh(triangles, {});
  state.counters["nodes"] = double(bvh.nodes.size());
  state.counters["SAH cost"] = sah_cost(bvh, {});
}
BENCHMARK(build)->RangeMultiplier(10)->Range(1000, 1000000)->Unit(benchmark::kMillisecond);

void pack_and_encode(benchmark::State& state) {
  const Bvh bvh = build_bvh(soup(state), {});
  const path_tracer::NodeLayout layout{path_tracer::NodeFormat::quantised8, bvh.width};
  for (auto _ : state) {
    const Treelets treelets = pack_treelets(bvh, {1, 1024 / layout.node_bytes()});
    benchmark::DoNotOptimize(encode_treelets(bvh, treelets, layout));
    state.counters["bytes a triangle"] =
        double(treelets.slots()) * layout.node_bytes() / double(state.range(0));
  }
}
BENCHMARK(pack_and_encode)->RangeMultiplier(10)->Range(1000, 1000000)->Unit(benchmark::kMillisecond);

}  // namespace
