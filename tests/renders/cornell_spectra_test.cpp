// Derives the colours of scenes/cornell_box/cornell_box.mtl from the measured spectra beside it, by the rules
// of that directory's README.md.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/glm.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "testbench/scene_file/scene_file.hpp"

namespace cornell_spectra_test {

constexpr int kFirstWavelength = 400;
constexpr int kLastWavelength = 700;

std::string scene_path(const std::string& file) {
  return std::string(CSX600_SCENES_DIR) + "/cornell_box/" + file;
}

struct Spectrum {
  std::vector<double> wavelengths;
  std::vector<double> values;

  double at(double wavelength) const {
    std::size_t i = 0;
    while (i + 2 < wavelengths.size() && wavelength > wavelengths[i + 1]) ++i;
    const double t = (wavelength - wavelengths[i]) / (wavelengths[i + 1] - wavelengths[i]);
    return values[i] + (values[i + 1] - values[i]) * t;
  }
};

/// Reads column `name` of a CSV file over its first column, wavelength_nm.
Spectrum read_column(const std::string& file, const std::string& name) {
  std::ifstream stream(scene_path(file));
  std::string line;
  std::getline(stream, line);
  std::vector<std::string> header;
  std::string cell;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) header.push_back(cell);
  const auto column = std::find(header.begin(), header.end(), name) - header.begin();
  Spectrum spectrum;
  while (std::getline(stream, line)) {
    std::vector<double> values;
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
    spectrum.wavelengths.push_back(values.at(0));
    spectrum.values.push_back(values.at(static_cast<std::size_t>(column)));
  }
  return spectrum;
}

/// A Gaussian with a separate width on each side (Wyman, Sloan and Shirley 2013, section 2.2).
double lobe(double wavelength, double centre, double slope_below, double slope_above) {
  const double t = (wavelength - centre) * (wavelength < centre ? slope_below : slope_above);
  return std::exp(-0.5 * t * t);
}

/// The CIE 1931 2 degree observer (same paper, listing 1).
glm::dvec3 colour_matching(double nm) {
  return {1.056 * lobe(nm, 599.8, 0.0264, 0.0323) + 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) -
              0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
          0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
          1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

glm::dvec3 to_xyz(const std::function<double(double)>& spectrum) {
  glm::dvec3 xyz(0.0);
  for (int nm = kFirstWavelength; nm <= kLastWavelength; ++nm) {
    const double weight = nm == kFirstWavelength || nm == kLastWavelength ? 0.5 : 1.0;
    xyz += weight * spectrum(nm) * colour_matching(nm);
  }
  return xyz;
}

/// Linear RGB with Rec.709's primaries, each channel scaled such that the equal-energy spectrum of value 1
/// is 1.
glm::dvec3 to_rgb(const std::function<double(double)>& spectrum) {
  const glm::dvec3 red(0.64, 0.33, 0.03);
  const glm::dvec3 green(0.30, 0.60, 0.10);
  const glm::dvec3 blue(0.15, 0.06, 0.79);
  const glm::dvec3 xyz = to_xyz(spectrum);
  const glm::dvec3 white = to_xyz([](double) { return 1.0; });
  // A channel is zero in the plane of the two other primaries. So its row of the matrix is their cross
  // product, up to a factor that the division by white cancels.
  const glm::dvec3 rows[3] = {glm::cross(green, blue), glm::cross(blue, red), glm::cross(red, green)};
  glm::dvec3 rgb;
  for (int i = 0; i < 3; ++i) rgb[i] = glm::dot(rows[i], xyz) / glm::dot(rows[i], white);
  return rgb;
}

glm::dvec3 to_rgb(const Spectrum& spectrum) {
  return to_rgb([&](double wavelength) { return spectrum.at(wavelength); });
}

void expect_equal(const glm::dvec3& found, const glm::dvec3& derived) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], derived[i], 1e-9);
}

testbench::Material material(const std::string& name) {
  for (const auto& candidate : testbench::load_scene(scene_path("scene.toml")).materials) {
    if (candidate.name == name) return candidate;
  }
  ADD_FAILURE() << "no material " << name;
  return {};
}

TEST(CornellSpectra, tables_have_the_published_grid) {
  for (const char* name : {"white", "green", "red"}) {
    const Spectrum spectrum = read_column("spectra.csv", name);
    ASSERT_EQ(spectrum.wavelengths.size(), 76U);
    for (std::size_t i = 0; i < 76; ++i)
      EXPECT_EQ(spectrum.wavelengths[i], 400.0 + 4.0 * static_cast<double>(i));
  }
  const Spectrum light = read_column("light.csv", "emission");
  EXPECT_EQ(light.wavelengths, (std::vector<double>{400, 500, 600, 700}));
  EXPECT_EQ(light.values, (std::vector<double>{0.0, 8.0, 15.6, 18.4}));
}

// Values of the CIE 1931 table; the fit's own largest error is below 0.04.
TEST(CornellSpectra, colour_matching_fit_is_near_the_cie_table) {
  EXPECT_NEAR(colour_matching(600).x, 1.0622, 0.02);
  EXPECT_NEAR(colour_matching(450).x, 0.3362, 0.02);
  EXPECT_NEAR(colour_matching(500).x, 0.0049, 0.02);
  EXPECT_NEAR(colour_matching(555).y, 1.0000, 0.02);
  EXPECT_NEAR(colour_matching(500).y, 0.3230, 0.02);
  EXPECT_NEAR(colour_matching(450).z, 1.7721, 0.04);
  EXPECT_NEAR(colour_matching(480).z, 0.8130, 0.04);
}

TEST(CornellSpectra, white_reflector_is_one_and_primaries_map_to_their_channel) {
  expect_equal(to_rgb([](double) { return 1.0; }), {1.0, 1.0, 1.0});
  expect_equal(to_rgb([](double) { return 0.25; }), {0.25, 0.25, 0.25});
  const glm::dvec3 deep_red = to_rgb([](double nm) { return nm > 620.0 ? 1.0 : 0.0; });
  EXPECT_GT(deep_red.r, 10.0 * std::abs(deep_red.b));
  EXPECT_GT(deep_red.r, deep_red.g);
}

TEST(CornellSpectra, reflectances_of_the_mtl_follow_from_the_spectra) {
  for (const char* name : {"white", "green", "red"}) {
    SCOPED_TRACE(name);
    const glm::dvec3 derived = glm::clamp(to_rgb(read_column("spectra.csv", name)), 0.0, 1.0);
    expect_equal(material(name).reflectance, derived);
    expect_equal(material(name).emission, glm::dvec3(0.0));
  }
}

TEST(CornellSpectra, light_of_the_mtl_follows_from_its_spectrum) {
  const glm::dvec3 derived = glm::max(to_rgb(read_column("light.csv", "emission")), glm::dvec3(0.0));
  expect_equal(material("light").emission, derived);
  EXPECT_EQ(material("light").reflectance, glm::dvec3(0.78));
}

}  // namespace cornell_spectra_test
