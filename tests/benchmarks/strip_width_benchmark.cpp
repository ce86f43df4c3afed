// How many PEs should the simulator execute together? Times the same intersection kernel with its lanes in
// strips of different widths, up to the whole array at once. Build with `cmake --build --preset release
// --target strip_width_benchmark`; it is compiled for x86-64-v3.

#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

namespace {

constexpr int kPes = 96;
constexpr int kTriangles = 38;
constexpr int kNativeLanes = 4;
using Chunk __attribute__((vector_size(kNativeLanes * sizeof(double)))) = double;

template <int lanes>
struct Wide {
  static constexpr std::size_t kChunks = lanes / kNativeLanes;
  Chunk chunk[kChunks];
};

template <int lanes, class F, std::size_t... i>
Wide<lanes> each(F& f, std::index_sequence<i...>) {
  return {{f(i)...}};
}
template <int lanes, class F>
Wide<lanes> each(F&& f) {
  return each<lanes>(f, std::make_index_sequence<Wide<lanes>::kChunks>());
}

template <int lanes>
Wide<lanes> operator+(const Wide<lanes>& a, const Wide<lanes>& b) {
  return each<lanes>([&](std::size_t i) { return a.chunk[i] + b.chunk[i]; });
}
template <int lanes>
Wide<lanes> operator-(const Wide<lanes>& a, const Wide<lanes>& b) {
  return each<lanes>([&](std::size_t i) { return a.chunk[i] - b.chunk[i]; });
}
template <int lanes>
Wide<lanes> operator-(const Wide<lanes>& a, double b) {
  return each<lanes>([&](std::size_t i) { return a.chunk[i] - b; });
}
template <int lanes>
Wide<lanes> operator*(const Wide<lanes>& a, const Wide<lanes>& b) {
  return each<lanes>([&](std::size_t i) { return a.chunk[i] * b.chunk[i]; });
}
template <int lanes>
Wide<lanes> operator*(const Wide<lanes>& a, double b) {
  return each<lanes>([&](std::size_t i) { return a.chunk[i] * b; });
}

using Mono3 = std::array<double, 3>;
struct Triangle {
  Mono3 vertex, edge1, edge2;
};

template <int lanes>
using Wide3 = std::array<Wide<lanes>, 3>;

template <int lanes, class B>
Wide3<lanes> cross(const Wide3<lanes>& a, const B& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <int lanes, class B>
Wide<lanes> dot(const Wide3<lanes>& a, const B& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Tests one triangle against the rays of a strip and keeps the nearest distances (Moeller and Trumbore
/// 1997).
template <int lanes>
[[gnu::flatten, gnu::noinline]] void intersect_strip(const std::vector<Triangle>& triangles,
                                                     const double* rays, int first_pe, double* nearest_out) {
  Wide3<lanes> origin, direction;
  for (std::size_t k = 0; k < 3; ++k) {
    std::memcpy(&origin[k], rays + k * kPes + first_pe, sizeof(origin[k]));
    std::memcpy(&direction[k], rays + (3 + k) * kPes + first_pe, sizeof(direction[k]));
  }
  Wide<lanes> nearest = each<lanes>([](std::size_t) { return Chunk{} + 1e300; });
  for (const Triangle& triangle : triangles) {
    const Wide3<lanes> p = cross(direction, triangle.edge2);
    const Wide<lanes> determinant = dot(p, triangle.edge1);
    const Wide3<lanes> s = {origin[0] - triangle.vertex[0], origin[1] - triangle.vertex[1],
                            origin[2] - triangle.vertex[2]};
    const Wide<lanes> u = dot(s, p);
    const Wide3<lanes> q = cross(s, triangle.edge1);
    const Wide<lanes> v = dot(direction, q);
    const Wide<lanes> t = dot(q, triangle.edge2);
    nearest = each<lanes>([&](std::size_t i) {
      const Chunk distance = t.chunk[i] / determinant.chunk[i];
      const auto hit = (u.chunk[i] >= 0.0) & (v.chunk[i] >= 0.0) &
                       (u.chunk[i] + v.chunk[i] <= determinant.chunk[i]) & (distance > 0.0) &
                       (distance < nearest.chunk[i]);
      return hit ? distance : nearest.chunk[i];
    });
  }
  std::memcpy(nearest_out + first_pe, &nearest, sizeof(nearest));
}

template <int lanes>
void time_width(const std::vector<Triangle>& triangles, const std::vector<double>& rays) {
  using Clock = std::chrono::steady_clock;
  constexpr int kBlocks = 4000;
  std::vector<double> nearest(kPes);
  double best_seconds = 1e9;
  double checksum = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const Clock::time_point start = Clock::now();
    for (int block = 0; block < kBlocks; ++block) {
      for (int first_pe = 0; first_pe < kPes; first_pe += lanes)
        intersect_strip<lanes>(triangles, rays.data(), first_pe, nearest.data());
      checksum += nearest[std::size_t(block % kPes)];
    }
    best_seconds = std::min(best_seconds, std::chrono::duration<double>(Clock::now() - start).count());
  }
  std::printf("%4d PEs together: %6.1f million rays/s  (checksum %g)\n", lanes,
              1e-6 * kBlocks * kPes / best_seconds, checksum);
}

}  // namespace

int main() {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Triangle> triangles(kTriangles);
  for (Triangle& triangle : triangles)
    for (Mono3* corner : {&triangle.vertex, &triangle.edge1, &triangle.edge2})
      for (double& component : *corner) component = uniform(generator);
  std::vector<double> rays(6 * kPes);
  for (double& component : rays) component = uniform(generator);
  std::printf("%d rays against %d triangles, double precision, %d lanes a register\n", kPes, kTriangles,
              kNativeLanes);
  time_width<4>(triangles, rays);
  time_width<8>(triangles, rays);
  time_width<16>(triangles, rays);
  time_width<32>(triangles, rays);
  time_width<96>(triangles, rays);
}
