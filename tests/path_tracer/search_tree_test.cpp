// The simulator's tree, where nothing is charged, against brute force: the same hits to the last bit.

#include "firmware/path_tracer/prefilter/search_tree.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/native_example.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/search_meshes.hpp"
#include "tests/support/test_rays.hpp"
#include "tests/support/tree_search.hpp"

namespace search_tree_test {

using path_tracer::RayRecord;
using path_tracer::SearchNode;
using path_tracer::SearchTree;
using test_support::RaySearch;
using test_support::SearchHit;
using test_support::SearchScene;
using test_support::TestRays;

/// @param lights whose faces end searches early
SearchTree tree_of(const SearchScene& scene, const std::vector<path_tracer::LightRecord>& lights = {}) {
  return path_tracer::make_search_tree(scene.records(), scene.triangle_count, scene.reach, scene.layers,
                                       lights.data(), int(lights.size()));
}

SearchScene searched_scene(const testbench::Scene& scene) {
  return test_support::search_scene(scene, {{path_tracer::NodeFormat::fp32, 4}, 1, 1, 2, 0, 0});
}

class SearchTreeHits : public testing::TestWithParam<std::tuple<test_support::NamedMesh, cn::Level>> {};

TEST_P(SearchTreeHits, AreThoseOfATestOfEveryTriangle) {
  const auto& [mesh, level] = GetParam();
  const testbench::Scene scene = test_support::scene_of(mesh.make());
  const SearchScene searched = searched_scene(scene);
  const SearchTree tree = tree_of(searched);
  RaySearch search(level);
  expect_hits_of_brute_force(scene, searched, search, 37, [&](const std::vector<RayRecord>& rays) {
    return search.brute_force(searched, rays, nullptr, &tree);
  });
}

/// The faces of a scene's lights are all that a search tree reads of them.
std::vector<path_tracer::LightRecord> light_faces(const std::vector<std::vector<std::size_t>>& lights,
                                                  const TestRays& source) {
  std::vector<path_tracer::LightRecord> records;
  for (const std::vector<std::size_t>& light : lights) {
    records.emplace_back();
    records.back().face = source.face(std::int32_t(light[0]));
  }
  return records;
}

/// A shadow ray may end at anything that hides its light. So only whether it sees the light must be the same,
/// and what it hits there.
void expect_the_same_lights_seen(const testbench::Scene& scene, cn::Level level) {
  const std::vector<std::vector<std::size_t>> lights = test_support::lights_of(scene);
  TestRays source(scene, 41);
  const SearchScene searched = searched_scene(scene);
  const SearchTree tree = tree_of(searched, light_faces(lights, source));
  ASSERT_FALSE(tree.light_leaf.empty());
  RaySearch search(level);
  int seen = 0;
  int hidden = 0;
  for (int batch = 0; batch < 200; ++batch) {
    std::vector<RayRecord> rays;
    for (std::size_t i = 0; i < std::size_t(RaySearch::kPes); ++i)
      rays.push_back(i % 9 == 0 ? source.ray(6) : source.shadow_ray(lights[i % lights.size()]));
    const std::vector<SearchHit> expected = search.brute_force(searched, rays);
    const std::vector<SearchHit> found = search.brute_force(searched, rays, nullptr, &tree);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool is_segment = rays[i].light_face == path_tracer::kNoFace;
      const auto sees = [&](const SearchHit& hit) {
        return sees_light(searched, source, hit, rays[i].light_face, std::int32_t(i % lights.size()));
      };
      ASSERT_EQ(sees(found[i]), sees(expected[i])) << "batch " << batch << ", ray " << i;
      if (is_segment || sees(found[i])) {
        ASSERT_TRUE(same(found[i], expected[i])) << "batch " << batch << ", ray " << i;
      }
      seen += !is_segment && sees(found[i]);
      hidden += !is_segment && !sees(found[i]);
    }
  }
  EXPECT_GT(seen, 100);
  EXPECT_GT(hidden, 100);
}

TEST_P(SearchTreeHits, SeeTheLightsThatATestOfEveryTriangleSees) {
  const auto& [mesh, level] = GetParam();
  expect_the_same_lights_seen(test_support::scene_of(mesh.make()), level);
}

/// By rounding, a decal may lie between the hits of two triangles of a light that share an edge.
TEST(SearchTree, SeesLightsThatShareEdgesUnderADecal) {
  for (const cn::Level level : cn::usable_levels())
    expect_the_same_lights_seen(test_support::scene_of(test_support::decals()), level);
}

INSTANTIATE_TEST_SUITE_P(Meshes, SearchTreeHits,
                         testing::Combine(testing::ValuesIn(test_support::search_meshes()),
                                          testing::ValuesIn(cn::usable_levels())),
                         [](const auto& suite) {
                           return std::string(std::get<0>(suite.param).name) + "_v" +
                                  std::to_string(2 + int(std::get<1>(suite.param)));
                         });

bool exists(const SearchNode& node, int child) {
  return node.plane[0][0][child] <= node.plane[1][0][child];
}

/// Every triangle is in one leaf or among the large ones, and every way from the root ends within the walk's
/// stack.
int levels_below(const SearchTree& tree, std::uint32_t node, std::multiset<std::int32_t>& triangles) {
  int deepest = 0;
  for (int i = 0; i < SearchNode::kChildren; ++i) {
    if (!exists(tree.nodes[node], i)) continue;
    const std::uint32_t child = tree.nodes[node].child[i];
    if (child < SearchTree::kFirstLeaf) {
      deepest = std::max(deepest, levels_below(tree, child, triangles));
      continue;
    }
    const path_tracer::SearchLeaf& leaf = tree.leaves[child - SearchTree::kFirstLeaf];
    triangles.insert(leaf.index, leaf.index + leaf.count);
  }
  return 1 + deepest;
}

TEST(SearchTreeShape, HoldsEachTriangleOnceWithinItsLevels) {
  for (const test_support::NamedMesh& mesh : test_support::search_meshes()) {
    const SearchScene searched = searched_scene(test_support::scene_of(mesh.make()));
    const SearchTree tree = tree_of(searched);
    std::multiset<std::int32_t> triangles;
    for (const path_tracer::LargeTriangle& large : tree.large) triangles.insert(large.index);
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
