// The simulator's tree, where nothing is charged, against brute force: the same hits to the last bit.

#include "firmware/path_tracer/prefilter/search_tree.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/native_example.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/search_meshes.hpp"
#include "tests/support/tree_search.hpp"

namespace search_tree_test {

using path_tracer::RayRecord;
using path_tracer::SearchNode;
using path_tracer::SearchTree;
using test_support::RaySearch;
using test_support::SearchScene;

SearchTree tree_of(const SearchScene& scene) {
  return path_tracer::make_search_tree(scene.records(), scene.triangle_count, scene.reach, scene.layers);
}

class SearchTreeHits : public testing::TestWithParam<std::tuple<test_support::NamedMesh, cn::Level>> {};

TEST_P(SearchTreeHits, AreThoseOfATestOfEveryTriangle) {
  const auto& [mesh, level] = GetParam();
  const testbench::Scene scene = test_support::scene_of(mesh.make());
  const SearchScene searched =
      test_support::search_scene(scene, {{path_tracer::NodeFormat::fp32, 4}, 1, 1, 2, 0, 0});
  const SearchTree tree = tree_of(searched);
  RaySearch search(level);
  expect_hits_of_brute_force(scene, searched, search, 37, [&](const std::vector<RayRecord>& rays) {
    return search.brute_force(searched, rays, nullptr, &tree);
  });
}

INSTANTIATE_TEST_SUITE_P(Meshes, SearchTreeHits,
                         testing::Combine(testing::ValuesIn(test_support::search_meshes()),
                                          testing::ValuesIn(cn::usable_levels())),
                         [](const auto& suite) {
                           return std::string(std::get<0>(suite.param).name) + "_v" +
                                  std::to_string(2 + int(std::get<1>(suite.param)));
                         });

/// Every triangle is in one leaf, and every way from the root ends within the walk's stack.
int levels_below(const SearchTree& tree, std::uint32_t node, std::multiset<std::int32_t>& triangles) {
  int deepest = 0;
  for (int i = 0; i < SearchNode::kChildren; ++i) {
    if ((tree.nodes[node].present >> i & 1u) == 0) continue;
    const std::uint32_t child = tree.nodes[node].child[i];
    if (child < SearchTree::kFirstLeaf) {
      deepest = std::max(deepest, levels_below(tree, child, triangles));
      continue;
    }
    const path_tracer::SearchLeaf& leaf = tree.leaves[child - SearchTree::kFirstLeaf];
    for (int k = 0; k < leaf.count; ++k) triangles.insert(tree.order[std::size_t(leaf.first + k)]);
  }
  return 1 + deepest;
}

TEST(SearchTreeShape, HoldsEachTriangleOnceWithinItsLevels) {
  for (const test_support::NamedMesh& mesh : test_support::search_meshes()) {
    const SearchScene searched = test_support::search_scene(
        test_support::scene_of(mesh.make()), {{path_tracer::NodeFormat::fp32, 4}, 1, 1, 2, 0, 0});
    const SearchTree tree = tree_of(searched);
    std::multiset<std::int32_t> triangles;
    EXPECT_LE(levels_below(tree, 0, triangles), SearchTree::kMostLevels) << mesh.name;
    ASSERT_EQ(int(triangles.size()), searched.triangle_count) << mesh.name;
    EXPECT_EQ(int(std::set<std::int32_t>(triangles.begin(), triangles.end()).size()), searched.triangle_count)
        << mesh.name;
  }
}

TEST(SearchTree, GivesTheImageOfTheFirmware) {
  const testbench::Scene scene = test_support::triangle_soup(700, 5, {16, 12});
  testbench::RenderOptions options = test_support::render_options(path_tracer::Program::full, 2);
  const std::string expected = render_natively(scene, options).film.sha256();
  testbench::search_natively(options);
  EXPECT_EQ(render_natively(scene, options).film.sha256(), expected);
}

}  // namespace search_tree_test
