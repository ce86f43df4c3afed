#include "testbench/mono_image/mono_image.hpp"
#include "testbench/mono_image/faces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "testbench/mono_image/faces.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/scenes.hpp"

namespace mono_image_test {

using path_tracer::CameraRecord;
using path_tracer::LightRecord;
using path_tracer::SurfaceRecord;
using path_tracer::TriangleRecord;
using testbench::make_mono_image;
using testbench::MonoImage;
using testbench::Scene;
using testbench::Triangle;

glm::dvec3 vector(const cn::vec3<double>& v) {
  return {v.x, v.y, v.z};
}

template <class Record>
Record record(const MonoImage& image, cn::MonoPointer<Record> first, int index = 0) {
  Record result;
  std::memcpy(&result, image.bytes.data() + (first + std::uint64_t(index)).address, sizeof(Record));
  return result;
}

path_tracer::ProgramConfig with_tree() {
  path_tracer::ProgramConfig config;
  config.traversal = path_tracer::Traversal::refill;
  return config;
}

/// Two lights of areas 2 and 1 with radiances 3 and 12 (sums of channels), and a dark triangle between them.
Scene three_triangles() {
  Scene scene;
  scene.name = "three";
  scene.film = {6, 4};
  scene.camera.position = {1, 2, 3};
  scene.camera.vertical_field_of_view_radians = 0.8;
  scene.materials = {{"dark", {0.1, 0.2, 0.3}, {0, 0, 0}},
                     {"dim", {0, 0, 0}, {1, 1, 1}},
                     {"bright", {0.5, 0, 0}, {3, 4, 5}}};
  scene.triangles = {{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, 1},
                     {{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}}, 0},
                     {{{0, 7, 0}, {0, 7, 2}, {1, 7, 0}}, 2}};
  return scene;
}

/// The power of two by which a record's edges are scaled.
double scale_of(const TriangleRecord& record, const Triangle& triangle) {
  const double scale =
      glm::length(vector(record.edge1)) / glm::length(triangle.vertex[1] - triangle.vertex[0]);
  return std::exp2(std::round(std::log2(scale)));
}

/// Compares the record of a triangle with the scene, up to the scale.
void expect_triangle(const TriangleRecord& record, const Scene& scene, int number) {
  const Triangle& triangle = scene.triangles[std::size_t(number)];
  const double scale = scale_of(record, triangle);
  EXPECT_EQ(vector(record.vertex), triangle.vertex[0]);
  EXPECT_EQ(vector(record.edge1), (triangle.vertex[1] - triangle.vertex[0]) * scale);
  EXPECT_EQ(vector(record.edge2), (triangle.vertex[2] - triangle.vertex[0]) * scale);
  // The firmware computes `back` in extended precision.
  const double rounding =
      1e-15 * glm::length(vector(record.edge1)) * glm::length(vector(record.edge2)) / scale;
  EXPECT_LT(glm::length(vector(record.back) + testbench::area_normal(triangle) * scale), rounding + 1e-300);
  EXPECT_EQ(record.face, number);
  EXPECT_EQ(record.number, number);
}

TEST(MonoImage, HoldsTrianglesAndSurfacesInTheScenesOrder) {
  const Scene scene = three_triangles();
  const MonoImage image = make_mono_image(scene, 96, {});
  ASSERT_EQ(image.layout.triangle_count, 3);
  for (int i = 0; i < 3; ++i) {
    const Triangle& triangle = scene.triangles[std::size_t(i)];
    const testbench::Material& material = scene.materials[std::size_t(triangle.material)];
    expect_triangle(record(image, image.layout.triangles, i), scene, i);
    const auto surface = record(image, image.layout.surfaces, i);
    EXPECT_EQ(vector(surface.reflectance), material.reflectance);
    EXPECT_EQ(vector(surface.emission), material.emission);
    EXPECT_EQ(surface.face, i);
  }
  EXPECT_EQ(vector(record(image, image.layout.surfaces, 1).normal), glm::dvec3(0, 0, 1));
  EXPECT_EQ(vector(record(image, image.layout.surfaces, 2).normal), glm::dvec3(0, 1, 0));
}

/// Triangles lie leaf by leaf, and behind them the triangles of each light again.
TEST(MonoImage, WithATreeHoldsEachTriangleOnceAndThoseOfLightsAgain) {
  const Scene scene = test_support::triangle_soup(60, 3, {4, 4});
  const MonoImage image = make_mono_image(scene, 96, with_tree());
  ASSERT_EQ(image.layout.triangle_count, 60);
  ASSERT_GT(image.layout.light_count, 1);
  std::vector<int> met(60, 0);
  for (int i = 0; i < 60; ++i) {
    const auto in_image = record(image, image.layout.triangles, i);
    expect_triangle(in_image, scene, in_image.number);
    ++met.at(std::size_t(in_image.number));
  }
  EXPECT_EQ(met, std::vector<int>(60, 1));
  for (int light = 0; light < image.layout.light_count; ++light) {
    const auto of_light = record(image, image.layout.lights, light);
    const int first = 60 + light * path_tracer::kLightRun;
    const auto in_run = record(image, image.layout.triangles, first);
    EXPECT_EQ(in_run.face, of_light.face);
    EXPECT_EQ(vector(in_run.vertex), vector(of_light.vertex));
    EXPECT_EQ(vector(record(image, image.layout.triangles, first + 1).back), glm::dvec3(0.0))
        << "hit by nothing";
  }
}

/// Any other triangle of the face may be nearer than the shadow ray's target, so the shadow ray must not
/// begin with the target.
TEST(MonoImage, AFaceOfManyTrianglesHasNoRunForShadowRays) {
  Scene scene = three_triangles();
  const std::int32_t light = scene.triangles[0].material;
  for (int i = 0; i < 3; ++i) scene.triangles.push_back({{{i, 0, 50}, {i + 1, 0, 50}, {i, 1, 50}}, light});
  scene.triangles.push_back({{{1, 0, 50}, {0, 1, 50}, {1, 1, 50}}, light});
  for (auto& material : scene.materials) material.emission = glm::dvec3(1.0);
  const MonoImage image = make_mono_image(scene, 96, with_tree());
  int without = 0;
  for (int i = 0; i < image.layout.light_count; ++i) {
    const auto in_run =
        record(image, image.layout.triangles, image.layout.triangle_count + i * path_tracer::kLightRun);
    without += vector(in_run.back) == glm::dvec3(0.0);
  }
  EXPECT_GE(without, 3);
  EXPECT_LT(without, image.layout.light_count);
}

/// No ray starts farther from a vertex than `reach`, neither at the camera nor on a triangle.
TEST(MonoImage, ReachSpansSceneAndCamera) {
  Scene scene = three_triangles();
  scene.camera.position = {100, 0, 0};
  const double reach = make_mono_image(scene, 96, {}).layout.reach;
  EXPECT_GT(reach, 1.1 * 100);
  EXPECT_LT(reach, 1.2 * 101);
  EXPECT_EQ(make_mono_image(scene, 8, with_tree()).layout.reach, reach);
}

TEST(MonoImage, LightsAreChosenByTheirPower) {
  const MonoImage image = make_mono_image(three_triangles(), 96, {});
  ASSERT_EQ(image.layout.light_count, 2);
  // Area times sum of channels: 2 x 3 = 6 and 1 x 12 = 12.
  EXPECT_DOUBLE_EQ(record(image, image.layout.light_cdf, 0), 6.0 / 18.0);
  EXPECT_EQ(record(image, image.layout.light_cdf, 1), 1.0);
  const auto dim = record(image, image.layout.lights, 0);
  EXPECT_EQ(vector(dim.vertex), glm::dvec3(0, 0, 0));
  EXPECT_EQ(vector(dim.edge1), glm::dvec3(2, 0, 0));
  EXPECT_EQ(vector(dim.edge2), glm::dvec3(0, 2, 0));
  EXPECT_EQ(dim.face, 0);
  EXPECT_EQ(vector(dim.normal), glm::dvec3(0, 0, 1));
  EXPECT_DOUBLE_EQ(dim.inverse_pdf, 2.0 / (6.0 / 18.0));  // area / probability
  const auto bright = record(image, image.layout.lights, 1);
  EXPECT_EQ(vector(bright.vertex), glm::dvec3(0, 7, 0));
  EXPECT_EQ(bright.face, 2);
  EXPECT_EQ(vector(bright.normal), glm::dvec3(0, 1, 0));
  EXPECT_DOUBLE_EQ(bright.inverse_pdf, 1.0 / (12.0 / 18.0));
}

/// A square light of two triangles, a single triangle, and a parallelogram that is not a rectangle.
Scene lights_of_all_shapes() {
  Scene scene = three_triangles();
  const auto quadrilateral = [&](glm::dvec3 corner, glm::dvec3 edge1, glm::dvec3 edge2) {
    scene.triangles.push_back({{corner, corner + edge1, corner + edge1 + edge2}, 1});
    scene.triangles.push_back({{corner, corner + edge1 + edge2, corner + edge2}, 1});
  };
  scene.triangles.clear();
  quadrilateral({0, 0, 0}, {2, 0, 0}, {0, 3, 0});
  scene.triangles.push_back({{{9, 0, 0}, {10, 0, 0}, {9, 1, 0}}, 1});
  quadrilateral({20, 0, 0}, {2, 0, 0}, {1, 1, 0});
  return scene;
}

TEST(MonoImage, HalvesOfARectangleAreOneLightWhenSampledBySolidAngle) {
  path_tracer::ProgramConfig config;
  EXPECT_EQ(make_mono_image(lights_of_all_shapes(), 96, config).layout.light_count, 5);
  config.light_sampling = path_tracer::LightSampling::solid_angle;
  const MonoImage image = make_mono_image(lights_of_all_shapes(), 96, config);
  ASSERT_EQ(image.layout.light_count, 4);
  const auto rectangle = record(image, image.layout.lights, 0);
  EXPECT_EQ(rectangle.shape, std::int32_t(path_tracer::LightShape::rectangle));
  EXPECT_EQ(rectangle.face, 0);
  EXPECT_EQ(vector(rectangle.normal), glm::dvec3(0, 0, 1));
  const glm::dvec3 edge1 = vector(rectangle.edge1);
  const glm::dvec3 edge2 = vector(rectangle.edge2);
  EXPECT_EQ(glm::dot(edge1, edge2), 0.0);
  EXPECT_EQ(glm::cross(edge1, edge2), glm::dvec3(0, 0, 6));
  const glm::dvec3 middle = vector(rectangle.vertex) + 0.5 * (edge1 + edge2);
  EXPECT_EQ(middle, glm::dvec3(1, 1.5, 0));
  // Areas of 6, 1/2, 1 and 1 with one radiance: the density of a point is 1 / 8.5 on all.
  EXPECT_DOUBLE_EQ(record(image, image.layout.light_cdf, 0), 6 / 8.5);
  for (int light = 0; light < 4; ++light) {
    const auto found = record(image, image.layout.lights, light);
    EXPECT_NEAR(found.inverse_pdf, 8.5, 1e-12);
    if (light > 0) {
      EXPECT_EQ(found.shape, std::int32_t(path_tracer::LightShape::triangle));
    }
  }
}

/// A survey stands for the host's paths, to the bit, if it is one of the same lights; they are others for
/// each way to choose points.
TEST(MonoImage, TakesItsLightsWeightsFromASurvey) {
  using path_tracer::LightSampling;
  const Scene scene = lights_of_all_shapes();
  path_tracer::ProgramConfig config;
  for (const LightSampling sampling : {LightSampling::area, LightSampling::solid_angle}) {
    config.light_sampling = sampling;
    const std::vector<std::uint8_t> expected = testbench::make_normal_mono_image(scene, 96, config).bytes;
    const auto bytes_with = [&](const testbench::LightSurvey& survey) {
      return testbench::make_normal_mono_image(scene, 96, config, &survey).bytes;
    };
    for (const LightSampling surveyed : {LightSampling::area, LightSampling::solid_angle})
      EXPECT_EQ(bytes_with(testbench::make_normal_light_survey(scene, surveyed)), expected);
    testbench::LightSurvey other = testbench::make_normal_light_survey(scene, sampling);
    other.weights.choice.front() *= 2.0;
    EXPECT_NE(bytes_with(other), expected);
  }
}

/// A rectangle, a single triangle, and two triangles of one face that are separate lights.
TEST(MonoImage, WithATreeALightHasAllTrianglesOfItsFace) {
  path_tracer::ProgramConfig config = with_tree();
  config.light_sampling = path_tracer::LightSampling::solid_angle;
  const Scene scene = lights_of_all_shapes();
  const MonoImage image = make_mono_image(scene, 96, config);
  ASSERT_EQ(image.layout.light_count, 4);
  const int first = image.layout.triangle_count;
  constexpr int kNothing = -1;
  const int expected[] = {0, 1, 2, kNothing, 3, 4, 3, 4};
  for (int i = 0; i < 8; ++i) {
    const auto in_run = record(image, image.layout.triangles, first + i);
    if (expected[i] == kNothing) {
      EXPECT_EQ(vector(in_run.back), glm::dvec3(0.0)) << i;
    } else {
      EXPECT_EQ(in_run.number, expected[i]) << i;
    }
  }
}

TEST(MonoImage, TrianglesThatAreNoHalvesStayApart) {
  path_tracer::ProgramConfig config;
  config.light_sampling = path_tracer::LightSampling::solid_angle;
  Scene bent = lights_of_all_shapes();
  bent.triangles.resize(2);
  bent.triangles[1].vertex[2].z = 0.5;
  EXPECT_EQ(make_mono_image(bent, 96, config).layout.light_count, 2);
  Scene two_colours = lights_of_all_shapes();
  two_colours.triangles.resize(2);
  two_colours.triangles[1].material = 2;
  EXPECT_EQ(make_mono_image(two_colours, 96, config).layout.light_count, 2);
}

/// The cdf is that of the classes, and a light's density is that of its class in equal parts.
TEST(MonoImage, CdfOfManyLightsAscendsToOne) {
  const MonoImage image = make_mono_image(test_support::triangle_soup(800, 5, {8, 8}), 96, {});
  ASSERT_EQ(image.layout.light_count, 100);
  ASSERT_GE(image.layout.light_class_count, 1);
  double before = 0;
  int lights = 0;
  for (int i = 0; i < image.layout.light_class_count; ++i) {
    const double now = record(image, image.layout.light_cdf, i);
    EXPECT_GT(now, before);
    const auto of_class = record(image, image.layout.light_classes, i);
    EXPECT_EQ(of_class.first, lights);
    for (; lights < of_class.first + of_class.count; ++lights) {
      const auto light = record(image, image.layout.lights, lights);
      const double area = 0.5 * glm::length(glm::cross(vector(light.edge1), vector(light.edge2)));
      EXPECT_NEAR(light.inverse_pdf, area * of_class.count / (now - before), 1e-9 * light.inverse_pdf);
    }
    before = now;
  }
  EXPECT_EQ(lights, 100);
  EXPECT_EQ(before, 1.0);
}

TEST(MonoImage, SceneWithoutLightIsRefusedByName) {
  Scene scene = three_triangles();
  for (testbench::Material& material : scene.materials) material.emission = glm::dvec3(0.0);
  const std::string message = test_support::input_error_of([&] { make_mono_image(scene, 96, {}); });
  EXPECT_EQ(message.rfind("three: ", 0), 0u) << message;
  scene.triangles.clear();
  EXPECT_THROW(make_mono_image(scene, 96, {}), testbench::InputError);
}

/// The direction through a film position in pixels, x to the right and y down.
glm::dvec3 direction(const CameraRecord& camera, double x, double y) {
  return glm::normalize(vector(camera.direction) + x * vector(camera.right) + y * vector(camera.down));
}

TEST(MonoImage, CameraSpansTheFieldOfView) {
  Scene scene = three_triangles();
  scene.camera.direction = glm::normalize(glm::dvec3(1, 1, 0));
  scene.camera.up = {0, 0, 1};
  const glm::dvec3 right = glm::normalize(glm::dvec3(1, -1, 0));
  const MonoImage image = make_mono_image(scene, 96, {});
  const auto camera = record(image, image.layout.camera);
  EXPECT_EQ(vector(camera.position), scene.camera.position);
  EXPECT_EQ(camera.width, 6);
  EXPECT_EQ(camera.height, 4);
  const auto expect_direction = [&](double x, double y, double to_right, double up) {
    const double half = std::tan(0.4);  // tangent of half the vertical field of view; pixels are square
    const glm::dvec3 expected = glm::normalize(scene.camera.direction + right * (to_right * half * 1.5) +
                                               scene.camera.up * (up * half));
    EXPECT_LT(glm::length(direction(camera, x, y) - expected), 1e-15) << x << ", " << y;
  };
  expect_direction(3, 2, 0, 0);
  expect_direction(0, 0, -1, 1);
  expect_direction(6, 0, 1, 1);
  expect_direction(0, 4, -1, -1);
  expect_direction(6, 4, 1, -1);
  expect_direction(0.5, 0.5, -2.5 / 3, 1.5 / 2);
  // The vertical field of view is the angle between the middles of the upper and the lower edge.
  EXPECT_NEAR(std::acos(glm::dot(direction(camera, 3, 0), direction(camera, 3, 4))), 0.8, 1e-14);
}

struct Piece {
  std::uint64_t first;
  std::uint64_t bytes;
};

TEST(MonoImage, PiecesLieOneBehindTheOther) {
  path_tracer::ProgramConfig config;
  config.bin_blocks = 5;
  config.slot_vertices = 12;
  constexpr std::uint64_t kSlots = 5 * 32;
  const MonoImage image = make_mono_image(three_triangles(), 32, config);
  const path_tracer::Layout& layout = image.layout;
  const Piece pieces[] = {
      {layout.camera.address, sizeof(CameraRecord)},
      {layout.triangles.address, 3 * sizeof(TriangleRecord)},
      {layout.surfaces.address, 3 * sizeof(SurfaceRecord)},
      {layout.lights.address, 2 * sizeof(LightRecord)},
      {layout.light_cdf.address, 2 * sizeof(double)},
      {layout.ray_bin.address, kSlots * sizeof(path_tracer::RayRecord)},
      {layout.intersection_bin.address, kSlots * sizeof(path_tracer::HitRecord)},
      {layout.scatter_bin.address, kSlots * sizeof(path_tracer::ScatterRecord)},
      {layout.lighting_bin.address, kSlots * sizeof(path_tracer::LightingRecord)},
      {layout.direct_light_bin.address, kSlots * sizeof(path_tracer::DirectLightRecord)},
      {layout.path_bin.address, kSlots * sizeof(path_tracer::PathRecord)},
      {layout.vertices.address, 12 * kSlots * sizeof(path_tracer::VertexRecord)},
      {layout.folds.address, kSlots * sizeof(path_tracer::FoldRecord)},
      {layout.finished.address, kSlots * sizeof(path_tracer::FinishedRecord)},
      {layout.results_header[0].address, sizeof(path_tracer::ResultsHeader)},
      {layout.results_header[1].address, sizeof(path_tracer::ResultsHeader)},
      {layout.results[0].address, kSlots * sizeof(path_tracer::RadianceRecord)},
      {layout.results[1].address, kSlots * sizeof(path_tracer::RadianceRecord)},
  };
  std::uint64_t end = 0;
  for (const Piece& piece : pieces) {
    EXPECT_GE(piece.first, end);
    EXPECT_LT(piece.first, end + 64);
    EXPECT_EQ(piece.first % 64, 0u);
    end = piece.first + piece.bytes;
  }
  EXPECT_GE(layout.total_bytes, end);
  EXPECT_LT(layout.total_bytes, end + 64);
  EXPECT_EQ(image.bytes.size(), layout.scene_bytes);
  EXPECT_EQ(layout.scene_bytes, layout.ray_bin.address);
}

}  // namespace mono_image_test
