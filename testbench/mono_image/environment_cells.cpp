#include "testbench/mono_image/environment_cells.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <queue>

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using Texels = EnvironmentCells::Texels;

constexpr std::size_t kMostCells = 1 << 13;
/// At least so many cells share the sky, so that the choice can tell apart which parts are seen.
constexpr double kLeastCells = 32.0;

/// A rectangle of the image while it is cut.
struct Cell {
  Texels texels;
  double solid_angle = 0.0;
  glm::dvec3 flux{0.0};  ///< radiance integrated over the solid angle
  double spread = 0.0;   ///< solid angle times the difference of the brightest and the darkest texel
};

class ImageCutter {
 public:
  explicit ImageCutter(const RadianceImage& image) : image_(image) {}

  std::vector<Cell> cut() const {
    const Cell whole = cell_of({0, 0, image_.width, image_.height});
    const double total = whole.flux.x + whole.flux.y + whole.flux.z;
    const auto priority = [&](const Cell& cell) {
      if (cell.texels.columns * cell.texels.rows == 1) return 0.0;
      const bool is_large = cell.solid_angle > 4.0 * glm::pi<double>() / kLeastCells * (1.0 + 1e-9);
      return is_large ? total * cell.solid_angle * kLeastCells + cell.spread : cell.spread;
    };
    constexpr double kSmooth = 0x1p-16;  // of all light: a cell that varies by less is cut no further
    using Waiting = std::pair<double, std::size_t>;
    std::priority_queue<Waiting> waiting;
    std::vector<Cell> cells{whole};
    waiting.push({priority(whole), 0});
    while (cells.size() < kMostCells && waiting.top().first > kSmooth * total) {
      const std::size_t index = waiting.top().second;
      waiting.pop();
      const auto [first, second] = halves(cells[index].texels);
      cells[index] = cell_of(first);
      cells.push_back(cell_of(second));
      waiting.push({priority(cells[index]), index});
      waiting.push({priority(cells.back()), cells.size() - 1});
    }
    return cells;
  }

 private:
  double row_edge(int row) const { return std::cos(glm::pi<double>() * row / image_.height); }

  Cell cell_of(const Texels& texels) const {
    Cell cell;
    cell.texels = texels;
    const double column_span = 2.0 * glm::pi<double>() / image_.width;
    double least = std::numeric_limits<double>::infinity();
    double most = 0.0;
    for (int row = texels.first_row; row < texels.first_row + texels.rows; ++row) {
      const double of_texel = column_span * (row_edge(row) - row_edge(row + 1));
      glm::dvec3 sum(0.0);
      for (int column = texels.first_column; column < texels.first_column + texels.columns; ++column) {
        const float* const rgb =
            &image_.rgb[3 * (std::size_t(row) * std::size_t(image_.width) + std::size_t(column))];
        const glm::dvec3 radiance(rgb[0], rgb[1], rgb[2]);
        const double channels = radiance.x + radiance.y + radiance.z;
        least = std::min(least, channels);
        most = std::max(most, channels);
        sum += radiance;
      }
      cell.flux += of_texel * sum;
      cell.solid_angle += of_texel * texels.columns;
    }
    cell.spread = cell.solid_angle * (most - least);
    return cell;
  }

  /// Halves the longer side, in angles at the equator.
  std::pair<Texels, Texels> halves(const Texels& texels) const {
    Texels first = texels;
    Texels second = texels;
    const double width = 2.0 * texels.columns / image_.width;
    const double height = double(texels.rows) / image_.height;
    if (texels.rows == 1 || (texels.columns > 1 && width >= height)) {
      first.columns = texels.columns / 2;
      second.columns -= first.columns;
      second.first_column += first.columns;
    } else {
      first.rows = texels.rows / 2;
      second.rows -= first.rows;
      second.first_row += first.rows;
    }
    return {first, second};
  }

  const RadianceImage& image_;
};

Emitter emitter_of_cell(const Environment& environment, const Cell& cell, double radius) {
  const RadianceImage& image = *environment.image;
  const double per_column = 2.0 * glm::pi<double>() / image.width;
  const auto up = [&](int row) { return std::cos(glm::pi<double>() * row / image.height); };
  const Texels& texels = cell.texels;
  const double lowest = up(texels.first_row + texels.rows);
  Emitter emitter;
  emitter.measure = cell.solid_angle;
  emitter.record.edge1 = {per_column * texels.first_column - glm::pi<double>(), per_column * texels.columns,
                          0.0};
  emitter.record.edge2 = {lowest, up(texels.first_row) - lowest, 0.0};
  emitter.record.face = path_tracer::kEnvironmentFace;
  emitter.record.shape = static_cast<std::int32_t>(path_tracer::LightShape::environment);
  emitter.emission = environment.scale * cell.flux / cell.solid_angle;
  emitter.power = environment.scale * (cell.flux.x + cell.flux.y + cell.flux.z) * radius * radius;
  const glm::dvec2 middle((texels.first_column + 0.5 * texels.columns) / image.width,
                          (texels.first_row + 0.5 * texels.rows) / image.height);
  emitter.centre = environment.rotation * environment_direction(middle);
  return emitter;
}

void require_single_precision(const Scene& scene) {
  const std::vector<float>& rgb = scene.environment.image->rgb;
  const double largest = scene.environment.scale * double(*std::max_element(rgb.begin(), rgb.end()));
  if (largest <= double(std::numeric_limits<float>::max())) return;
  throw InputError(scene.name + ": environment.scale: found a factor that takes the image's radiance to " +
                   std::to_string(largest) + "; allowed is up to 3.4e38");
}

}  // namespace

EnvironmentCells environment_cells(const Scene& scene, double radius) {
  if (!scene.environment.shows_image()) return {};
  require_single_precision(scene);
  EnvironmentCells cells;
  for (const Cell& cell : ImageCutter(*scene.environment.image).cut()) {
    Emitter emitter = emitter_of_cell(scene.environment, cell, radius);
    if (!(emitter.power > 0.0)) continue;
    cells.texels.push_back(cell.texels);
    cells.emitters.push_back(std::move(emitter));
  }
  return cells;
}

std::vector<path_tracer::EnvironmentTexel> environment_texels(const Environment& environment,
                                                              const EnvironmentCells& cells,
                                                              const std::vector<float>& pdf) {
  const RadianceImage& image = *environment.image;
  std::vector<path_tracer::EnvironmentTexel> texels(std::size_t(image.width) * std::size_t(image.height));
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const auto scaled = [&](std::size_t channel) {
      return static_cast<float>(environment.scale * double(image.rgb[3 * i + channel]));
    };
    texels[i] = {scaled(0), scaled(1), scaled(2), 0.0f};
  }
  for (std::size_t i = 0; i < cells.texels.size(); ++i) {
    const Texels& of_cell = cells.texels[i];
    for (int row = 0; row < of_cell.rows; ++row)
      for (int column = 0; column < of_cell.columns; ++column)
        texels[std::size_t(of_cell.first_row + row) * std::size_t(image.width) +
               std::size_t(of_cell.first_column + column)]
            .pdf = pdf[i];
  }
  return texels;
}

}  // namespace testbench
