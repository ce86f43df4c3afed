#include "model/hazards/hazard_checker.hpp"

namespace model {
namespace {

using cn::Access;
using cn::Direction;

const char* verb(Access access) {
  return access == Access::write ? "writes" : "reads";
}

bool conflicts(Access a, Access b) {
  return a == Access::write || b == Access::write;
}

bool overlap(cn::PolySpan a, cn::PolySpan b) {
  return a.offset_bytes < b.offset_bytes + b.size_bytes && b.offset_bytes < a.offset_bytes + a.size_bytes;
}

std::string range_text(std::uint64_t first, std::uint64_t bytes) {
  return std::to_string(first) + ".." + std::to_string(first + bytes - 1);
}

}  // namespace

HazardChecker::HazardChecker(const cn::Machine& machine, Clock clock)
    : machine_(machine),
      clock_(std::move(clock)),
      occupancy_(machine.poly_memory()),
      signals_(std::size_t(cn::Machine::kSemaphores)) {}

std::vector<HazardChecker::PolyUse> HazardChecker::Request::poly_uses() const {
  std::vector<PolyUse> uses{
      {direction == Direction::mono_to_poly ? Access::write : Access::read, span, false}};
  if (addresses) uses.push_back({Access::read, *addresses, true});
  return uses;
}

void HazardChecker::throw_if_found() const {
  if (!hazard_.empty()) throw cn::MachineFault(hazard_);
}

void HazardChecker::firmware_ends() {
  if (hazard_.empty() && !outstanding_.empty())
    hazard_ =
        opening(false) + "the firmware ended without waiting for " + describe(outstanding_.front(), true);
  throw_if_found();
}

void HazardChecker::kernel_begins(const char* kernel) {
  throw_if_found();
  if (timed_) kernel_ = kernel;
}

void HazardChecker::touches_poly(Access access, cn::PolySpan bytes, int first_pe,
                                 std::uint32_t enabled) noexcept {
  if (!hazard_.empty()) return;
  if (enabled != 0 && !is_in_sram(bytes)) {
    hazard_ = opening(true) + "kernel '" + kernel_ + "' " + verb(access) + " poly bytes " +
              std::to_string(bytes.offset_bytes) + ".." +
              std::to_string(bytes.offset_bytes + bytes.size_bytes - 1) + " of PE " +
              std::to_string(first_pe + __builtin_ctz(enabled)) + ", whose SRAM has " +
              std::to_string(sram_bytes());
    return;
  }
  if (!timed_) return;
  const PolyOccupancy::Conflict conflict = occupancy_.find(access, bytes, first_pe, enabled);
  if (conflict.pe >= 0)
    found_in_poly(opening(true) + "kernel '" + kernel_ + "' " + verb(access) + " ", access, bytes, conflict);
}

int HazardChecker::sram_bytes() const {
  return machine_.poly_memory().capacity_bytes() + cn::PolyMemory::kReservedBytes;
}

bool HazardChecker::is_in_sram(cn::PolySpan bytes) const {
  return bytes.offset_bytes >= 0 && bytes.offset_bytes <= sram_bytes() - bytes.size_bytes;
}

void HazardChecker::kernel_is_silent() noexcept {
  if (hazard_.empty())
    hazard_ = "hazards cannot be checked: kernel '" + kernel_ + "' is not built to report its SRAM accesses";
}

void HazardChecker::touches_mono(Access access, cn::MonoAddress first, std::size_t bytes) {
  if (!timed_ || bytes == 0) return;
  check_mono(MonoFootprint(MonoRange{first, bytes}), access, "the control unit");
  throw_if_found();
}

void HazardChecker::host_touches_mono(Access access, const MonoRange& range) noexcept {
  if (!timed_ || range.bytes == 0) return;
  check_mono(MonoFootprint(range), access, "the host");
}

void HazardChecker::transfer_starts(const cn::Transfer& transfer) {
  throw_if_found();
  if (!timed_) return;
  if (transfer.poly.size_bytes == 0 || !transfer.enabled.any()) {
    signalled(transfer.done);
    return;
  }
  Signals& signals = signals_.at(std::size_t(transfer.done.index));
  std::uint64_t& of_direction = signals.transfers[std::size_t(transfer.direction)];
  Request request{next_id_++,
                  transfer.direction,
                  transfer.poly,
                  poly_addresses(transfer.mono),
                  transfer.enabled,
                  transfer.done,
                  clock_ ? clock_() : 0,
                  of_direction++,
                  MonoFootprint(transfer, machine_.num_pes()),
                  false};
  check_poly(request);
  check_mono(request);
  throw_if_found();
  for (const PolyUse& use : request.poly_uses()) occupancy_.add(use.access, use.span, request.pes);
  outstanding_.push_back(std::move(request));
}

void HazardChecker::timed(bool on) {
  timed_ = on;
  if (on) return;
  for (Request& request : outstanding_) request.seen_by_untimed_work = true;
}

void HazardChecker::signalled(cn::Semaphore semaphore) {
  if (timed_) ++signals_.at(std::size_t(semaphore.index)).others;
}

void HazardChecker::waited(cn::Semaphore semaphore) {
  if (!timed_) return;
  ++signals_.at(std::size_t(semaphore.index)).waits;
  release_if_over(semaphore);
}

bool HazardChecker::is_over(const Request& request) const {
  const Signals& signals = signals_[std::size_t(request.done.index)];
  const auto other = std::size_t(request.direction == Direction::mono_to_poly ? Direction::poly_to_mono
                                                                              : Direction::mono_to_poly);
  return signals.waits > request.of_direction + signals.transfers[other] + signals.others;
}

void HazardChecker::release_if_over(cn::Semaphore semaphore) {
  for (auto request = outstanding_.begin(); request != outstanding_.end();) {
    if (request->done.index != semaphore.index || !is_over(*request)) {
      ++request;
      continue;
    }
    const std::vector<PolyUse> over = request->poly_uses();
    const cn::LaneMask pes = request->pes;
    request = outstanding_.erase(request);
    for (const PolyUse& use : over) {
      occupancy_.remove(use.access, use.span, pes);
      for (const Request& other : outstanding_)
        for (const PolyUse& stays : other.poly_uses())
          if (stays.access == use.access && overlap(stays.span, use.span))
            occupancy_.add(stays.access, stays.span, other.pes);
    }
  }
}

std::optional<cn::PolySpan> HazardChecker::poly_addresses(const cn::MonoPlaces& places) const {
  const cn::PolyMemory& memory = machine_.poly_memory();
  if (places.by_pe == nullptr) return std::nullopt;
  const std::uint64_t* const first = memory.strip(0);
  const std::uint64_t* const end = memory.strip(0, memory.capacity_bytes());
  if (std::less<>()(places.by_pe, first) || !std::less<>()(places.by_pe, end)) return std::nullopt;
  return cn::PolySpan{8 * static_cast<int>((places.by_pe - first) / cn::kStripLanes), 8};
}

void HazardChecker::check_poly(const Request& request) {
  for (const PolyUse& use : request.poly_uses()) {
    const PolyOccupancy::Conflict conflict = occupancy_.find(use.access, use.span, request.pes);
    if (conflict.pe < 0) continue;
    found_in_poly(opening(false) + describe(request, false) + " " +
                      (use.is_addresses ? "takes addresses from" : verb(use.access)) + " ",
                  use.access, use.span, conflict);
    return;
  }
}

void HazardChecker::check_mono(const Request& request) {
  if (!hazard_.empty()) return;
  const Access access = request.mono_access();
  for (const Request& holder : outstanding_) {
    if (!conflicts(access, holder.mono_access())) continue;
    if (access == holder.mono_access() && holder.seen_by_untimed_work) continue;
    const std::optional<MonoRange> shared = request.mono.overlap(holder.mono);
    if (shared) return found_in_mono(describe(request, false), access, *shared, holder);
  }
}

void HazardChecker::check_mono(const MonoFootprint& footprint, Access access, const std::string& who) {
  if (!hazard_.empty()) return;
  for (const Request& holder : outstanding_) {
    if (!conflicts(access, holder.mono_access())) continue;
    const std::optional<MonoRange> shared = footprint.overlap(holder.mono);
    if (shared) return found_in_mono(who, access, *shared, holder);
  }
}

void HazardChecker::found_in_mono(const std::string& who, Access access, const MonoRange& shared,
                                  const Request& holder) {
  hazard_ = opening(false) + who + " " + verb(access) + " " + mono_name(shared) + ", which " +
            describe(holder, true) + " still " + verb(holder.mono_access());
}

void HazardChecker::found_in_poly(const std::string& who, Access access, cn::PolySpan bytes,
                                  const PolyOccupancy::Conflict& conflict) {
  const cn::PolySpan word{conflict.offset_bytes, 8};
  for (const Request& request : outstanding_) {
    for (const PolyUse& use : request.poly_uses()) {
      if (!request.pes[conflict.pe] || !conflicts(access, use.access) || !overlap(use.span, word)) continue;
      hazard_ = who + poly_name(bytes) + " of PE " + std::to_string(conflict.pe) + ", which " +
                describe(request, true) + " still " +
                (use.is_addresses ? "takes addresses from" : verb(use.access));
      return;
    }
  }
}

std::string HazardChecker::opening(bool within_kernel) const {
  std::string text = "hazard";
  if (clock_) text += " at cycle " + std::to_string(clock_());
  if (!within_kernel && !kernel_.empty()) text += ", after kernel '" + kernel_ + "'";
  return text + ": ";
}

std::string HazardChecker::describe(const Request& request, bool with_start) const {
  const bool is_load = request.direction == Direction::mono_to_poly;
  const int bytes = request.span.size_bytes * request.pes.count();
  return "request " + std::to_string(request.id) + " (" + (is_load ? "load, " : "save, ") +
         std::to_string(bytes) + " bytes, " +
         (with_start && clock_ ? "started at cycle " + std::to_string(request.started) + ", " : "") +
         "semaphore '" + machine_.semaphore_name(request.done) + "')";
}

std::string HazardChecker::mono_name(const MonoRange& range) const {
  std::string bytes = "mono bytes " + range_text(range.first, range.bytes);
  for (const MonoName& named : mono_names_)
    if (range.first >= named.range.first && range.first < named.range.first + named.range.bytes)
      return "'" + named.name + "' (" + bytes + ")";
  return bytes;
}

std::string HazardChecker::poly_name(cn::PolySpan bytes) const {
  std::string text =
      "poly bytes " + range_text(std::uint64_t(bytes.offset_bytes), std::uint64_t(bytes.size_bytes));
  for (const cn::PolyMemory::Buffer& buffer : machine_.poly_memory().buffers())
    if (overlap(buffer.span, bytes)) return "'" + buffer.name + "' (" + text + ")";
  return text;
}

}  // namespace model
