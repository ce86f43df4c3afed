#pragma once

#include <vector>

#include "firmware/path_tracer/stages/stage.hpp"

namespace path_tracer {

/// Of stream execution: ascending numbers by a scan over mono memory, in place of the PE-to-PE path (Horn,
/// "Stream Reduction Operations for GPGPU Applications", GPU Gems 2, 2005; Sengupta, Harris, Zhang, Owens,
/// "Scan Primitives for GPU Computing", Graphics Hardware 2007). Each PE sums kScanRadix words, level by
/// level, and then hands the sums down. A level reads what the level before it has written, so levels do not
/// overlap; the blocks of a level do.
class ScanStage : public Stage {
 public:
  explicit ScanStage(const StageContext& context) : Stage(context), levels_(context.machine.num_pes()) {}
  static constexpr int kWordsBytes = kScanRadix * int{sizeof(std::uint64_t)};
  static constexpr int kLoadBytes = kWordsBytes + int{sizeof(std::uint64_t)};
  static constexpr int kSaveBytes = kWordsBytes;

  const char* name() const override { return "scan"; }
  bool works_on_slots() const override { return false; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int block) override;

  /// Begins a scan over the numbers of so many blocks.
  void begin(int blocks) { levels_ = ScanLevels(std::int32_t(blocks) * num_pes()); }
  /// Levels up, then down, from 0 on.
  int sweeps() const { return 2 * levels_.top(); }
  /// Begins a sweep, whose blocks are numbered from 0 on. Returns how many there are.
  int begin_sweep(int sweep);
  /// The sum of all words, when the last sweep up has been saved.
  PathNumbers total();

 private:
  bool is_up() const { return sweep_ < levels_.top(); }
  int level() const { return is_up() ? sweep_ : sweeps() - 1 - sweep_; }
  int first_group(int block) const { return block * num_pes(); }
  LaneMask groups(int block) const;
  cn::MonoPlaces words(int block) const;
  cn::MonoPlaces sums(int block) const;
  /// The word of a level in mono memory.
  cn::MonoAddress word(int level, std::uint64_t number) const;
  bool starts_at_zero() const { return level() == levels_.top() - 1; }

  ScanLevels levels_;
  int sweep_ = 0;
};

}  // namespace path_tracer
