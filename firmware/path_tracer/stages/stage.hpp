#pragma once

#include <vector>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/stages/transfer_ring.hpp"

namespace path_tracer {

/// What is known of the bins outside mono memory: conditions that PEs hold for each block and the addresses
/// kept in poly memory from one bin to the next (paper, section 3.3: "a small piece of data is kept in poly
/// memory").
struct Bins {
  struct Block {
    LaneMask live;  ///< slots that hold a path
    LaneMask hit_something;
    LaneMask shadow;  ///< slots whose ray is a shadow ray
    LaneMask casts;   ///< slots whose next ray is one
    PolyField<MonoAddress> surface_place;
    PolyField<MonoAddress> light_place;

    LaneMask segments() const { return live.without(shadow); }  ///< slots whose ray is a segment
    LaneMask ready() const { return live.without(casts); }      ///< slots whose vertex is complete
  };
  std::vector<Block> blocks;
};

class RayQueue;

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
  RayQueue* queue;  ///< nothing without a tree
};

/// Cuts records off a ring buffer, in order.
class BufferCutter {
 public:
  explicit BufferCutter(cn::PolySpan buffer) : offset_bytes_(buffer.offset_bytes) {}

  template <class Record>
  PolyPointer<Record> take(int count = 1) {
    const PolyPointer<Record> start(offset_bytes_);
    offset_bytes_ += count * PolyPointer<Record>::size_bytes();
    return start;
  }
  template <class T>
  PolyField<T> take_field() {
    const PolyField<T> field{offset_bytes_};
    offset_bytes_ += static_cast<int>(sizeof(T));
    return field;
  }
  PolyField<MonoAddress> take_place() { return take_field<MonoAddress>(); }

 private:
  int offset_bytes_;
};

/// One bin's work on one block: load, process, save. The pipeline (path_tracer.hpp) decides when.
class Stage {
 public:
  explicit Stage(const StageContext& context) : context_(context) {}
  virtual ~Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Its name, for observers.
  virtual const char* bin() const = 0;
  /// Whether its blocks are slots of the bins; otherwise they are its own.
  virtual bool works_on_slots() const { return true; }
  virtual void load(std::uint64_t step, int block) = 0;
  /// Of stages whose loads tell what else is to be loaded: when those have come, loads that, too.
  virtual bool prepares() const { return false; }
  virtual void prepare(std::uint64_t /*step*/, int /*block*/) {}
  virtual void process(std::uint64_t step, int block) = 0;
  virtual void save(std::uint64_t step, int block) = 0;

 protected:
  int num_pes() const { return context_.machine.num_pes(); }
  std::uint64_t first_slot(int block) const { return std::uint64_t(block) * std::uint64_t(num_pes()); }

  template <class Record>
  cn::MonoPlaces block_of(cn::MonoPointer<Record> bin, int block) const {
    return cn::MonoPlaces::array((bin + first_slot(block)).address, sizeof(Record));
  }

  template <class Record>
  void load_block(std::uint64_t step, int block, PolyPointer<Record> to, cn::MonoPointer<Record> bin,
                  const LaneMask& enabled) {
    context_.loads.copy_m2p(step, block, to.span(), block_of(bin, block), enabled);
  }
  template <class Record>
  void save_block(std::uint64_t step, int block, cn::MonoPointer<Record> bin, PolyPointer<Record> from,
                  const LaneMask& enabled) {
    context_.saves.copy_p2m(step, block, block_of(bin, block), from.span(), enabled);
  }

  /// A ray at the end of a save buffer, with room for what save_rays() adds.
  PolyPointer<QueuedRay> take_ray(BufferCutter& cutter) const;
  static int ray_bytes(const ProgramConfig& config);
  /// Into the ray bin; into the lanes' slots, or packed with a tree.
  void save_rays(std::uint64_t step, int block, PolyPointer<QueuedRay> from, const LaneMask& with_ray);

  Bins::Block& bin_block(int block) const { return context_.bins.blocks[std::size_t(block)]; }

  StageContext context_;
};

}  // namespace path_tracer
