// Adding a sample of radiance to a film that fits the simulator's cache, and to a film of the scene's size.

#include <benchmark/benchmark.h>

#include <random>

#include "testbench/film/film.hpp"

namespace {

/// Pixels in an order like that in which paths end: near each other, but not consecutive.
void film_add(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  testbench::Film film({side, side}, 16);
  std::mt19937 random(1);
  std::vector<int> pixels(std::size_t(side) * std::size_t(side));
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<int>((i + random() % 1536) % pixels.size());
  std::size_t next = 0;
  for (auto _ : state) {
    if (next + 16 < pixels.size()) film.prefetch(pixels[next + 16]);
    benchmark::DoNotOptimize(film.add(pixels[next], {0.5, 0.25, 0.125}));
    next = next + 1 < pixels.size() ? next + 1 : 0;
  }
}
BENCHMARK(film_add)->ArgName("side")->Arg(16)->Arg(480);

}  // namespace
