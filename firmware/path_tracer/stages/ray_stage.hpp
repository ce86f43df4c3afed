#pragma once

#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// Ray stage of brute force: intersects each ray of the ray bin with every triangle, segments and shadow rays
/// alike.
class RayStage : public Stage {
 public:
  using Stage::Stage;
  static constexpr int kLoadBytes = sizeof(RayRecord);
  static int save_bytes(const ProgramConfig& config) { return RecordSizes(config.features).hit; }

  const char* name() const override { return "ray stage"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

 private:
  /// Returns the kernel.
  const cn::Kernel<IntersectArguments>& choose_search(IntersectArguments& arguments);
  SearchTree make_tree(const IntersectArguments& arguments) const;

  // The simulator's, made when the triangles are first read:
  Prefilter prefilter_;
  SearchTree tree_;
};

}  // namespace path_tracer
