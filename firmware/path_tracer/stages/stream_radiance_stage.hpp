#pragma once

#include <array>
#include <vector>

#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// Radiance in stream execution: one kernel reads an entry of the list and then all vertices of its path,
/// where the radiance stage takes several kernels and keeps the sum in the PE. Its blocks are blocks of the
/// list.
class StreamRadianceStage : public Stage {
 public:
  /// @param load_buffers of the context's ring of loads
  StreamRadianceStage(const StageContext& context, int load_buffers);
  static int load_bytes(const ProgramConfig& config);

  const char* name() const override { return "fold stage"; }
  bool works_on_slots() const override { return false; }
  void load(std::uint64_t step, int block) override;
  bool prepares() const override { return true; }
  bool loads_early() const override { return false; }
  void prepare(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

  void set_results(cn::MonoPointer<RadianceRecord> results) { results_ = results; }
  /// The list has so many entries.
  void begin(int entries) { entries_ = entries; }

 private:
  struct Loads {
    PolyPointer<FinishedRecord> entry;
    FinishedPath path;
    PolyPointer<FoldRecord> earlier;
    PolyPointer<FoldRecord> sum;
    PolyPointer<VertexRecord> vertices;
  };
  struct Saves {
    PolyPointer<RadianceRecord> radiance;
    PolyPointer<FoldRecord> flushed;
  };
  /// What a kernel knows of its paths, from its first loads to its end.
  struct State {
    std::vector<LaneMask> needs_load;
    LaneMask folded;
    LaneMask flushed;
    int loads = 0;
    bool any_partial = false;  ///< whether some paths have vertices elsewhere
  };
  Loads loads(std::uint64_t step) const;
  Saves saves(std::uint64_t step) const;
  LaneMask entries(int block) const;
  State& state(std::uint64_t step) { return states_[step % states_.size()]; }
  void find_vertices(std::uint64_t step, int block);

  std::uint64_t load_buffers_;
  int loads_per_path_;
  int entries_ = 0;
  cn::MonoPointer<RadianceRecord> results_;
  std::vector<State> states_;
};

}  // namespace path_tracer
