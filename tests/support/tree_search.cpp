#include "tests/support/tree_search.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>

#include "testbench/bvh/tree_image.hpp"
#include "tests/support/test_rays.hpp"

namespace test_support {

using cn::LaneMask;
using cn::MonoAddress;
using cn::PolyField;
using cn::PolyPointer;
using path_tracer::HitRecord;
using path_tracer::QueuedRay;
using path_tracer::RayRecord;
using path_tracer::SurfaceRecord;
using path_tracer::TraversalRecord;
using path_tracer::TreeShape;
using path_tracer::TriangleRecord;

namespace {

// Addresses of the arrays in mono memory.
constexpr MonoAddress kTriangles = 0x1000;
constexpr MonoAddress kNodes = 0x300000040;
constexpr MonoAddress kSurfaces = 0x500000080;
constexpr MonoAddress kHits = 0x700000000;
constexpr MonoAddress kSurfacePlaces = 0x900000000;

constexpr int kPolyBytes = 32768;
constexpr std::uint64_t kMostTurns = 200000;

template <class Record>
std::vector<Record> records_at(const testbench::MonoImage& image, MonoAddress first, MonoAddress end) {
  std::vector<Record> records((end - first) / sizeof(Record));
  std::memcpy(records.data(), image.bytes.data() + first, records.size() * sizeof(Record));
  return records;
}

}  // namespace

/// The layout of a PE's SRAM.
struct RaySearch::Offsets {
  explicit Offsets(const SearchScene& scene) {
    const TreeShape& shape = scene.shape;
    int next = 0;
    const auto take = [&](int bytes) {
      const int at = next;
      next += (bytes + 7) / 8 * 8;
      return at;
    };
    record = take(shape.record_bytes());
    ray = take(sizeof(QueuedRay));
    hit = take(sizeof(HitRecord));
    surface_place = take(8);
    hit_to = take(8);
    surface_place_to = take(8);
    leaf_place = take(8);
    treelet_place = take(8);
    treelet_number = take(8);
    leaf = take(shape.leaf_records() * scene.layers.record_bytes());
    treelet = take(shape.treelet_bytes());
    resident = take(shape.resident_bytes());
    end = next;
    if (end > kPolyBytes) throw std::logic_error("tree_search: more SRAM is needed");
  }
  int record, ray, hit, surface_place, hit_to, surface_place_to;
  int leaf_place, treelet_place, treelet_number, leaf, treelet, resident, end;
};

SearchScene search_scene(const testbench::Scene& scene, const TreeShape& shape) {
  path_tracer::ProgramConfig config;
  SearchScene result;
  const testbench::MonoImage plain = testbench::make_mono_image(scene, 96, config);
  const MonoAddress first = plain.layout.triangles.address;
  result.triangle_count = int(scene.triangles.size());
  result.layers = plain.layout.layers;
  result.triangles = records_at<char>(
      plain, first, first + scene.triangles.size() * std::size_t(result.layers.record_bytes()));
  config.traversal = path_tracer::Traversal::refill;
  config.tree = result.shape = shape;
  const testbench::MonoImage tree = testbench::make_mono_image(scene, 96, config);
  for (const auto& region : tree.layout.regions) {
    if (region.first == tree.layout.triangles.address)
      result.leaves = records_at<char>(tree, region.first, region.first + region.bytes);
    if (region.first == tree.layout.nodes.address)
      result.nodes = records_at<std::uint8_t>(tree, region.first, region.first + region.bytes);
  }
  result.reach = tree.layout.reach;
  const MonoAddress surfaces = tree.layout.surfaces.address;
  for (const SurfaceRecord& surface :
       records_at<SurfaceRecord>(tree, surfaces, surfaces + scene.triangles.size() * sizeof(SurfaceRecord)))
    result.light_of.push_back(surface.light);
  return result;
}

SearchScene empty_search_scene(const TreeShape& shape) {
  SearchScene scene;
  scene.shape = shape;
  scene.leaves.resize(std::size_t(shape.leaf_records()) * sizeof(TriangleRecord));
  scene.nodes = testbench::make_tree_image({}, shape).nodes;
  scene.reach = 1.0;
  return scene;
}

bool same(const SearchHit& a, const SearchHit& b) {
  return a.number == b.number && std::memcmp(&a.record, &b.record, sizeof(HitRecord)) == 0;
}

std::vector<std::vector<std::size_t>> lights_of(const testbench::Scene& scene) {
  std::vector<std::vector<std::size_t>> lights;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    if (scene.triangles[i].material == 1) lights.push_back({i});
  return lights;
}

bool sees_light(const SearchScene& scene, const TestRays& source, const SearchHit& hit,
                std::int32_t light_face, std::int32_t light) {
  if (hit.number < 0 || source.face(hit.number) != light_face) return false;
  return !scene.layers.any || scene.light_of[std::size_t(hit.number)] == light;
}

RaySearch::RaySearch(cn::Level level) : kernels_(path_tracer::kernels(level)), memory_(kPes, kPolyBytes) {}

/// Overwrites SRAM, so that no kernel can depend on data left from earlier.
void RaySearch::scramble(int used_bytes) {
  constexpr std::uint64_t kNoNumber = 0x7ff4dead7fa0beef;  // NaN, as a double and as a float
  for (int pe = 0; pe < kPes; ++pe)
    for (int offset_bytes = 0; offset_bytes < used_bytes; offset_bytes += 8)
      memory_.word(pe, offset_bytes) = kNoNumber;
}

void RaySearch::write(int pe, int offset_bytes, const void* from, std::size_t bytes) {
  const auto* word = static_cast<const char*>(from);
  for (; bytes > 0; bytes -= 8, word += 8, offset_bytes += 8)
    std::memcpy(&memory_.word(pe, offset_bytes), word, 8);
}

void RaySearch::read(int pe, int offset_bytes, void* to, std::size_t bytes) const {
  auto* word = static_cast<char*>(to);
  for (; bytes > 0; bytes -= 8, word += 8, offset_bytes += 8)
    std::memcpy(word, &memory_.word(pe, offset_bytes), 8);
}

SearchHit RaySearch::hit_of(int pe, const Offsets& at) const {
  SearchHit found;
  MonoAddress place = 0;
  read(pe, at.hit, &found.record, sizeof(HitRecord));
  read(pe, at.surface_place, &place, sizeof(place));
  if (found.record.hit != 0) found.number = std::int32_t((place - kSurfaces) / sizeof(SurfaceRecord));
  return found;
}

std::vector<SearchHit> RaySearch::brute_force(const SearchScene& scene, const std::vector<RayRecord>& rays,
                                              const path_tracer::Prefilter* prefilter,
                                              const path_tracer::SearchTree* tree) {
  const Offsets at(scene);
  scramble(at.end);
  const int count = static_cast<int>(rays.size());
  for (int pe = 0; pe < count; ++pe) write(pe, at.ray, &rays[std::size_t(pe)], sizeof(RayRecord));
  LaneMask hit_something;
  path_tracer::IntersectArguments arguments;
  arguments.ray = PolyPointer<RayRecord>(at.ray);
  arguments.triangles = scene.records();
  arguments.triangle_count = scene.triangle_count;
  arguments.layers = scene.layers;
  arguments.prefilter = prefilter;
  arguments.tree = tree;
  arguments.reach = scene.reach;
  arguments.surfaces = {kSurfaces, sizeof(path_tracer::SurfaceRecord)};
  arguments.hit = PolyPointer<HitRecord>(at.hit);
  arguments.surface_place = {at.surface_place};
  arguments.hit_something = &hit_something;
  const auto& intersect = tree == nullptr ? kernels_.intersect : kernels_.intersect_through_tree;
  intersect.run(arguments, memory_, LaneMask::first(count), issued_);
  std::vector<SearchHit> hits;
  for (int pe = 0; pe < count; ++pe) hits.push_back(hit_of(pe, at));
  return hits;
}

void expect_hits_of_brute_force(
    const testbench::Scene& scene, const SearchScene& searched, RaySearch& search, unsigned seed,
    const std::function<std::vector<SearchHit>(const std::vector<RayRecord>&)>& search_for) {
  TestRays source(scene, seed);
  int hits = 0;
  unsigned rays_in_all = 0;
  for (int batch = 0; batch < 150; ++batch) {
    const int count = batch % 3 == 0 ? 1 + batch % RaySearch::kPes : RaySearch::kPes;
    std::vector<RayRecord> rays;
    for (int i = 0; i < count; ++i) rays.push_back(source.ray(rays_in_all++ % TestRays::kKinds));
    const std::vector<SearchHit> expected = search.brute_force(searched, rays);
    const std::vector<SearchHit> found = search_for(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_TRUE(same(found[i], expected[i]))
          << "a ray hits " << found[i].number << " instead of " << expected[i].number;
      hits += found[i].number >= 0;
    }
  }
  EXPECT_GT(hits, int(rays_in_all) / 20);
}

std::vector<SearchHit> RaySearch::through_tree(const SearchScene& scene, const std::vector<QueuedRay>& rays,
                                               bool move) {
  const Offsets at(scene);
  scramble(at.end);
  const int count = static_cast<int>(rays.size());
  for (int pe = 0; pe < kPes; ++pe)
    write(pe, at.resident, scene.nodes.data(), std::size_t(scene.shape.resident_bytes()));
  for (int pe = 0; pe < count; ++pe) {
    QueuedRay ray = rays[std::size_t(pe)];
    ray.slot = pe;
    write(pe, at.ray, &ray, sizeof(ray));
  }
  path_tracer::EnterArguments arguments;
  arguments.ray = PolyPointer<QueuedRay>(at.ray);
  arguments.first_light_run = scene.triangle_count;
  arguments.record = PolyPointer<TraversalRecord>(at.record);
  arguments.treelet = {at.treelet_number};
  const LaneMask first_half = LaneMask::first(count / 2);
  const LaneMask second_half = LaneMask::first(count).without(first_half);
  kernels_.traversal().enter.run(arguments, memory_, first_half, issued_);
  std::vector<SearchHit> hits(rays.size());
  LaneMask alive = traverse(scene, at, first_half, nullptr);
  finish(at, first_half.without(alive), hits);
  LaneMask fresh = second_half;
  for (std::uint64_t turn = 0; alive.any() || fresh.any(); ++turn) {
    if (turn > kMostTurns) throw std::runtime_error("tree_search: a ray does not come to its end");
    LaneMask has_leaf;
    load_tree(scene, at, alive, has_leaf);
    if (fresh.any()) kernels_.traversal().enter.run(arguments, memory_, fresh, issued_);
    const LaneMask all = alive.with(fresh);
    fresh = LaneMask{};
    alive = traverse(scene, at, all, has_leaf.any() ? &has_leaf : nullptr);
    finish(at, all.without(alive), hits);
    if (move) alive = move_on(scene, at, alive);
  }
  return hits;
}

void RaySearch::load_tree(const SearchScene& scene, const Offsets& at, const LaneMask& rays,
                          LaneMask& has_leaf) {
  LaneMask has_treelet;
  path_tracer::LocateArguments arguments;
  arguments.record = PolyPointer<TraversalRecord>(at.record);
  arguments.shape = scene.shape;
  arguments.triangles = kTriangles;
  arguments.triangle_bytes = scene.layers.record_bytes();
  arguments.nodes = kNodes;
  arguments.leaf_place = {at.leaf_place};
  arguments.treelet_place = {at.treelet_place};
  arguments.treelet = {at.treelet_number};
  arguments.needs_leaf = &has_leaf;
  arguments.needs_treelet = &has_treelet;
  kernels_.traversal().locate.run(arguments, memory_, rays, issued_);
  const auto bring = [&](int pe, int place_at, MonoAddress array, const void* from, std::size_t size, int to,
                         std::size_t bytes) {
    MonoAddress place = 0;
    read(pe, place_at, &place, sizeof(place));
    if (place < array || place - array + bytes > size)
      throw std::runtime_error("tree_search: a load from outside its array");
    write(pe, to, static_cast<const char*>(from) + (place - array), bytes);
  };
  for (int pe = 0; pe < kPes; ++pe) {
    if (has_leaf[pe])
      bring(pe, at.leaf_place, kTriangles, scene.leaves.data(), scene.leaves.size(), at.leaf,
            std::size_t(scene.shape.leaf_records() * scene.layers.record_bytes()));
    if (has_treelet[pe])
      bring(pe, at.treelet_place, kNodes, scene.nodes.data(), scene.nodes.size(), at.treelet,
            std::size_t(scene.shape.treelet_bytes()));
  }
}

LaneMask RaySearch::traverse(const SearchScene& scene, const Offsets& at, const LaneMask& rays,
                             const LaneMask* has_leaf) {
  LaneMask alive;
  path_tracer::TraverseArguments arguments;
  arguments.record = PolyPointer<TraversalRecord>(at.record);
  arguments.leaf = PolyPointer<TriangleRecord>(at.leaf);
  arguments.treelet = {at.treelet_number};
  arguments.tree = {scene.shape, at.resident, at.treelet};
  arguments.layers = scene.layers;
  arguments.reach = scene.reach;
  arguments.loaded_leaf = has_leaf;
  arguments.alive = &alive;
  kernels_.traversal().traverse_through(scene.shape.layout).run(arguments, memory_, rays, issued_);
  turns_ += std::uint64_t(rays.count());
  return alive;
}

void RaySearch::finish(const Offsets& at, const LaneMask& rays, std::vector<SearchHit>& hits) {
  path_tracer::FinishArguments arguments;
  arguments.record = PolyPointer<TraversalRecord>(at.record);
  arguments.surfaces = {kSurfaces, sizeof(path_tracer::SurfaceRecord)};
  arguments.hits = {kHits, sizeof(HitRecord)};
  arguments.surface_places = kSurfacePlaces;
  arguments.hit = PolyPointer<HitRecord>(at.hit);
  arguments.surface_place = {at.surface_place};
  arguments.hit_to = {at.hit_to};
  arguments.surface_place_to = {at.surface_place_to};
  kernels_.traversal().finish.run(arguments, memory_, rays, issued_);
  for (int pe = 0; pe < kPes; ++pe) {
    if (!rays[pe]) continue;
    MonoAddress to[2];
    read(pe, at.hit_to, to, sizeof(MonoAddress));
    read(pe, at.surface_place_to, to + 1, sizeof(MonoAddress));
    const std::size_t slot = (to[0] - kHits) / sizeof(HitRecord);
    if (to[1] != kSurfacePlaces + slot * sizeof(MonoAddress))
      throw std::runtime_error("tree_search: two slots");
    hits.at(slot) = hit_of(pe, at);
    MonoAddress place = 0;
    read(pe, at.surface_place, &place, sizeof(place));
    if ((place == 0) != (hits[slot].record.hit == 0))
      throw std::runtime_error("tree_search: hit and surface differ");
  }
}

LaneMask RaySearch::move_on(const SearchScene& scene, const Offsets& at, const LaneMask& rays) {
  const auto bytes = std::size_t(scene.shape.record_bytes());
  std::vector<std::vector<char>> records;
  for (int pe = 0; pe < kPes; ++pe) {
    if (!rays[pe]) continue;
    records.emplace_back(bytes);
    read(pe, at.record, records.back().data(), bytes);
  }
  for (std::size_t i = 0; i < records.size(); ++i)
    write(int((i + 1) % records.size()), at.record, records[i].data(), bytes);
  return LaneMask::first(int(records.size()));
}

}  // namespace test_support
