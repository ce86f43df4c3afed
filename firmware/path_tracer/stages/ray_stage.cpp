#include "firmware/path_tracer/stages/ray_stage.hpp"

namespace path_tracer {

void RayStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const PolyPointer<RayRecord> ray(context_.loads.buffer(step));
  load_block(step, block, ray, context_.layout.ray_bin, bin_block(block).live);
}

void RayStage::process(std::uint64_t step, int block) {
  Bins::Block& bin = bin_block(block);
  bin.hit_something = LaneMask{};
  IntersectArguments arguments;
  arguments.ray = PolyPointer<RayRecord>(context_.loads.buffer(step));
  const Layout& layout = context_.layout;
  arguments.triangle_count = layout.triangle_count;
  arguments.triangles = read_triangles(context_.machine, layout, 0, arguments.triangle_count);
  arguments.reach = layout.reach;
  arguments.layers = layout.layers;
  arguments.surfaces = {layout.surfaces.address, layout.sizes.surface};
  arguments.hit_has_tail = layout.sizes.hit_has_tail();
  arguments.hit = PolyPointer<HitRecord>(context_.saves.buffer(step));
  arguments.surface_place = bin.surface_place;
  arguments.hit_something = &bin.hit_something;
  context_.machine.run(choose_search(arguments), arguments, bin.live);
}

/// Where nothing is charged, the simulator finds hits the fastest way that it has: 120 triangles take as long
/// with the tree, 204 take 0.9 and 312 0.75 of the time (`csx600 scene blob`, `render --native`).
const cn::Kernel<IntersectArguments>& RayStage::choose_search(IntersectArguments& arguments) {
  const Layout& layout = context_.layout;
  constexpr int kFewTriangles = 160;
  if (!context_.machine.counts_instructions() && layout.triangle_count > kFewTriangles) {
    if (tree_.empty()) tree_ = make_tree(arguments);
    arguments.tree = &tree_;
    return context_.kernels.intersect_through_tree;
  }
  if (prefilter_.triangles.empty())
    prefilter_ = make_prefilter(arguments.triangles, arguments.triangle_count, layout.reach, layout.layers);
  arguments.prefilter = &prefilter_;
  return context_.kernels.intersect;
}

SearchTree RayStage::make_tree(const IntersectArguments& arguments) const {
  const Layout& layout = context_.layout;
  const LightRecord* const lights =
      context_.machine.read_mono(layout.lights, std::size_t(layout.light_count));
  return make_search_tree(arguments.triangles, arguments.triangle_count, layout.reach, layout.layers, lights,
                          layout.light_count);
}

void RayStage::save(std::uint64_t step, int block) {
  const PolyPointer<HitRecord> hit(context_.saves.buffer(step));
  save_block(step, block, context_.layout.intersection_bin, hit, bin_block(block).live,
             context_.layout.sizes.hit);
}

}  // namespace path_tracer
