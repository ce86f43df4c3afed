// The simulator's prefilter against brute force without it: the same hits to the last bit, and the same
// charged instructions, however many PEs have a ray.

#include <gtest/gtest.h>

#include "tests/support/native_example.hpp"
#include "tests/support/search_meshes.hpp"
#include "tests/support/test_rays.hpp"
#include "tests/support/tree_search.hpp"

namespace prefilter_search_test {

using path_tracer::RayRecord;
using test_support::RaySearch;
using test_support::SearchHit;
using test_support::SearchScene;
using test_support::TestRays;

struct Issued {
  std::vector<cn::IssueCounts> counts;
  std::vector<std::uint64_t> enabled_lanes;

  explicit Issued(const cn::IssueTree& tree) {
    tree.for_each_node([this](const cn::IssueTree::Node& node) {
      counts.push_back(node.counts);
      enabled_lanes.push_back(node.enabled_lanes);
    });
  }
  bool operator==(const Issued& other) const {
    return counts == other.counts && enabled_lanes == other.enabled_lanes;
  }
};

class PrefilterSearch : public testing::TestWithParam<std::tuple<test_support::NamedMesh, cn::Level>> {};

TEST_P(PrefilterSearch, FindsAndIssuesWhatATestOfEveryTriangleDoes) {
  const auto& [mesh, level] = GetParam();
  const testbench::Scene scene = test_support::scene_of(mesh.make());
  const SearchScene searched =
      test_support::search_scene(scene, {{path_tracer::NodeFormat::fp32, 4}, 1, 1, 2, 0, 0});
  const path_tracer::Prefilter prefilter = path_tracer::make_prefilter(
      searched.records(), searched.triangle_count, searched.reach, searched.layers);
  RaySearch search(level);
  TestRays source(scene, 31);
  int hits = 0;
  unsigned rays_in_all = 0;
  for (int batch = 0; batch < 150; ++batch) {
    const int count = batch % 3 == 0 ? 1 + batch % RaySearch::kPes : RaySearch::kPes;
    std::vector<RayRecord> rays;
    for (int i = 0; i < count; ++i) rays.push_back(source.ray(rays_in_all++ % TestRays::kKinds));
    const std::vector<SearchHit> expected = search.brute_force(searched, rays);
    const Issued all_tested(search.issued());
    const std::vector<SearchHit> found = search.brute_force(searched, rays, &prefilter);
    EXPECT_TRUE(Issued(search.issued()) == all_tested);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_TRUE(same(found[i], expected[i]))
          << "a ray hits " << found[i].number << " instead of " << expected[i].number;
      hits += found[i].number >= 0;
    }
  }
  EXPECT_GT(hits, int(rays_in_all) / 20);
}

INSTANTIATE_TEST_SUITE_P(Meshes, PrefilterSearch,
                         testing::Combine(testing::ValuesIn(test_support::search_meshes()),
                                          testing::ValuesIn(cn::usable_levels())),
                         [](const auto& suite) {
                           return std::string(std::get<0>(suite.param).name) + "_v" +
                                  std::to_string(2 + int(std::get<1>(suite.param)));
                         });

}  // namespace prefilter_search_test
