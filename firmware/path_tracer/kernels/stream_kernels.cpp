// Built once for each x86-64 level, whose name is the namespace of the table.

#include "firmware/path_tracer/kernels/stream_kernels.hpp"

#include "firmware/path_tracer/kernels/places.hpp"

namespace path_tracer {
namespace {

void recall_slots(const RecallSlotsArguments& arguments) {
  const poly<std::int32_t> conditions = arguments.state.get(&SlotState::conditions);
  for (std::size_t i = 0; i < kSlotConditions; ++i)
    cn::keep((conditions & poly<std::int32_t>(1 << i)) != 0, *arguments.conditions[i]);
}

void keep_slots(const KeepSlotsArguments& arguments) {
  poly<std::int32_t> conditions = 0;
  for (std::size_t i = 0; i < kSlotConditions; ++i)
    conditions = conditions + cn::select(cn::recall(*arguments.conditions[i]), poly<std::int32_t>(1 << i),
                                         poly<std::int32_t>(0));
  arguments.state.set(&SlotState::conditions, conditions);
}

void count_paths(const CountPathsArguments& arguments) {
  const auto one_if = [](const cn::LaneMask& lanes) {
    return cn::select(cn::recall(lanes), poly<std::int32_t>(1), poly<std::int32_t>(0));
  };
  arguments.numbers.set(&PathNumbers::ended, one_if(*arguments.ended));
  arguments.numbers.set(&PathNumbers::finished, one_if(*arguments.finished));
}

void number_pes(const NumberPesArguments& arguments) {
  arguments.number.write(cn::pe_num());
}

void pack_finished(const PackFinishedArguments& arguments) {
  for (std::int32_t FinishedRecord::*const member :
       {&FinishedRecord::slot, &FinishedRecord::vertices, &FinishedRecord::pixel, &FinishedRecord::sample,
        &FinishedRecord::folded, &FinishedRecord::ended})
    arguments.packed.set(member, arguments.entry.get(member));
  arguments.place.write(
      place_of(arguments.list, arguments.numbers.get(&PathNumbers::finished), sizeof(FinishedRecord)));
}

cn::PolyField<std::uint64_t> word_behind(cn::PolyField<std::uint64_t> first, int i) {
  return {first.offset_bytes + i * int{sizeof(std::uint64_t)}};
}

/// Returns a PE's word; 0 if it lies beyond the level's end.
poly<std::uint64_t> scanned_word(const ScanArguments& arguments, int i) {
  const poly<std::int32_t> number = (cn::pe_num() + arguments.first_group) * kScanRadix + i;
  return cn::select(number < poly<std::int32_t>(arguments.words_here), word_behind(arguments.words, i).read(),
                    poly<std::uint64_t>(0u));
}

void scan_up(const ScanArguments& arguments) {
  poly<std::uint64_t> sum = 0u;
  for (int i = 0; i < kScanRadix; ++i) sum = sum + scanned_word(arguments, i);
  arguments.sum.write(sum);
}

void scan_down(const ScanArguments& arguments) {
  poly<std::uint64_t> sum = 0u;
  if (!arguments.starts_at_zero) sum = arguments.sum.read();
  for (int i = 0; i < kScanRadix; ++i) {
    word_behind(arguments.sums_before, i).write(sum);
    sum = sum + scanned_word(arguments, i);
  }
}

}  // namespace

inline namespace CN_LEVEL {

const StreamKernels& stream_kernel_table() {
  static constexpr StreamKernels table{
      cn::kernel<RecallSlotsArguments, recall_slots>("recall_slots"),
      cn::kernel<KeepSlotsArguments, keep_slots>("keep_slots"),
      cn::kernel<CountPathsArguments, count_paths>("count_paths"),
      cn::kernel<NumberPesArguments, number_pes>("number_pes"),
      cn::kernel<PackFinishedArguments, pack_finished>("pack_finished"),
      cn::kernel<ScanArguments, scan_up>("scan_up"),
      cn::kernel<ScanArguments, scan_down>("scan_down"),
  };
  return table;
}

}  // namespace CN_LEVEL
}  // namespace path_tracer
