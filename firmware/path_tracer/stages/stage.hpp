#pragma once

#include "firmware/path_tracer/program/layout.hpp"
#include "firmware/path_tracer/program/run_counts.hpp"
#include "firmware/path_tracer/stages/bins.hpp"
#include "firmware/path_tracer/stages/buffer_cutter.hpp"
#include "firmware/path_tracer/stages/transfer_ring.hpp"

namespace path_tracer {

/// What every stage works with.
struct StageContext {
  cn::Machine& machine;
  const Kernels& kernels;
  const ProgramConfig& config;
  const Layout& layout;
  TransferRing& loads;
  TransferRing& saves;
  Bins& bins;
  RunCounts& counts;
};

/// Reads triangles of either record, for kernels that take them as mono operands.
inline const TriangleRecord* read_triangles(cn::Machine& machine, const Layout& layout, std::int32_t first,
                                            std::int32_t count) {
  const auto of_array = [&](auto triangles) {
    return machine.read_mono(triangles + static_cast<std::uint64_t>(first), static_cast<std::size_t>(count));
  };
  if (!layout.layers.any) return of_array(layout.triangles);
  return &of_array(cn::MonoPointer<LayeredTriangleRecord>{layout.triangles.address})->triangle;
}

/// How the scene's lights are chosen.
inline LightTable read_light_table(cn::Machine& machine, const Layout& layout) {
  LightTable table;
  const bool has_classes = layout.light_class_count > 0;
  table.count = has_classes ? layout.light_class_count : layout.light_count;
  table.cdf = machine.read_mono(layout.light_cdf, std::size_t(table.count));
  if (has_classes) table.classes = machine.read_mono(layout.light_classes, std::size_t(table.count));
  return table;
}

/// One kind of step: loads a block, processes it and saves it. The pipeline (step_pipeline.hpp) decides when.
class Stage {
 public:
  explicit Stage(const StageContext& context) : context_(context) {}
  virtual ~Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Labels the stage's kernels and requests for observers.
  virtual const char* name() const = 0;
  /// Whether the stage's blocks are blocks of slots in the bins. Otherwise the stage numbers blocks of its
  /// own.
  virtual bool works_on_slots() const { return true; }
  virtual void load(std::uint64_t step, int block) = 0;
  /// Whether the stage has a second load phase.
  virtual bool prepares() const { return false; }
  /// Whether the first loads of such a stage go to buffers of its own, so that they may begin before there is
  /// room in the ring for the second ones.
  virtual bool loads_early() const { return prepares(); }
  /// Second load phase, issued when the addresses from the first have arrived.
  virtual void prepare(std::uint64_t /*step*/, int /*block*/) {}
  virtual void process(std::uint64_t step, int block) = 0;
  virtual void save(std::uint64_t step, int block) = 0;

 protected:
  int num_pes() const { return context_.machine.num_pes(); }
  std::uint64_t first_slot(int block) const { return std::uint64_t(block) * std::uint64_t(num_pes()); }

  /// @param record_bytes of a record, with its tail (records/tails.hpp)
  template <class Record>
  cn::MonoPlaces block_of(cn::MonoPointer<Record> bin, int block, int record_bytes = sizeof(Record)) const {
    const auto bytes = std::uint64_t(record_bytes);
    return cn::MonoPlaces::array(bin.address + first_slot(block) * bytes, bytes);
  }

  template <class Record>
  void load_block(std::uint64_t step, int block, PolyPointer<Record> to, cn::MonoPointer<Record> bin,
                  const LaneMask& enabled, int record_bytes = sizeof(Record)) {
    context_.loads.copy_m2p(step, block, with_tail(to, record_bytes), block_of(bin, block, record_bytes),
                            enabled);
  }
  template <class Record>
  void save_block(std::uint64_t step, int block, cn::MonoPointer<Record> bin, PolyPointer<Record> from,
                  const LaneMask& enabled, int record_bytes = sizeof(Record)) {
    context_.saves.copy_p2m(step, block, block_of(bin, block, record_bytes), with_tail(from, record_bytes),
                            enabled);
  }
  template <class Record>
  static cn::PolySpan with_tail(PolyPointer<Record> record, int record_bytes) {
    return {record.span().offset_bytes, record_bytes};
  }

  Bins::Block& bin_block(int block) const { return context_.bins.blocks[std::size_t(block)]; }

  StageContext context_;
};

}  // namespace path_tracer
