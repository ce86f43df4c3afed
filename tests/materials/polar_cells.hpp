#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/materials/material_bench.hpp"

namespace test_support {

/// Cells of the sphere around a pole, small near it, because a narrow lobe is there.
class PolarCells {
 public:
  static constexpr int kRings = 36;
  static constexpr int kSectors = 36;

  /// @param points along each side of a cell
  PolarCells(const Vector& pole, int points)
      : points_(points),
        pole_(pole),
        x_(unit(cross(std::abs(pole.x) < 0.5 ? Vector{1, 0, 0} : Vector{0, 1, 0}, pole))),
        y_(cross(pole, x_)) {}

  std::size_t count() const { return std::size_t(kRings) * kSectors; }

  std::size_t cell_of(const Vector& direction) const {
    const double across = std::hypot(dot(direction, x_), dot(direction, y_));
    const double angle = std::atan2(across, dot(direction, pole_));
    const double around = std::atan2(dot(direction, y_), dot(direction, x_));
    const double sector = around / (2 * kHalfTurn) - std::floor(around / (2 * kHalfTurn));
    const double from_pole = std::cbrt(std::min(angle, kHalfTurn - angle) / (kHalfTurn / 2));
    const int ring = static_cast<int>(kRings / 2 * (angle < kHalfTurn / 2 ? from_pole : 2 - from_pole));
    return std::size_t(std::min(ring, kRings - 1)) * kSectors +
           std::size_t(std::min(static_cast<int>(sector * kSectors), kSectors - 1));
  }

  struct Point {
    std::size_t cell;
    Vector direction;
    double solid_angle;
  };

  /// Points of the midpoint rule in the two angles.
  std::vector<Point> points() const {
    std::vector<Point> all;
    for (int ring = 0; ring < kRings; ++ring) {
      const double low = ring_angle(ring);
      const double step = (ring_angle(ring + 1) - low) / points_;
      for (int i = 0; i < points_; ++i) {
        const double angle = low + (i + 0.5) * step;
        const double weight = step * 2 * kHalfTurn / (kSectors * points_) * std::sin(angle);
        for (int j = 0; j < kSectors * points_; ++j) {
          const double around = 2 * kHalfTurn * (j + 0.5) / (kSectors * points_);
          const Vector direction =
              pole_ * std::cos(angle) + (x_ * std::cos(around) + y_ * std::sin(around)) * std::sin(angle);
          all.push_back({std::size_t(ring) * kSectors + std::size_t(j / points_), direction, weight});
        }
      }
    }
    return all;
  }

 private:
  static constexpr double kHalfTurn = path_tracer::kPi;

  /// Narrow at both poles; one edge is the equator, which is the horizon where the pole is the normal.
  static double ring_angle(int ring) {
    const double share = 2.0 * ring / kRings;
    return share <= 1 ? kHalfTurn / 2 * std::pow(share, 3)
                      : kHalfTurn - kHalfTurn / 2 * std::pow(2 - share, 3);
  }

  int points_;
  Vector pole_;
  Vector x_;
  Vector y_;
};

}  // namespace test_support
