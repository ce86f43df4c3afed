#include "testbench/mono_image/light_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "testbench/mono_image/emitter.hpp"
#include "testbench/mono_image/faces.hpp"
#include "testbench/mono_image/light_pilot.hpp"
#include "tests/support/scenes.hpp"

namespace light_choice_test {

using testbench::choose_by;
using testbench::LightChoice;
using testbench::Scene;

TEST(LightChoice, AFewLightsHaveProbabilitiesOfTheirOwn) {
  const LightChoice choice = choose_by({1.0, 4.0, 3.0});
  EXPECT_EQ(choice.cdf, (std::vector<double>{0.125, 0.625, 1.0}));
  EXPECT_EQ(choice.probability, (std::vector<double>{0.125, 0.5, 0.375}));
  EXPECT_EQ(choice.order, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(choice.classes.empty());
}

TEST(LightChoice, ManyLightsFallIntoClassesWithinAFactorOfTwo) {
  std::vector<double> weights;
  std::mt19937 random(5);
  for (int i = 0; i < 5000; ++i) weights.push_back(std::ldexp(1.0 + random() * 0x1p-32, -int(random() % 12)));
  double total = 0;
  for (const double weight : weights) total += weight;
  const LightChoice choice = choose_by(weights);
  ASSERT_EQ(choice.cdf.size(), choice.classes.size());
  ASSERT_EQ(choice.order.size(), weights.size());
  EXPECT_LE(choice.classes.size(), 16u);
  EXPECT_EQ(choice.cdf.back(), 1.0);
  std::vector<bool> is_there(weights.size(), false);
  double sum = 0;
  std::size_t next = 0;
  for (std::size_t c = 0; c < choice.classes.size(); ++c) {
    EXPECT_EQ(std::size_t(choice.classes[c].first), next);
    next += std::size_t(choice.classes[c].count);
    const double of_class = choice.cdf[c] - (c == 0 ? 0.0 : choice.cdf[c - 1]);
    for (auto i = std::size_t(choice.classes[c].first); i < next; ++i) {
      EXPECT_EQ(choice.probability[i], of_class / choice.classes[c].count);
      const double wanted = weights[choice.order[i]] / total;
      EXPECT_LE(choice.probability[i], 2.001 * wanted);
      EXPECT_GE(choice.probability[i], wanted / 2.001);
      is_there[choice.order[i]] = true;
      sum += choice.probability[i];
    }
  }
  EXPECT_EQ(next, weights.size());
  EXPECT_EQ(std::count(is_there.begin(), is_there.end(), false), 0);
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

/// 32-bit random numbers find each of them.
TEST(LightChoice, WeakLightsAmongManyKeepAChance) {
  testbench::Emitter emitter;
  emitter.triangles = {0};
  emitter.power = 1e-30;
  std::vector<testbench::Emitter> emitters(100000, emitter);
  emitters[77].power = 1.0;
  const LightChoice choice = choose_by(testbench::light_weights(Scene{}, emitters).choice);
  EXPECT_EQ(choice.order[0], 77u);
  for (const double probability : choice.probability) ASSERT_GT(probability, 0x1p-24);
}

/// A room with a lamp, and a sealed box with another in it.
Scene hidden_lamp(double emission) {
  Scene scene = test_support::closed_cube(0.5, 0.0, {16, 16});
  const auto lamp = std::int32_t(scene.materials.size());
  scene.materials.push_back({"lamp", glm::dvec3(0.0), glm::dvec3(1.0)});
  scene.materials.push_back({"hidden", glm::dvec3(0.0), glm::dvec3(emission)});
  const auto add = [&](const glm::dvec3& centre, double side, std::int32_t material) {
    const glm::dvec3 a = centre - glm::dvec3(side, 0, side);
    const glm::dvec3 x(2 * side, 0, 0);
    const glm::dvec3 z(0, 0, 2 * side);
    scene.triangles.push_back({{a, a + x, a + x + z}, material});
    scene.triangles.push_back({{a, a + x + z, a + z}, material});
  };
  const std::size_t walls = scene.triangles.size();
  add({0, 0.9, 0}, 0.2, lamp);
  for (std::size_t i = 0; i < walls; ++i) {
    testbench::Triangle wall = scene.triangles[i];
    for (glm::dvec3& vertex : wall.vertex) vertex = 0.1 * vertex + glm::dvec3(0.5, -0.5, 0.5);
    scene.triangles.push_back(wall);
  }
  add({0.5, -0.45, 0.5}, 0.02, lamp + 1);
  return scene;
}

std::vector<double> weights_of(const Scene& scene) {
  return testbench::light_weights(scene,
                                  testbench::surface_emitters(scene, testbench::number_faces(scene.triangles),
                                                              path_tracer::LightSampling::solid_angle))
      .choice;
}

TEST(LightPilot, AHiddenLightKeepsItsShareByPowerAndNoMore) {
  for (const double emission : {1.0, 1e6, 1e8}) {
    const std::vector<double> weights = weights_of(hidden_lamp(emission));
    ASSERT_EQ(weights.size(), 2u);
    const double total = weights[0] + weights[1];
    const double area_ratio = 0.02 * 0.02 / (0.2 * 0.2);
    const double by_power = emission * area_ratio / (1.0 + emission * area_ratio);
    EXPECT_NEAR(weights[1] / total, by_power / 16 + 1.0 / 128, 1e-9) << emission;
  }
}

/// What candidates are taken by (light_candidates.hpp): a strong light that is hidden comes after a weak one
/// that is seen.
TEST(LightPilot, AHiddenLightIsLessVisibleThanItIsStronger) {
  for (const double emission : {1e6, 1e8}) {
    const Scene scene = hidden_lamp(emission);
    const std::vector<double> visibility =
        testbench::light_weights(scene,
                                 testbench::surface_emitters(scene, testbench::number_faces(scene.triangles),
                                                             path_tracer::LightSampling::solid_angle))
            .visibility;
    const double area_ratio = 0.02 * 0.02 / (0.2 * 0.2);
    EXPECT_LT(visibility[1] * emission * area_ratio, 0.2 * visibility[0]) << emission;
  }
}

TEST(LightPilot, NoLightIsFarBelowItsShareByPower) {
  const Scene scene = test_support::triangle_soup(400, 3, {16, 16});
  const std::vector<testbench::Emitter> emitters = testbench::surface_emitters(
      scene, testbench::number_faces(scene.triangles), path_tracer::LightSampling::area);
  const std::vector<double> weights = testbench::light_weights(scene, emitters).choice;
  double power = 0;
  double total = 0;
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    power += emitters[i].power;
    total += weights[i];
  }
  EXPECT_NEAR(total, 1.0, 1e-9);
  bool any_differs = false;
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    EXPECT_GE(weights[i], emitters[i].power / power / 16);
    any_differs = any_differs || std::abs(weights[i] - emitters[i].power / power) > 0.01 * weights[i];
  }
  EXPECT_TRUE(any_differs);
  EXPECT_EQ(testbench::light_weights(scene, emitters).choice, weights);
}

/// Where the paths see no light, and where the lights are one surface, the choice is by power.
TEST(LightPilot, WithoutKnowledgeTheChoiceIsByPower) {
  Scene away = hidden_lamp(3.0);
  for (testbench::Material& material : away.materials) material.reflectance = glm::dvec3(0.0);
  const std::vector<double> weights = weights_of(away);
  EXPECT_NEAR(weights[1] / weights[0], 3.0 * 0.01, 1e-12);
  Scene lamp_alone = hidden_lamp(0.0);
  const auto by_area = testbench::surface_emitters(lamp_alone, testbench::number_faces(lamp_alone.triangles),
                                                   path_tracer::LightSampling::area);
  const std::vector<double> halves = testbench::light_weights(lamp_alone, by_area).choice;
  ASSERT_EQ(halves.size(), 2u);
  EXPECT_EQ(halves[0], by_area[0].power);
}

}  // namespace light_choice_test
