// The search for four rays of a PE by vector instructions against the ray stage's brute force: the same hits
// to the last bit, for rays that are hard to tell apart.

#include "firmware/path_tracer/kernels/search_by_vectors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/native_example.hpp"
#include "tests/support/search_meshes.hpp"
#include "tests/support/tree_search.hpp"

namespace search_by_vectors_test {

using path_tracer::PathMasks;
using path_tracer::PolyPointer;
using path_tracer::RayRecord;
using path_tracer::ResidentPath;
using path_tracer::ResidentRay;
using path_tracer::ResidentSearchArguments;
using test_support::RaySearch;
using test_support::SearchHit;
using test_support::SearchScene;

/// Rays as paths have them, four to a PE.
class ResidentRays {
 public:
  explicit ResidentRays(const std::vector<RayRecord>& rays)
      : rays_(rays),
        memory_(RaySearch::kPes, 4096),
        paths_(memory_.allocate("paths", 4 * int{sizeof(ResidentPath)})),
        vectors_(memory_.allocate("vectors", path_tracer::kSearchVectors * 32)) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const RayRecord& from = rays[i];
      put(i, {from.origin, from.direction, NAN, NAN, 77, from.left_face});
      wanted_[i % 4].set(int(i / 4), true);
    }
  }

  std::vector<SearchHit> search(const SearchScene& scene, cn::Level level) {
    ResidentSearchArguments arguments;
    arguments.rays = PolyPointer<ResidentPath>(paths_).part(&ResidentPath::segment);
    arguments.vectors = vectors_;
    arguments.wanted = &wanted_;
    arguments.triangles = scene.records();
    arguments.triangle_count = scene.triangle_count;
    arguments.reach = scene.reach;
    cn::LaneMask enabled;
    for (const cn::LaneMask& mask : wanted_) enabled = enabled.with(mask);
    path_tracer::kernels(level).resident().search_by_vectors.run(arguments, memory_, enabled, issued_);
    std::vector<SearchHit> hits;
    for (std::size_t i = 0; i < rays_.size(); ++i) hits.push_back(hit_of(i));
    return hits;
  }

  const cn::IssueTree& issued() const { return issued_; }

 private:
  int place(std::size_t i) const { return paths_.offset_bytes + int(i % 4) * int{sizeof(ResidentPath)}; }
  void put(std::size_t i, const ResidentRay& ray) {
    std::uint64_t words[sizeof(ResidentRay) / 8];
    std::memcpy(words, &ray, sizeof(ray));
    for (std::size_t w = 0; w < std::size(words); ++w)
      memory_.word(int(i / 4), place(i) + int(8 * w)) = words[w];
  }
  SearchHit hit_of(std::size_t i) {
    ResidentRay ray;
    std::uint64_t words[sizeof(ResidentRay) / 8];
    for (std::size_t w = 0; w < std::size(words); ++w)
      words[w] = memory_.word(int(i / 4), place(i) + int(8 * w));
    std::memcpy(&ray, words, sizeof(ray));
    const double distance = ray.distance / std::abs(ray.determinant);
    return {ray.number,
            {ray.origin + ray.direction * distance, ray.number >= 0 ? 1 : 0, ray.determinant > 0 ? 1 : 0}};
  }

  const std::vector<RayRecord>& rays_;
  cn::PolyMemory memory_;
  cn::PolySpan paths_;
  cn::PolySpan vectors_;
  PathMasks wanted_;
  cn::IssueTree issued_;
};

constexpr path_tracer::TreeShape kAnyTree = {{path_tracer::NodeFormat::fp32, 4}, 1, 1, 2, 0, 0};

/// Resident paths are not for layered scenes.
std::vector<test_support::NamedMesh> meshes_without_layers() {
  std::vector<test_support::NamedMesh> meshes;
  for (const test_support::NamedMesh& mesh : test_support::search_meshes())
    if (!test_support::search_scene(test_support::scene_of(mesh.make()), kAnyTree).layers.any)
      meshes.push_back(mesh);
  return meshes;
}

class SearchByVectors : public testing::TestWithParam<std::tuple<test_support::NamedMesh, cn::Level>> {};

TEST_P(SearchByVectors, FindsWhatBruteForceFinds) {
  const auto& [mesh, level] = GetParam();
  const testbench::Scene scene = test_support::scene_of(mesh.make());
  const SearchScene searched = test_support::search_scene(scene, kAnyTree);
  RaySearch search(level);
  expect_hits_of_brute_force(scene, searched, search, 47, [&, used = level](const auto& rays) {
    return ResidentRays(rays).search(searched, used);
  });
}

INSTANTIATE_TEST_SUITE_P(Meshes, SearchByVectors,
                         testing::Combine(testing::ValuesIn(meshes_without_layers()),
                                          testing::ValuesIn(cn::usable_levels())),
                         [](const auto& suite) {
                           return std::string(std::get<0>(suite.param).name) + "_v" +
                                  std::to_string(2 + int(std::get<1>(suite.param)));
                         });

cn::IssueCounts issued_for(const std::vector<path_tracer::TriangleRecord>& triangles) {
  SearchScene scene;
  scene.triangle_count = int(triangles.size());
  const auto* const bytes = reinterpret_cast<const char*>(triangles.data());
  scene.triangles.assign(bytes, bytes + triangles.size() * sizeof(triangles[0]));
  scene.reach = 10;
  const std::vector<RayRecord> rays(1, RayRecord{{0.1, 0.2, 1}, {0, 0, -1}});
  ResidentRays of_test(rays);
  of_test.search(scene, cn::narrowest_level());
  return of_test.issued().total();
}

/// Moving to a vertex takes three differences and six products of three components, 15 loads and 6 stores
/// of a vector of 8 words. A triangle that shares its vertex with the one before spares them.
TEST(SearchByVectorsCost, HalvesOfAQuadrilateralShareTheirVertex) {
  using cn::InstructionClass;
  const auto first = path_tracer::triangle_record({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 10.0});
  const auto second = [](const cn::vec3<double>& vertex) {
    return path_tracer::triangle_record(vertex, {0, 1, 0}, {-1, 0, 0}, {1, 1, 10.0});
  };
  const cn::IssueCounts shared = issued_for({first, second({0, 0, 0})});
  const cn::IssueCounts apart = issued_for({first, second({0, 0, -1})});
  EXPECT_EQ(apart[InstructionClass::fp64_add_vector4] - shared[InstructionClass::fp64_add_vector4], 3u);
  EXPECT_EQ(apart[InstructionClass::fp64_mul_vector4] - shared[InstructionClass::fp64_mul_vector4], 3u);
  EXPECT_EQ(apart[InstructionClass::fp64_multiply_add_vector4] -
                shared[InstructionClass::fp64_multiply_add_vector4],
            3u);
  EXPECT_EQ(apart[InstructionClass::sram_vector_load] - shared[InstructionClass::sram_vector_load], 15u * 8);
  EXPECT_EQ(apart[InstructionClass::sram] - shared[InstructionClass::sram], 6u * 8);
}

}  // namespace search_by_vectors_test
