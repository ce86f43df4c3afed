// The simulator's prefilter against brute force without it: the same hits to the last bit, and the same
// charged instructions, however many PEs have a ray.

#include <gtest/gtest.h>

#include "tests/support/native_example.hpp"
#include "tests/support/search_meshes.hpp"
#include "tests/support/tree_search.hpp"

namespace prefilter_search_test {

using path_tracer::RayRecord;
using test_support::RaySearch;
using test_support::SearchHit;
using test_support::SearchScene;

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
  expect_hits_of_brute_force(scene, searched, search, 31, [&](const std::vector<RayRecord>& rays) {
    const Issued all_tested(search.issued());
    std::vector<SearchHit> found = search.brute_force(searched, rays, &prefilter);
    EXPECT_TRUE(Issued(search.issued()) == all_tested);
    return found;
  });
}

INSTANTIATE_TEST_SUITE_P(Meshes, PrefilterSearch,
                         testing::Combine(testing::ValuesIn(test_support::search_meshes()),
                                          testing::ValuesIn(cn::usable_levels())),
                         [](const auto& suite) {
                           return std::string(std::get<0>(suite.param).name) + "_v" +
                                  std::to_string(2 + int(std::get<1>(suite.param)));
                         });

}  // namespace prefilter_search_test
