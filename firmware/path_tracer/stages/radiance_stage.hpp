#pragma once

#include <array>
#include <vector>

#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// Radiance of the paths that the path stage listed, vertex by vertex from the last to the first (paper,
/// section 3.1: "the normal path tracing recursive algorithm"). Its blocks are blocks of the list. Each takes
/// one list step and then as many fold steps as its longest path needs. A block's state takes SRAM, so only
/// kBlocksUnderWay blocks are under way at a time; few passes end more paths.
class RadianceStage {
 public:
  explicit RadianceStage(const StageContext& context);
  static constexpr int kBlocksUnderWay = 4;
  static constexpr int kLoadBytes = sizeof(FoldRecord) + kVerticesPerLoad * sizeof(VertexRecord);
  static constexpr int kSaveBytes = sizeof(RadianceRecord) + sizeof(FoldRecord);

  /// State of a block of the list after its list step.
  struct ListBlock {
    int entries = 0;
    FinishedPath path;
    std::vector<LaneMask> needs_load;
    LaneMask folded;
    LaneMask flushed;
    bool any_partial = false;  ///< whether some paths have vertices elsewhere
    int loads = 0;
  };

  /// States that the blocks of the list use in turn.
  class ListBlocks {
   public:
    ListBlock& operator[](int block) { return blocks_[std::size_t(block % kBlocksUnderWay)]; }
    auto begin() { return blocks_.begin(); }
    auto end() { return blocks_.end(); }

   private:
    std::array<ListBlock, kBlocksUnderWay> blocks_;
  };

  class ListStage : public Stage {
   public:
    ListStage(const StageContext& context, ListBlocks& blocks) : Stage(context), blocks_(blocks) {}
    const char* name() const override { return "list stage"; }
    bool works_on_slots() const override { return false; }
    void load(std::uint64_t step, int block) override;
    void process(std::uint64_t step, int block) override;
    void save(std::uint64_t, int) override {}

   private:
    ListBlocks& blocks_;
  };

  /// Fold stage. Its block number is list block * loads_per_path + load.
  class FoldStage : public Stage {
   public:
    FoldStage(const StageContext& context, ListBlocks& blocks);
    const char* name() const override { return "fold stage"; }
    bool works_on_slots() const override { return false; }
    void load(std::uint64_t step, int block) override;
    void process(std::uint64_t step, int block) override;
    void save(std::uint64_t step, int block) override;

    void set_results(cn::MonoPointer<RadianceRecord> results) { results_ = results; }
    bool is_last(int block) const { return load_of(block) == 0; }

   private:
    struct Loads {
      PolyPointer<FoldRecord> earlier;
      PolyPointer<VertexRecord> vertices;
    };
    struct Saves {
      PolyPointer<RadianceRecord> radiance;
      PolyPointer<FoldRecord> flushed;
    };
    Loads loads(std::uint64_t step) const;
    Saves saves(std::uint64_t step) const;
    bool is_first(int block) const { return load_of(block) + 1 == list_block(block).loads; }
    int load_of(int block) const { return block % loads_per_path_; }
    int list_index(int block) const { return block / loads_per_path_; }
    ListBlock& list_block(int block) const { return blocks_[list_index(block)]; }

    ListBlocks& blocks_;
    int loads_per_path_;
    cn::PolySpan sum_;
    cn::MonoPointer<RadianceRecord> results_;
  };

  ListStage& list() { return list_; }
  FoldStage& fold() { return fold_; }
  const ListStage& list() const { return list_; }
  const FoldStage& fold() const { return fold_; }

  /// Begins block `block` of the list, which has `entries` entries.
  void begin_block(int block, int entries) { blocks_[block].entries = entries; }
  int loads(int block) { return blocks_[block].loads; }
  int fold_block(int block, int load) const { return block * loads_per_path_ + load; }

 private:
  int loads_per_path_;
  ListBlocks blocks_;
  ListStage list_;
  FoldStage fold_;
};

}  // namespace path_tracer
