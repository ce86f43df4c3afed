#include "testbench/film/flip.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <stdexcept>

namespace testbench {
namespace {

/// One value of every pixel.
using Plane = std::vector<double>;
/// Weights from -radius to +radius.
using Kernel = std::vector<double>;

template <class Weight>
Kernel kernel_of(int radius, Weight&& weight) {
  Kernel kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(weight(double(x)));
  return kernel;
}

double weight_of(const Kernel& kernel) {
  double total = 0;
  for (const double weight : kernel) total += weight;
  return total;
}

/// Divides positive and negative weights by their own sums, so that they add up to 1 and to -1.
Kernel normalised(Kernel kernel) {
  double positive = 0;
  double negative = 0;
  for (const double weight : kernel) (weight > 0 ? positive : negative) += std::abs(weight);
  for (double& weight : kernel) weight /= weight > 0 ? positive : std::max(negative, 1e-300);
  return kernel;
}

/// Convolves along one direction. The pixels of the border go on outside.
Plane filtered_along(const Plane& plane, int count, int stride, int lines, int line_stride,
                     const Kernel& kernel) {
  Plane result(plane.size());
  const int radius = static_cast<int>(kernel.size() / 2);
  for (int line = 0; line < lines; ++line)
    for (int i = 0; i < count; ++i) {
      double value = 0;
      for (int k = -radius; k <= radius; ++k)
        value += kernel[std::size_t(k + radius)] *
                 plane[std::size_t(line * line_stride + std::clamp(i + k, 0, count - 1) * stride)];
      result[std::size_t(line * line_stride + i * stride)] = value;
    }
  return result;
}

Plane filtered(const Plane& plane, FilmSize size, const Kernel& horizontal, const Kernel& vertical) {
  const Plane rows = filtered_along(plane, size.width, 1, size.height, size.width, horizontal);
  return filtered_along(rows, size.height, size.width, size.width, 1, vertical);
}

/// Linear RGB to XYZ relative to the white, so that white is (1, 1, 1): IEC 61966-2-1's matrix, each row
/// divided by its sum.
glm::dmat3 to_relative_xyz() {
  const glm::dmat3 rows(10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,  //
                        2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,    //
                        1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382);
  glm::dmat3 relative(0.0);
  for (int row = 0; row < 3; ++row) relative[row] = rows[row] / (rows[row][0] + rows[row][1] + rows[row][2]);
  return glm::transpose(relative);
}

/// The opponent space YCxCz, which is linear in XYZ: Y about 0 to 100, red to green, blue to yellow.
glm::dvec3 to_opponent(const glm::dvec3& xyz) {
  return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

glm::dvec3 from_opponent(const glm::dvec3& opponent) {
  const double y = (opponent.x + 16) / 116;
  return {y + opponent.y / 500, y, y - opponent.z / 200};
}

/// CIE 1976 L*a*b* after Hunt's effect, by which colours are the less saturated the darker they are.
glm::dvec3 to_hunt_lab(const glm::dvec3& xyz) {
  constexpr double delta = 6.0 / 29;
  glm::dvec3 f;
  for (int i = 0; i < 3; ++i)
    f[i] = xyz[i] > delta * delta * delta ? std::cbrt(xyz[i]) : xyz[i] / (3 * delta * delta) + 4.0 / 29;
  const double lightness = 116 * f.y - 16;
  return {lightness, 0.01 * lightness * 500 * (f.x - f.y), 0.01 * lightness * 200 * (f.y - f.z)};
}

/// A distance for large differences of colour, compressed by an exponent.
double colour_distance(const glm::dvec3& a, const glm::dvec3& b) {
  constexpr double exponent = 0.7;  // q_c of the paper
  return std::pow(std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z), exponent);
}

/// Distances to 0 .. 1: the first 40 % of the largest, green to blue, take 95 %.
double redistributed(double distance, double largest) {
  constexpr double p_c = 0.4;
  constexpr double p_t = 0.95;
  if (distance < p_c * largest) return p_t * distance / (p_c * largest);
  return p_t + (1 - p_t) * (distance - p_c * largest) / (largest - p_c * largest);
}

/// How the eye filters opponent colours: a sum of Gaussians for each, in degrees of the field of view.
class ContrastSensitivity {
 public:
  explicit ContrastSensitivity(double pixels_per_degree)
      : pixels_per_degree_(pixels_per_degree),
        radius_(int(std::ceil(3 * std::sqrt(kWidest / (2 * glm::pi<double>() * glm::pi<double>())) *
                              pixels_per_degree))) {}

  std::vector<glm::dvec3> filtered(const std::vector<glm::dvec3>& opponent, FilmSize size) const {
    // The paper's table 1: a and b of a sqrt(pi/b) exp(-pi^2 x^2 / b).
    const Gaussians of_channel[3] = {{{1, 0.0047}}, {{1, 0.0053}}, {{34.1, kWidest}, {13.5, 0.025}}};
    std::vector<glm::dvec3> result(opponent.size());
    for (int channel = 0; channel < 3; ++channel) {
      Plane plane;
      for (const glm::dvec3& colour : opponent) plane.push_back(colour[channel]);
      add_sum(plane, size, of_channel[channel], result, channel);
    }
    return result;
  }

 private:
  struct Gaussian {
    double a;
    double b;
  };
  using Gaussians = std::vector<Gaussian>;
  static constexpr double kWidest = 0.04;

  Kernel kernel(const Gaussian& gaussian) const {
    return kernel_of(radius_, [&](double x) {
      const double degrees = x / pixels_per_degree_;
      return std::exp(-glm::pi<double>() * glm::pi<double>() * degrees * degrees / gaussian.b);
    });
  }

  void add_sum(const Plane& plane, FilmSize size, const Gaussians& gaussians, std::vector<glm::dvec3>& result,
               int channel) const {
    std::vector<double> weights;
    double total = 0;
    for (const Gaussian& gaussian : gaussians) {
      const double one_row = weight_of(kernel(gaussian));
      weights.push_back(gaussian.a * std::sqrt(glm::pi<double>() / gaussian.b) * one_row * one_row);
      total += weights.back();
    }
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
      const Kernel weighted = normalised(kernel(gaussians[i]));
      const Plane part = testbench::filtered(plane, size, weighted, weighted);
      for (std::size_t pixel = 0; pixel < part.size(); ++pixel)
        result[pixel][channel] += weights[i] / total * part[pixel];
    }
  }

  double pixels_per_degree_;
  int radius_;
};

/// How strongly edges and points stand out.
struct EdgesAndPoints {
  Plane edges;
  Plane points;
};

EdgesAndPoints edges_and_points(const std::vector<glm::dvec3>& opponent, FilmSize size,
                                double pixels_per_degree) {
  constexpr double width_degrees = 0.082;  // w of the paper: the eye's own filter for edges
  const double deviation = 0.5 * width_degrees * pixels_per_degree;
  const int radius = int(std::ceil(3 * deviation));
  const auto gaussian = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
  const Kernel smooth = normalised(kernel_of(radius, gaussian));
  const Kernel slope = normalised(kernel_of(radius, [&](double x) { return -x * gaussian(x); }));
  const Kernel curvature = normalised(
      kernel_of(radius, [&](double x) { return (x * x / (deviation * deviation) - 1) * gaussian(x); }));
  Plane luminance;
  for (const glm::dvec3& colour : opponent) luminance.push_back((colour.x + 16) / 116);
  const auto strength = [&](const Kernel& kernel) {
    Plane across = filtered(luminance, size, kernel, smooth);
    const Plane down = filtered(luminance, size, smooth, kernel);
    for (std::size_t i = 0; i < across.size(); ++i) across[i] = std::hypot(across[i], down[i]);
    return across;
  };
  return {strength(slope), strength(curvature)};
}

/// A picture in the spaces in which it is compared.
struct Seen {
  std::vector<glm::dvec3> colours;  ///< filtered, Hunt-adjusted L*a*b*
  EdgesAndPoints features;
};

Seen seen(const DisplayImage& image, double pixels_per_degree) {
  const glm::dmat3 to_xyz = to_relative_xyz();
  const glm::dmat3 to_rgb = glm::inverse(to_xyz);
  std::vector<glm::dvec3> opponent;
  for (const glm::dvec3& rgb : image.rgb) opponent.push_back(to_opponent(to_xyz * rgb));
  Seen result;
  result.features = edges_and_points(opponent, image.size, pixels_per_degree);
  for (const glm::dvec3& colour : ContrastSensitivity(pixels_per_degree).filtered(opponent, image.size)) {
    const glm::dvec3 rgb = glm::clamp(to_rgb * from_opponent(colour), 0.0, 1.0);
    result.colours.push_back(to_hunt_lab(to_xyz * rgb));
  }
  return result;
}

/// The distance of two colours of a display that are as far apart as any: its green and its blue.
double largest_distance() {
  const glm::dmat3 to_xyz = to_relative_xyz();
  return colour_distance(to_hunt_lab(to_xyz * glm::dvec3(0, 1, 0)),
                         to_hunt_lab(to_xyz * glm::dvec3(0, 0, 1)));
}

}  // namespace

DisplayImage display_image(FilmSize size, const std::vector<double>& rgb) {
  DisplayImage image{size, {}};
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3)
    image.rgb.push_back(glm::clamp(glm::dvec3(rgb[i], rgb[i + 1], rgb[i + 2]), 0.0, 1.0));
  return image;
}

std::vector<double> flip(const DisplayImage& test, const DisplayImage& reference, double pixels_per_degree) {
  const std::size_t pixels = std::size_t(test.size.width) * std::size_t(test.size.height);
  if (pixels == 0 || test.size.width != reference.size.width || test.rgb.size() != pixels ||
      reference.rgb.size() != pixels)
    throw std::invalid_argument("FLIP compares two pictures of one size");
  constexpr double feature_exponent = 0.5;  // q_f of the paper
  const Seen a = seen(test, pixels_per_degree);
  const Seen b = seen(reference, pixels_per_degree);
  const double largest = largest_distance();
  std::vector<double> map;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double colour = redistributed(colour_distance(a.colours[i], b.colours[i]), largest);
    const double edge = std::abs(a.features.edges[i] - b.features.edges[i]);
    const double point = std::abs(a.features.points[i] - b.features.points[i]);
    const double feature = std::pow(std::max(edge, point) / std::sqrt(2.0), feature_exponent);
    map.push_back(std::pow(colour, 1 - feature));
  }
  return map;
}

}  // namespace testbench
