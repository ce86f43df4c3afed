#pragma once

#include <deque>
#include <optional>

#include "firmware/path_tracer/stage.hpp"

/// The circular buffer within the intersection step that the paper's section 5 sketches: rays wait in a
/// temporary bin, each with the leaf that it is to be tested against and the piece of the tree that it needs to
/// find the next one.
namespace path_tracer {

/// The temporary bin. Where the paper swaps two bins, this is one ring: rays that go on are saved behind the
/// others, packed. A block that is only partly full waits for more instead of being processed with idle PEs,
/// until nothing else is left.
class TraversalBin {
 public:
  TraversalBin(const Layout& layout, const ProgramConfig& config, int num_pes);

  /// The next full block of the ring, if there is one.
  std::optional<int> take_full();
  /// What is left, as a block.
  std::optional<int> take_rest();

  int rays(int block) const { return block_[std::size_t(block)].rays; }
  /// How often the rays of the block have been through the bin, 1 for the first time.
  std::size_t pass(int block) const { return block_[std::size_t(block)].pass; }

  /// Rays that `step` appends; they were in `pass` before, 0 for the ray bin.
  void append(int rays, std::uint64_t step, std::size_t pass);

  cn::MonoAddress address() const { return first_; }
  cn::MonoAddress address_of(int block) const {
    return first_ + std::uint64_t(block) * std::uint64_t(num_pes_) * std::uint64_t(record_bytes_);
  }
  int record_bytes() const { return record_bytes_; }
  int capacity() const { return blocks_ * num_pes_; }
  std::int32_t tail() const { return static_cast<std::int32_t>(tail_ % std::uint64_t(capacity())); }
  /// The last step that saved to the block.
  std::uint64_t last_writer(int block) const { return block_[std::size_t(block)].last_writer; }

 private:
  struct Block {
    int rays = 0;  ///< when it was taken
    std::size_t pass = 0;
    std::uint64_t last_writer = 0;
  };
  int take(int rays);

  cn::MonoAddress first_;
  int record_bytes_;
  int num_pes_;
  int blocks_;
  // Rays are numbered on and on; these lie at their number modulo the capacity.
  std::uint64_t head_ = 0;  ///< a multiple of num_pes
  std::uint64_t tail_ = 0;
  struct PassStart {
    std::uint64_t ray;
    std::size_t pass;
  };
  std::deque<PassStart> passes_;  ///< that the rays in the ring are in
  std::vector<Block> block_;
};

/// What the two stages below share: the rays in SRAM and the way they leave it.
class TraversalContext {
 public:
  TraversalContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout);

  /// To every PE, before the first step.
  void load_resident_nodes();

  TransferRing records;  ///< a buffer stays a step's from its load to the end of its save
  TraversalBin bin;
  TreeInSram tree;
  double reach;
  std::uint64_t last_step = 0;  ///< of all that saved hits
  // Of the rays that are in the ray bin:
  std::uint64_t begun = 0;
  std::uint64_t finished = 0;

  static int record_buffers(const ProgramConfig& config);

 private:
  cn::Machine& machine_;
  const Layout& layout_;
};

class TraversalStage : public Stage {
 public:
  TraversalStage(const StageContext& context, TraversalContext& traversal);
  static constexpr int kSaveBytes = sizeof(HitRecord) + 3 * sizeof(MonoAddress);

  void save(std::uint64_t step, int block) override;

 protected:
  struct Hits {
    PolyPointer<HitRecord> hit;
    PolyField<MonoAddress> surface_place;
    PolyField<MonoAddress> hit_to;
    PolyField<MonoAddress> surface_place_to;
  };
  Hits hits(std::uint64_t step) const;
  PolyPointer<TraversalRecord> record(std::uint64_t step) const {
    return PolyPointer<TraversalRecord>(traversal_.records.buffer(step));
  }
  PolyField<MonoAddress> record_to(std::uint64_t step) const;
  const TraversalKernels& kernels() const { return kernels_; }
  std::size_t format() const { return static_cast<std::size_t>(traversal_.tree.shape.layout.format); }

  /// After a kernel that left `alive_`: numbers the rays that go on and makes the hits of the others.
  void sort_out(std::uint64_t step, const LaneMask& rays, std::size_t pass);
  void count(std::size_t pass, int rays);

  TraversalContext& traversal_;
  const TraversalKernels& kernels_;
  PolyField<std::int32_t> number_;
  LaneMask alive_;
  LaneMask finished_;
};

/// Ray bin: takes rays as far as the resident nodes go, into the traversal bin.
class BeginStage : public TraversalStage {
 public:
  using TraversalStage::TraversalStage;
  static constexpr int kLoadBytes = sizeof(RayRecord);

  const char* bin() const override { return "ray bin"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
};

/// Traversal bin: loads rays, then what they need, tests leaves, goes on through the tree. Its blocks are the
/// ring's.
class TraverseStage : public TraversalStage {
 public:
  TraverseStage(const StageContext& context, TraversalContext& traversal);
  static int load_bytes(const TreeShape& shape);

  const char* bin() const override { return "traversal bin"; }
  bool works_on_slots() const override { return false; }
  bool prepares() const override { return true; }

  void load(std::uint64_t step, int block) override;
  void prepare(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;

 private:
  struct Loads {
    PolyField<MonoAddress> leaf_place;
    PolyField<MonoAddress> treelet_place;
    PolyField<std::int32_t> treelet;
    PolyPointer<TriangleRecord> leaf;
    int treelet_offset;
  };
  /// Of a step, from its load to its end.
  struct State {
    LaneMask rays;
    LaneMask needs_leaf;
    LaneMask needs_treelet;
    int leaves = 0;
  };
  Loads loads(std::uint64_t step) const;
  State& state(std::uint64_t step) { return states_[step % states_.size()]; }

  std::vector<State> states_;
};

/// Between traversal bin and intersection bin: brings each slot what became of its ray.
class RecallStage : public Stage {
 public:
  RecallStage(const StageContext& context, TraversalContext& traversal)
      : Stage(context), traversal_(traversal) {}

  const char* bin() const override { return "intersection bin"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t, int) override {}

 private:
  TraversalContext& traversal_;
};

/// All of it, for programs that use a tree.
class TreeTraversal {
 public:
  explicit TreeTraversal(const StageContext& context)
      : context_(context.machine, context.config, context.layout),
        begin_(context, context_),
        traverse_(context, context_),
        recall_(context, context_) {}

  void load_resident_nodes() { context_.load_resident_nodes(); }
  void begin_pass();

  TraversalBin& bin() { return context_.bin; }
  BeginStage& begin() { return begin_; }
  TraverseStage& traverse() { return traverse_; }
  RecallStage& recall() { return recall_; }

 private:
  TraversalContext context_;
  BeginStage begin_;
  TraverseStage traverse_;
  RecallStage recall_;
};

}  // namespace path_tracer
