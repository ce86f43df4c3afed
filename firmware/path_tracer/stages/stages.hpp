#pragma once

#include <array>

#include "firmware/path_tracer/stages/stage.hpp"

/// The bins of the circular buffer (paper, figure 1). Shadow rays go round it like segments: a slot
/// alternates between the two, and every block is full of whichever.
namespace path_tracer {

/// Ray bin: intersects each ray with the scene, a segment or a shadow ray alike.
class RayStage : public Stage {
 public:
  using Stage::Stage;
  static constexpr int kLoadBytes = sizeof(RayRecord);
  static constexpr int kSaveBytes = sizeof(HitRecord);

  const char* bin() const override { return "ray bin"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

 private:
  TriangleSieve sieve_;  ///< made when the triangles are read first
};

/// Intersection bin. A segment gets its shading details, roulette, new direction and shadow ray; a shadow ray
/// gets its light. A PE holds one or the other, so their records share SRAM.
class IntersectionStage : public Stage {
 public:
  using Stage::Stage;
  static int load_bytes(Program program);
  static int save_bytes(const ProgramConfig& config);

  const char* bin() const override { return "intersection bin"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

 private:
  struct Loads {
    PolyPointer<HitRecord> hit;
    PolyPointer<SurfaceRecord> surface;
    PolyPointer<PathRecord> path;  // segments
    PolyPointer<LightRecord> light;
    PolyPointer<LightingRecord> lighting;  // shadow rays
  };
  struct Saves {
    PolyPointer<ScatterRecord> scatter;  // segments
    PolyPointer<LightingRecord> lighting;
    PolyPointer<QueuedRay> shadow_ray;
    PolyPointer<DirectLightRecord> direct_light;  // shadow rays
  };
  Loads loads(std::uint64_t step) const;
  Saves saves(std::uint64_t step) const;
  void scatter(const Loads& from, const Saves& to, int block);
  void illuminate(const Loads& from, const Saves& to, int block);
};

/// The camera rays still to be issued, in the order sample by sample, pixel by pixel.
class CameraRays {
 public:
  CameraRays(const Work& work, int pixels);

  std::int32_t next_pixel() const { return static_cast<std::int32_t>(next_ % std::uint64_t(pixels_)); }
  std::int32_t next_sample() const {
    return first_sample_ + static_cast<std::int32_t>(next_ / std::uint64_t(pixels_));
  }
  std::uint64_t remaining() const { return total_ - next_; }
  int pixels() const { return pixels_; }
  void issue(std::uint64_t count) { next_ += count; }
  std::uint64_t issued() const { return next_; }

 private:
  std::uint64_t next_ = 0;
  std::uint64_t total_;
  std::int32_t first_sample_;
  int pixels_;
};

/// Path bin: appends the vertex and puts the next camera ray in the place of a path that ended. Lists the
/// paths that wait for their radiance, packed by ascending numbers. Slots whose shadow ray is still to be
/// cast wait for it where they are.
class PathStage : public Stage {
 public:
  PathStage(const StageContext& context, const Work& work);
  static constexpr int kLoadBytes = sizeof(PathRecord) + sizeof(ScatterRecord) + sizeof(DirectLightRecord);
  static int save_bytes(const ProgramConfig& config) {
    return sizeof(VertexRecord) + sizeof(PathRecord) + sizeof(FinishedRecord) + 2 * sizeof(MonoAddress) +
           ray_bytes(config);
  }

  const char* bin() const override { return "path bin"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

  /// Fills an empty block with camera rays; takes the place of load and process.
  void fill(std::uint64_t step, int block);

  /// Paths listed since the last clear_finished().
  int finished_count() const { return finished_count_; }
  void clear_finished() { finished_count_ = 0; }

  const CameraRays& camera_rays() const { return camera_rays_; }

 private:
  struct Loads {
    PolyPointer<PathRecord> path;
    PolyPointer<ScatterRecord> scatter;
    PolyPointer<DirectLightRecord> direct_light;
  };
  struct Saves {
    PolyPointer<VertexRecord> vertex;
    PolyPointer<PathRecord> path;
    PolyPointer<FinishedRecord> finished;
    PolyField<MonoAddress> vertex_place;
    PolyField<MonoAddress> finished_place;
    PolyPointer<QueuedRay> ray;
  };
  Loads loads(std::uint64_t step) const;
  Saves saves(std::uint64_t step) const;
  void append_vertices(std::uint64_t step, int block);
  void list_finished(std::uint64_t step);
  void replace_ended(std::uint64_t step, int block, int ended_count);
  void count_segments(int block);

  CameraRays camera_rays_;
  PolyField<std::int32_t> number_;
  // Of the block in hand, from process to save.
  LaneMask appended_;
  LaneMask ended_;
  LaneMask finished_;
  LaneMask replaced_;  ///< slots with a new ray
  int finished_count_ = 0;
  std::vector<std::uint32_t> segments_;  ///< by slot, of the path that holds it: for RunCounts only
};

/// Radiance of the paths that the path stage listed, vertex by vertex from the last to the first (paper,
/// section 3.1: "the normal path tracing recursive algorithm"). Its blocks are blocks of the list; each takes
/// one list step and then as many fold steps as its longest path needs. What is known of a block takes SRAM,
/// so only kBlocksUnderWay of them are under way at a time; few passes end more paths.
class RadianceStage {
 public:
  explicit RadianceStage(const StageContext& context);
  static constexpr int kBlocksUnderWay = 4;
  static constexpr int kLoadBytes = sizeof(FoldRecord) + kVerticesPerLoad * sizeof(VertexRecord);
  static constexpr int kSaveBytes = sizeof(RadianceRecord) + sizeof(FoldRecord);

  /// What is known of a block of the list after its list step.
  struct ListBlock {
    int entries = 0;
    FinishedPath path;
    std::vector<LaneMask> needs_load;
    LaneMask folded;
    LaneMask flushed;
    bool any_partial = false;  ///< paths of which some vertices are elsewhere
    int loads = 0;
  };

  /// Taken in turn by the blocks of the list.
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
    const char* bin() const override { return "finished paths"; }
    void load(std::uint64_t step, int block) override;
    void process(std::uint64_t step, int block) override;
    void save(std::uint64_t, int) override {}

   private:
    ListBlocks& blocks_;
  };

  /// Its "block" is list block * loads_per_path + load.
  class FoldStage : public Stage {
   public:
    FoldStage(const StageContext& context, ListBlocks& blocks);
    const char* bin() const override { return "radiance"; }
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

  /// Starts on block `block` of the list, which has that many entries.
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
