#include "model/waves/wave_probe.hpp"

#include <algorithm>

#include "model/network/clear_connect_timing.hpp"

namespace model {
namespace {

/// How late a unit may report: approximately timed, read data are reported when the memory answers, up to a
/// burst after their first byte.
constexpr Cycles kLatestReport = 2000;

bool is_load(const PioEvent& event) {
  return event.direction == cn::Direction::mono_to_poly;
}

/// A change for Rule::set_or_clear: bit 0 of a PE's part is loading, bit 1 saving.
std::uint64_t part(const PioEvent& event, bool begins) {
  return (is_load(event) ? 0u : 2u) + (begins ? 1u : 0u);
}

WaveSignal next(WaveSignal signal) {
  return static_cast<WaveSignal>(int(signal) + 1);
}

}  // namespace

WaveProbe::WaveProbe(const sc_core::sc_module_name& name, const WaveConfig& config, const ChipConfig& chip,
                     TextSink sink, MemorySampler memory)
    : sc_module(name),
      chip_(chip),
      clock_(chip.chip.clock_hz),
      memory_(std::move(memory)),
      signals_((check_waves(config, chip), ShownSignals(chip, config.selection))),
      recorder_(std::move(sink), signals_.to_record(config.chip), clock_,
                // Banks have a stream each, which costs time at every cycle.
                std::size_t(first_bank_stream) +
                    (signals_.any_of_banks() ? std::size_t(chip.ddr.banks) : std::size_t(0))),
      shows_counters_(signals_.any_of_memory_counters()),
      shows_pes_(signals_.any_of_pes()),
      windows_text_(text_of_windows(config)),
      blocks_(config.blocks, recorder_) {
  for (const CycleWindow& window : config.windows) recorder_.add_window(window);
  if (config.windows.empty() && config.blocks.empty()) recorder_.add_window({});
  SC_HAS_PROCESS(WaveProbe);
  SC_METHOD(advance);
  sensitive << wake_;
  dont_initialize();
}

void WaveProbe::began(CycleCause cause, Cycles start, int semaphore) {
  change(control_stream, start, WaveSignal::control_state, std::uint64_t(cause) + 1);
  change(control_stream, start, WaveSignal::control_semaphore,
         semaphore < 0 ? kNoSemaphore : std::uint64_t(semaphore));
  span_.emplace(start, cause);
}

void WaveProbe::spent(CycleCause cause, Cycles start, Cycles finish, int semaphore) {
  if (span_ != std::pair(start, cause)) began(cause, start, semaphore);
  control_finish_ = finish;  // the next span follows at once
  if (cause == CycleCause::data_cache) change_memory_counters(finish);
  wake_for(finish);
}

/// Shows the control unit idle: no span follows the latest one yet, or ever.
void WaveProbe::end_control() {
  change(control_stream, control_finish_, WaveSignal::control_state, 0);
  change(control_stream, control_finish_, WaveSignal::control_semaphore, kNoSemaphore);
  control_finish_ = std::numeric_limits<Cycles>::max();  // until another span is reported
}

void WaveProbe::kernel_details(const KernelDetails& details) {
  details_ = details;
}

void WaveProbe::began_kernel(const char* name, Cycles start, int enabled_pes) {
  const cn::Label& label = details_.label;
  if (label.stage != computed_label_.stage || label.block != computed_label_.block) {
    computed_label_ = label;
    if (label.stage != nullptr) blocks_.begin_block(start);
    change_label(control_stream, start, WaveSignal::bins_compute_stage, label);
  }
  change(control_stream, start, WaveSignal::control_kernel, kernels_(name));
  change(control_stream, start, WaveSignal::pe_array_busy, 1);
  change(control_stream, start, WaveSignal::pe_array_enabled_pes, std::uint64_t(enabled_pes));
  if (details_.issued != nullptr && shows(WaveSignal::pe_array_instruction_class))
    change(control_stream, start, WaveSignal::pe_array_instruction_class, main_class(*details_.issued));
  change_lanes(control_stream, start, WaveSignal::pe_enabled, details_.lanes, 1);
  kernel_start_ = start;
}

void WaveProbe::ran_kernel(const char* name, Cycles start, Cycles finish, int enabled_pes) {
  if (kernel_start_ != start) began_kernel(name, start, enabled_pes);
  change(control_stream, finish, WaveSignal::control_kernel, 0);
  change(control_stream, finish, WaveSignal::pe_array_busy, 0);
  change(control_stream, finish, WaveSignal::pe_array_enabled_pes, 0);
  change(control_stream, finish, WaveSignal::pe_array_instruction_class, 0);
  change_lanes(control_stream, finish, WaveSignal::pe_enabled, nullptr, 0);
  details_.issued = nullptr;  // only valid during that call
  details_.lanes = nullptr;
}

std::uint64_t WaveProbe::main_class(const cn::IssueTree& issued) const {
  cn::IssueCounts counts;
  issued.for_each_node([&](const cn::IssueTree::Node& node) { counts += node.counts; });
  std::size_t most = 0;
  const auto cycles = [&](std::size_t i) { return double(counts.by_class[i]) * chip_.poly.cycles[i]; };
  for (std::size_t i = 1; i < cn::kInstructionClasses; ++i)
    if (cycles(i) > cycles(most)) most = i;
  return most + 1;
}

void WaveProbe::thread_changed(int thread, ThreadState state, Cycles at) {
  change(control_stream, at, WaveSignal::control_thread, std::uint64_t(state), thread);
}

void WaveProbe::filled(int block, int slots, Cycles at) {
  if (fill_by_block_.size() <= std::size_t(block)) fill_by_block_.resize(std::size_t(block) + 1);
  int& before = fill_by_block_[std::size_t(block)];
  fill_ += std::uint64_t(slots - before);
  before = slots;
  change(control_stream, at, WaveSignal::bins_fill, fill_);
}

void WaveProbe::started(const PioEvent& event) {
  const bool load = is_load(event);
  const Stream stream = load ? load_stream : save_stream;
  const Cycles at = event.started;
  change(stream, at, load ? WaveSignal::pio_loading : WaveSignal::pio_saving, 1);
  change(stream, at, load ? WaveSignal::pio_load_request : WaveSignal::pio_save_request,
         event.id & kNoRequest);
  change(stream, at, load ? WaveSignal::pio_load_bytes : WaveSignal::pio_save_bytes, event.bytes);
  change_label(stream, at, load ? WaveSignal::bins_load_stage : WaveSignal::bins_save_stage, event.label);
  change(counts_stream, at, WaveSignal::pio_queue_depth, std::uint64_t(event.queue_depth));
  change_lanes(stream, at, WaveSignal::pe_transfer, event.enabled, part(event, true));
  wake_for(at);
}

void WaveProbe::finished(const PioEvent& event) {
  const bool load = is_load(event);
  const Stream stream = load ? load_stream : save_stream;
  change(stream, event.finished, load ? WaveSignal::pio_loading : WaveSignal::pio_saving, 0);
  change_lanes(stream, event.finished, WaveSignal::pe_transfer, event.enabled, part(event, false));
  change_memory_counters(event.finished);
  wake_for(event.finished);
}

void WaveProbe::accessed(bool write, Cycles start, Cycles finish) {
  change(bus_stream, start, WaveSignal::ddr_bus, write ? 2 : 1);
  change(bus_stream, finish, WaveSignal::ddr_bus, 0);
}

void WaveProbe::sram_accessed(bool write, Cycles start, Cycles finish) {
  change(sram_stream, start, WaveSignal::on_chip_sram_port, write ? 2 : 1);
  change(sram_stream, finish, WaveSignal::on_chip_sram_port, 0);
}

void WaveProbe::searching(int in_flight, int waiting, Cycles at) {
  change(search_stream, at, WaveSignal::search_unit_queries, std::uint64_t(in_flight));
  change(search_stream, at, WaveSignal::search_unit_waiting, std::uint64_t(waiting));
  wake_for(at);
}

void WaveProbe::moved_data(bool write, Cycles start, Cycles finish) {
  change(data_stream, start, WaveSignal::ddr_data, write ? 2 : 1);
  change(data_stream, finish, WaveSignal::ddr_data, 0);
}

void WaveProbe::commanded(int bank, DdrCommand command, std::uint64_t row, Cycles at) {
  const int first = bank < 0 ? 0 : bank;
  const int last = bank < 0 ? chip_.ddr.banks : bank + 1;
  for (int i = first; i < last; ++i) {
    const std::size_t stream = std::size_t(first_bank_stream) + std::size_t(i);
    change(stream, at, WaveSignal::ddr_bank_command, std::uint64_t(command) + 1, i);
    if (command == DdrCommand::activate) change(stream, at, WaveSignal::ddr_bank_row, row, i);
  }
}

void WaveProbe::passed(Initiator initiator, bool to_ddr, Cycles start, Cycles finish) {
  const Stream stream = to_ddr ? to_ddr_stream : from_ddr_stream;
  const WaveSignal signal = to_ddr ? WaveSignal::clear_connect_to_ddr : WaveSignal::clear_connect_from_ddr;
  change(stream, start, signal, std::min(std::size_t(initiator), kInitiators) + 1);  // others are one
  change(stream, finish, signal, 0);
}

void WaveProbe::began_transfer(bool upload, std::uint64_t, Cycles start) {
  change(host_stream, start, WaveSignal::host_link_state, upload ? 1 : 2);
  wake_for(start);
}

void WaveProbe::ended_transfer(bool, std::uint64_t, Cycles, Cycles finish) {
  change(host_stream, finish, WaveSignal::host_link_state, 0);
  wake_for(finish);
}

void WaveProbe::finish() {
  const Cycles end = clock_.cycle_at(sc_core::sc_time_stamp());
  if (control_finish_ <= end) end_control();
  recorder_.finish(end);
  if (recorder_.last_recorded() > recorder_.first_recorded()) return;
  throw WaveError("waves: found nothing that ran in the windows (" + windows_text_ +
                  "); allowed: windows within the run, which ended at cycle " + std::to_string(end) +
                  " after " + std::to_string(blocks_.blocks_begun()) + " blocks");
}

void WaveProbe::change_memory_counters(Cycles cycle) {
  if (!shows_counters_) return;
  const MemoryCounters counters = memory_();
  change(counts_stream, cycle, WaveSignal::ddr_page_hits, counters.page_hits);
  change(counts_stream, cycle, WaveSignal::ddr_page_misses, counters.page_misses);
  change(counts_stream, cycle, WaveSignal::ddr_bytes_read, counters.bytes_read);
  change(counts_stream, cycle, WaveSignal::ddr_bytes_written, counters.bytes_written);
  change(counts_stream, cycle, WaveSignal::clear_connect_pio_bytes, counters.pio_bytes);
}

void WaveProbe::change_label(std::size_t stream, Cycles cycle, WaveSignal stage, const cn::Label& label) {
  change(stream, cycle, stage, label.stage == nullptr ? 0 : bins_(label.stage));
  change(stream, cycle, next(stage), label.block < 0 ? kNoBlock : std::uint64_t(label.block));
}

void WaveProbe::change_lanes(std::size_t stream, Cycles cycle, WaveSignal signal, const cn::LaneMask* lanes,
                             std::uint64_t value) {
  if (!shows_pes_) return;
  for (int pe = 0; pe < chip_.chip.pes; ++pe)
    if (lanes == nullptr || (*lanes)[pe]) change(stream, cycle, signal, value, pe);
}

void WaveProbe::change(std::size_t stream, Cycles cycle, WaveSignal signal, std::uint64_t value, int index) {
  const std::size_t place = signals_.place(signal, index);
  if (place == ShownSignals::kNotShown || !recorder_.wants_more()) return;
  recorder_.change(stream, cycle, place, value);
}

/// The only process. Units report nothing earlier than now - kLatestReport any more, so what lies before is
/// written.
void WaveProbe::advance() {
  wake_pending_ = false;
  const Cycles now = clock_.cycle_at(sc_core::sc_time_stamp());
  const Cycles end = now - std::min(now, kLatestReport);
  const bool in_a_span = span_ && span_->first >= control_finish_;
  if (control_finish_ < end && !in_a_span) end_control();
  recorder_.advance_to(end);
  if (latest_reported_ > now) wake_for(latest_reported_);
}

/// Wakes up at a cycle that was reported: a timer of its own would keep a simulation running that is
/// otherwise at its end.
void WaveProbe::wake_for(Cycles reported) {
  latest_reported_ = std::max(latest_reported_, reported);
  if (wake_pending_ || !recorder_.wants_more()) return;
  const sc_core::sc_time time = clock_.time_at(latest_reported_);
  const sc_core::sc_time& now = sc_core::sc_time_stamp();
  if (time <= now) return;
  wake_pending_ = true;
  wake_.notify(time - now);
}

}  // namespace model
