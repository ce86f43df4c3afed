#include "testbench/paper/paper_alternatives.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "model/config/chip_presets.hpp"
#include "testbench/mono_image/faces.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "tests/support/scenes.hpp"

namespace paper_alternatives_test {

using testbench::Assumptions;
using testbench::Scene;
using testbench::Triangle;

double area(const Triangle& triangle) {
  return 0.5 * glm::length(testbench::area_normal(triangle));
}

std::map<int, double> area_by_material(const Scene& scene) {
  std::map<int, double> areas;
  for (const Triangle& triangle : scene.triangles) areas[triangle.material] += area(triangle);
  return areas;
}

int face_count(const Scene& scene) {
  const auto faces = testbench::number_faces(scene.triangles);
  return static_cast<int>(std::set<std::int32_t>(faces.begin(), faces.end()).size());
}

TEST(FourTimesTheTriangles, CoverTheSameArea) {
  for (const Scene& scene :
       {test_support::small_cornell_box({8, 8}), test_support::triangle_soup(40, 3, {8, 8})}) {
    const Scene finer = testbench::with_four_times_the_triangles(scene);
    ASSERT_EQ(finer.triangles.size(), 4 * scene.triangles.size());
    const auto expected = area_by_material(scene);
    const auto found = area_by_material(finer);
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [material, size] : expected) EXPECT_NEAR(found.at(material) / size, 1.0, 1e-12);
    EXPECT_EQ(face_count(finer), face_count(scene));
  }
}

TEST(FourTimesTheTriangles, AreQuartersInThePlaceOfEach) {
  const Scene scene = test_support::triangle_soup(40, 3, {8, 8});
  const Scene finer = testbench::with_four_times_the_triangles(scene);
  for (std::size_t i = 0; i < finer.triangles.size(); ++i) {
    const Triangle& whole = scene.triangles[i / 4];
    const Triangle& part = finer.triangles[i];
    const glm::dvec3 normal = testbench::area_normal(whole);
    EXPECT_EQ(part.material, whole.material);
    EXPECT_LT(glm::length(testbench::area_normal(part) - 0.25 * normal), 1e-12 * glm::length(normal));
    for (const glm::dvec3& vertex : part.vertex) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) {
        const Triangle beside{{vertex, whole.vertex[k], whole.vertex[(k + 1) % 3]}, 0};
        sum += area(beside);
      }
      EXPECT_NEAR(sum / area(whole), 1.0, 1e-9) << "a corner lies outside";
    }
  }
}

class PaperAlternatives : public testing::Test {
 protected:
  PaperAlternatives() : base{"preset paper", model::preset("paper"), testbench::paper_program(), box()} {}

  static Scene box() { return test_support::small_cornell_box({24, 16}); }
  static std::string differences(const Assumptions& a, const Assumptions& b) {
    std::string found;
    const auto note = [&](bool differs, const char* what) {
      if (differs) found += found.empty() ? what : std::string(", ") + what;
    };
    note(a.chip.chip.clock_hz != b.chip.chip.clock_hz, "clock");
    note(a.chip.ddr.refresh_interval_cycles != b.chip.ddr.refresh_interval_cycles, "refresh");
    note(a.chip.pio.arbitration != b.chip.pio.arbitration, "arbitration");
    note(a.chip.control.transfer_call_cycles != b.chip.control.transfer_call_cycles, "call");
    note(a.chip.board.chips != b.chip.board.chips, "chips");
    note(a.fits_transfer_call != b.fits_transfer_call, "fit");
    note(a.scene.triangles.size() != b.scene.triangles.size(), "triangles");
    note(a.program.roulette_start != b.program.roulette_start, "roulette");
    note(a.program.cull_shadow_rays != b.program.cull_shadow_rays, "shadow rays");
    note(a.program.bin_blocks != b.program.bin_blocks, "bins");
    return found;
  }

  Assumptions base;
};

TEST_F(PaperAlternatives, EachChangesWhatItsNameSays) {
  const Scene closed_box = test_support::closed_cube(0.5, 0.5, {4, 4});
  const auto all = testbench::paper_alternatives(base, closed_box);
  std::map<std::string, std::string> found;
  for (const Assumptions& assumptions : all) found[assumptions.name] = differences(assumptions, base);
  const std::map<std::string, std::string> expected = {
      {"preset paper", ""},
      {"clock of 250 MHz", "clock, refresh"},
      {"both chips of the board", "chips"},
      {"four times the triangles", "triangles"},
      {"closed box", "triangles"},
      {"roulette from the first segment", "roulette"},
      {"shadow rays only where facing", "shadow rays"},
      {"bins of 4 blocks", "bins"},
      {"bins of 16 blocks", "bins"},
      {"PIO serves in strict order", "arbitration"},
      {"a PIO engine each way", "arbitration"},
      {"no cost of a call fitted", "call, fit"},
  };
  EXPECT_EQ(found, expected);
  EXPECT_EQ(all.size(), expected.size());
  EXPECT_EQ(all.front().name, "preset paper");
}

TEST_F(PaperAlternatives, AllRunTheFilmOfTheBase) {
  for (const Assumptions& assumptions :
       testbench::paper_alternatives(base, test_support::closed_cube(0.5, 0.5, {4, 4}))) {
    EXPECT_EQ(assumptions.scene.film.width, 24) << assumptions.name;
    EXPECT_EQ(assumptions.scene.film.height, 16) << assumptions.name;
  }
}

}  // namespace paper_alternatives_test
