#pragma once

#include "firmware/path_tracer/bidirectional/pair_context.hpp"
#include "firmware/path_tracer/stages/ray_store.hpp"

namespace path_tracer {

/// Connection stage: makes the next ray of each slot, a segment of either path or a test of what two vertices
/// that are joined would bring. The slot's newest vertex is loaded, and what it is joined with: a point of a
/// light or a vertex of the light path.
class ConnectionStage : public Stage {
 public:
  ConnectionStage(const StageContext& context, PairContext& pairs, RayStore& rays)
      : Stage(context), pairs_(pairs), rays_(rays) {}
  static int load_bytes(const ProgramConfig& config);
  static int save_bytes(const ProgramConfig& config);

  const char* name() const override { return "connection stage"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

 private:
  struct Loads {
    PolyPointer<PairRecord> pair;
    PolyPointer<PathVertexRecord> near_vertex;
    PolyPointer<PathVertexRecord> far_vertex;
    PolyPointer<LightRecord> light;
    PolyPointer<LightEmissionRecord> emission;
  };
  struct Saves {
    PolyPointer<PairRecord> pair;
    RayRoom ray;
  };
  Loads loads(std::uint64_t step) const;
  Saves saves(std::uint64_t step) const;
  void count(const PairContext::Block& pairs, const LaneMask& connects, const LaneMask& culled);

  PairContext& pairs_;
  RayStore& rays_;
};

}  // namespace path_tracer
