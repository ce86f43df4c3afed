#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "testbench/film/chart.hpp"
#include "testbench/run/render.hpp"

namespace testbench {

/// What rays through a tree cost with each way that shares nodes between rays, against the bins.
struct RivalsQuestion {
  std::vector<int> triangles{100000};                 ///< of the scene (GeneratedScene::blob)
  std::vector<int> widths{16, 32, 64, 96, 128, 256};  ///< numbers of PEs
  FilmSize film{128, 128};
  RenderOptions options;  ///< chip, timing, samples
};

/// Cycles a ray, from more to less coherent.
struct RivalCosts {
  int triangles = 0;
  int width = 0;
  path_tracer::Traversal traversal = path_tracer::Traversal::temporary_bin;
  double first = 0;           ///< camera rays, square tile by square tile
  double first_shuffled = 0;  ///< camera rays from all over the film
  double second = 0;
  double third = 0;
  double sixth = 0;
};

/// The ways that are compared: those of bins, then the rivals.
inline constexpr int kBinnedTraversals = 3;
inline constexpr std::array kComparedTraversals = {
    path_tracer::Traversal::temporary_bin,   path_tracer::Traversal::refill,
    path_tracer::Traversal::shared_treelets, path_tracer::Traversal::packets,
    path_tracer::Traversal::large_packets,   path_tracer::Traversal::ray_streams};

/// Makes the runs, each in a process of its own, `at_once` at a time. Throws InputError for a number of
/// triangles or PEs that there is not. What the later segments of paths cost is the difference of runs
/// whose paths end one segment apart.
/// @param done called with the share of finished runs
std::vector<RivalCosts> measure_rivals(const RivalsQuestion& question, int at_once,
                                       const std::function<void(double share)>& done = {});

/// A table for each scene and width, and from which rays on each binned way is cheaper than each rival.
std::string rivals_text(const std::vector<RivalCosts>& costs);
std::string rivals_csv(const std::vector<RivalCosts>& costs);

/// The first and the sixth segment, by the number of PEs, or by triangles if there is one number of PEs.
LogChart rivals_chart(const std::vector<RivalCosts>& costs);

}  // namespace testbench
