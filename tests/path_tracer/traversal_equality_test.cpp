// Kernels of tree traversals against the kernel that tests every triangle: the same answer, to the last bit,
// in every format of nodes and shape of tree, however short the stack, wherever rays continue.

#include <gtest/gtest.h>

#include "tests/support/meshes.hpp"
#include "tests/support/node_layouts.hpp"
#include "tests/support/search_meshes.hpp"
#include "tests/support/test_rays.hpp"
#include "tests/support/tree_search.hpp"

namespace traversal_equality_test {

using path_tracer::NodeFormat;
using path_tracer::QueuedRay;
using path_tracer::RayRecord;
using path_tracer::TreeShape;
using test_support::RaySearch;
using test_support::scene_of;
using test_support::search_scene;
using test_support::SearchHit;
using test_support::SearchScene;
using test_support::TestRays;
using testbench::Scene;

/// All formats, sizes of leaves and treelets, and numbers of resident nodes; each is tried with several
/// stacks.
std::vector<TreeShape> shapes() {
  std::vector<TreeShape> shapes;
  for (const path_tracer::NodeLayout& layout : test_support::node_layouts())
    for (const int leaf_triangles : {1, 2, 4, 8})
      for (const int treelet_nodes : {1, 4, 16})
        for (const int resident_nodes : {1, 8})
          shapes.push_back({layout, resident_nodes, treelet_nodes, leaf_triangles, 0});
  return shapes;
}

std::string describe(const TreeShape& shape) {
  return "format " + std::to_string(int(shape.layout.format)) + " of " + std::to_string(shape.layout.width) +
         " children, " + std::to_string(shape.leaf_triangles) + " triangles a leaf, " +
         std::to_string(shape.treelet_nodes) + " nodes a treelet, " + std::to_string(shape.resident_nodes) +
         " resident, stack of " + std::to_string(shape.stack_entries) + ", " + std::to_string(shape.visits) +
         " visits a turn";
}

constexpr int kStacks[] = {0, 1, 2, 8, 32};
constexpr int kVisits[] = {0, 1, 2, 4};

class TraversalEquality : public testing::TestWithParam<test_support::NamedMesh> {
 protected:
  RaySearch search_{cn::widest_level()};
};

TEST_P(TraversalEquality, EveryRayHitsWhatBruteForceHits) {
  const Scene scene = scene_of(GetParam().make());
  TestRays source(scene, 19);
  int hits = 0;
  int rays_in_all = 0;
  std::size_t searches = 0;
  for (const TreeShape& shape : shapes()) {
    SearchScene searched = search_scene(scene, shape);
    for (int batch = 0; batch < 3; ++batch) {
      std::vector<RayRecord> rays;
      std::vector<QueuedRay> queued;
      for (int i = 0; i < RaySearch::kPes; ++i) {
        rays.push_back(source.ray(unsigned(rays_in_all + i) % TestRays::kKinds));
        queued.push_back({rays.back(), 0, 0});
      }
      const std::vector<SearchHit> expected = search_.brute_force(searched, rays);
      for (const int stack : kStacks) {
        searched.shape.stack_entries = stack;
        searched.shape.visits = kVisits[searches++ % std::size(kVisits)];
        const std::vector<SearchHit> found = search_.through_tree(searched, queued, batch % 2 == 0);
        for (std::size_t i = 0; i < rays.size(); ++i)
          ASSERT_TRUE(same(found[i], expected[i])) << describe(searched.shape) << ": a ray hits "
                                                   << found[i].number << " instead of " << expected[i].number;
        for (const SearchHit& hit : found) hits += hit.number >= 0;
        rays_in_all += int(found.size());
      }
    }
  }
  EXPECT_GT(rays_in_all, 60000);  // by all meshes: more than a million
  EXPECT_GT(hits, rays_in_all / 20);
}

/// A shadow ray need not tell what is in its way. Whether something is must be the same, and so must the hit
/// on the light.
void expect_the_same_lights_seen(const Scene& scene, RaySearch& search) {
  const std::vector<std::vector<std::size_t>> lights = test_support::lights_of(scene);
  TestRays source(scene, 29);
  int lit = 0;
  for (const TreeShape& shape : shapes()) {
    if (shape.treelet_nodes > 4) continue;
    SearchScene searched = search_scene(scene, shape);
    std::vector<RayRecord> rays;
    std::vector<QueuedRay> queued;
    for (std::size_t i = 0; i < std::size_t(RaySearch::kPes); ++i) {
      const std::size_t light = i % lights.size();
      rays.push_back(i % 7 == 0 ? source.ray(6) : source.shadow_ray(lights[light]));
      queued.push_back({rays.back(), 0, std::int32_t(light)});
    }
    const std::vector<SearchHit> expected = search.brute_force(searched, rays);
    const auto sees = [&](const SearchHit& hit, std::size_t i) {
      return sees_light(searched, source, hit, rays[i].light_face, queued[i].light);
    };
    for (const int stack : {0, 2, 8}) {
      searched.shape.stack_entries = stack;
      searched.shape.visits = kVisits[std::size_t(shape.leaf_triangles + stack) % std::size(kVisits)];
      const std::vector<SearchHit> found = search.through_tree(searched, queued, stack == 2);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool is_segment = rays[i].light_face == path_tracer::kNoFace;
        ASSERT_EQ(sees(found[i], i), sees(expected[i], i)) << describe(searched.shape) << ": ray " << i;
        if (is_segment || sees(found[i], i)) {
          ASSERT_TRUE(same(found[i], expected[i])) << describe(searched.shape) << ": ray " << i;
        }
        lit += !is_segment && sees(found[i], i);
      }
    }
  }
  EXPECT_GT(lit, 20);
}

TEST_P(TraversalEquality, EveryShadowRaySeesTheLightThatBruteForceSees) {
  expect_the_same_lights_seen(scene_of(GetParam().make()), search_);
}

INSTANTIATE_TEST_SUITE_P(Meshes, TraversalEquality, testing::ValuesIn(test_support::search_meshes()),
                         [](const auto& suite) { return std::string(suite.param.name); });

/// A ray towards an edge that two triangles of one face share hits both. By rounding, a decal may lie between
/// the two hits: it must not end the ray before the nearer one is found.
TEST(TraversalOfLights, ThatShareEdgesUnderADecalAreSeenAsByBruteForce) {
  RaySearch search(cn::widest_level());
  expect_the_same_lights_seen(scene_of(test_support::decals()), search);
}

/// Rays that hit nothing, from a root that leads nowhere.
TEST(TraversalOfNothing, HitsNothing) {
  RaySearch search(cn::widest_level());
  for (TreeShape shape : shapes()) {
    shape.stack_entries = 2;
    const SearchScene scene = test_support::empty_search_scene(shape);
    RayRecord ray;
    ray.direction = {0, 1, 0};
    const auto expected = search.brute_force(scene, {ray, ray});
    const auto found = search.through_tree(scene, {{ray, 0, 0}, {ray, 0, 0}}, false);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(found[i].number, -1);
      EXPECT_TRUE(same(found[i], expected[i]));
    }
  }
}

/// The purpose of the tree: a ray tests few of 2000 triangles.
TEST(TraversalTurns, AreFewWhereTreeletsAndStacksAreLarge) {
  const Scene scene = scene_of(test_support::mesh(test_support::Mesh::soup));
  TestRays source(scene, 5);
  std::vector<QueuedRay> rays;
  for (int i = 0; i < RaySearch::kPes; ++i) rays.push_back({source.ray(0), 0, 0});
  const auto turns = [&](int treelet_nodes, int stack_entries, int visits = 0) {
    RaySearch search(cn::widest_level());
    search.through_tree(
        search_scene(scene, {{NodeFormat::fp32, 4}, 1, treelet_nodes, 2, stack_entries, visits}), rays,
        false);
    return double(search.turns()) / double(rays.size());
  };
  const double with_both = turns(16, 32);
  EXPECT_LT(with_both, 30);
  EXPECT_LT(with_both, turns(1, 32));
  EXPECT_LT(with_both, turns(16, 0));
  EXPECT_LT(with_both, turns(16, 32, 2));
  EXPECT_LT(turns(16, 32, 2), turns(16, 32, 1));
}

}  // namespace traversal_equality_test
