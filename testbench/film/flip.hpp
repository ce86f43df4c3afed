#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "testbench/film/film.hpp"

namespace testbench {

/// A picture as a display shows it: linear RGB of the primaries and the white of sRGB, 0 to 1, row by row
/// from the top.
struct DisplayImage {
  FilmSize size;
  std::vector<glm::dvec3> rgb;
};

/// The picture of linear radiance that write_png() writes, before it is rounded to 8 bits: exposure 1,
/// clamped to 0 .. 1. `rgb` has three values a pixel.
DisplayImage display_image(FilmSize size, const std::vector<double>& rgb);

/// Pixels in a degree of the field of view, in the middle of a display that is 0.7 m wide, has 3840 pixels in
/// a row and is seen from 0.7 m: the example of the FLIP paper.
inline constexpr double kPixelsPerDegree = 3840 / 0.7 * 0.7 * glm::pi<double>() / 180;

/// How visible the difference of two pictures of one size is when they alternate in one place, 0 (not) to 1
/// for each pixel: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference
/// Evaluator for Alternating Images", HPG 2020, DOI 10.1145/3406183. The order of the two does not matter.
/// Throws std::invalid_argument for different or empty sizes.
std::vector<double> flip(const DisplayImage& test, const DisplayImage& reference,
                         double pixels_per_degree = kPixelsPerDegree);

}  // namespace testbench
