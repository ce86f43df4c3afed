#pragma once

#include <array>

#include "firmware/cn/language/kernel.hpp"
#include "firmware/path_tracer/records/records.hpp"
#include "firmware/path_tracer/records/slot_state.hpp"

/// The poly programs that stream execution (Execution::stream) has in addition.
namespace path_tracer {

/// Before a kernel: the conditions of slots.
struct RecallSlotsArguments {
  cn::PolyPointer<SlotState> state;
  std::array<cn::LaneMask*, kSlotConditions> conditions{};
};

/// After a kernel: the same conditions as a record.
struct KeepSlotsArguments {
  cn::PolyPointer<SlotState> state;
  std::array<const cn::LaneMask*, kSlotConditions> conditions{};
};

/// The input of the scan.
struct CountPathsArguments {
  const cn::LaneMask* ended = nullptr;
  const cn::LaneMask* finished = nullptr;
  cn::PolyPointer<PathNumbers> numbers;
};

/// Each PE's number in its block, as the first camera rays take it.
struct NumberPesArguments {
  cn::PolyField<std::int32_t> number;
};

/// After the scan: packs the list of finished paths.
struct PackFinishedArguments {
  cn::PolyPointer<PathNumbers> numbers;
  cn::PolyPointer<FinishedRecord> entry;
  cn::PolyPointer<FinishedRecord> packed;
  cn::PolyField<cn::MonoAddress> place;  ///< of `packed`
  cn::MonoAddress list = 0;
};

/// One level of the scan: each PE has kScanRadix words that lie side by side.
struct ScanArguments {
  cn::PolyField<std::uint64_t> words{};  ///< the first of kScanRadix
  int first_group = 0;                   ///< the first PE's words, in kScanRadix
  std::int32_t words_here = 0;           ///< of the level; those beyond count as 0
  cn::PolyField<std::uint64_t> sum{};    ///< up: of the words; down: of all words before them
  bool starts_at_zero = false;           ///< down: there is none before them
  cn::PolyField<std::uint64_t>
      sums_before{};  ///< down, the first of kScanRadix: for each word, of all before
};

struct StreamKernels {
  cn::Kernel<RecallSlotsArguments> recall_slots;
  cn::Kernel<KeepSlotsArguments> keep_slots;
  cn::Kernel<CountPathsArguments> count_paths;
  cn::Kernel<NumberPesArguments> number_pes;
  cn::Kernel<PackFinishedArguments> pack_finished;
  cn::Kernel<ScanArguments> scan_up;    ///< writes `sum`
  cn::Kernel<ScanArguments> scan_down;  ///< writes `sums_before`
};

}  // namespace path_tracer
