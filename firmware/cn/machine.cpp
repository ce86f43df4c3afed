#include "firmware/cn/machine.hpp"

#include "firmware/cn/language/offset_bits.hpp"
#include "firmware/cn/language/shortcut.hpp"

namespace cn {
namespace {

void check_span(const PolySpan& span, const PolyMemory& memory) {
  const int capacity = memory.capacity_bytes();
  if (span.offset_bytes < 0 || span.size_bytes < 0 || span.size_bytes > capacity - span.offset_bytes)
    throw MachineFault("transfer of " + std::to_string(span.size_bytes) + " bytes at poly offset " +
                       std::to_string(span.offset_bytes) + " leaves the " + std::to_string(capacity) +
                       " bytes of poly SRAM");
}

void check_alignment(const Transfer& transfer, int num_pes) {
  const auto fault = [&](const std::string& what, std::uint64_t found) {
    throw MachineFault("transfer of poly offset " + std::to_string(transfer.poly.offset_bytes) + ": " + what +
                       " is " + std::to_string(found) + ", must be a multiple of 8");
  };
  if (transfer.poly.size_bytes % 8 != 0) fault("size", std::uint64_t(transfer.poly.size_bytes));
  if (transfer.poly.offset_bytes % 8 != 0) fault("poly offset", std::uint64_t(transfer.poly.offset_bytes));
  if (transfer.mono.by_pe == nullptr) {
    if (transfer.mono.first % 8 != 0) fault("mono address", transfer.mono.first);
    if (transfer.mono.stride_bytes % 8 != 0) fault("stride", transfer.mono.stride_bytes);
    return;
  }
  if ((transfer.mono.first | offset_bits(transfer, num_pes)) % 8 == 0) return;
  const int pe = first_pe_not(transfer, num_pes, [](MonoAddress place) { return place % 8 == 0; });
  if (pe >= 0) fault("mono address of PE " + std::to_string(pe), transfer.mono[pe]);
}

}  // namespace

Machine::Machine(int num_pes, int poly_bytes_per_pe) : poly_memory_(num_pes, poly_bytes_per_pe) {}

void Machine::async_copy_m2p(Semaphore done, PolySpan destination, const MonoPlaces& source,
                             const LaneMask& enabled) {
  const Transfer transfer{Direction::mono_to_poly, destination, source, enabled, done, label_};
  begin_transfer(transfer);
}

void Machine::async_copy_p2m(Semaphore done, const MonoPlaces& destination, PolySpan source,
                             const LaneMask& enabled) {
  const Transfer transfer{Direction::poly_to_mono, source, destination, enabled, done, label_};
  begin_transfer(transfer);
}

void Machine::begin_transfer(const Transfer& transfer) {
  check_span(transfer.poly, poly_memory_);
  check_alignment(transfer, num_pes());
  if (access_observer() != nullptr) access_observer()->transfer_starts(transfer);
  start_transfer(transfer);
}

Semaphore Machine::allocate_semaphore(const std::string& name) {
  if (semaphore_names_.size() == std::size_t(kSemaphores))
    throw MachineFault("no semaphore left for '" + name + "': the chip has " + std::to_string(kSemaphores));
  semaphore_names_.push_back(name);
  return {static_cast<int>(semaphore_names_.size()) - 1};
}

void Machine::begin_program() {
  poly_memory_.free_all();
  semaphore_names_.clear();
  label_ = {};
}

void Machine::start_thread(int, const std::string& name, std::function<void()>) {
  throw MachineFault("start of thread '" + name + "': this machine has one thread");
}

void Machine::program_search_unit(std::shared_ptr<SearchFunction>) {
  throw MachineFault("program of a search unit: this machine has none");
}

int Machine::count(const LaneMask& lanes) {
  issued_.clear();
  issued_.root().counts[InstructionClass::reduce] = 1;
  issued_.root().reached = true;
  issued_.root().enabled_lanes = std::uint64_t(num_pes());
  retire("count", issued_);
  return lanes.count();
}

void Machine::observe_poly(Access access, PolySpan bytes, const LaneMask& enabled) {
  for (int first_pe = 0; first_pe < num_pes(); first_pe += kStripLanes)
    access_observer()->touches_poly(access, bytes, first_pe, enabled.strip_bits(first_pe / kStripLanes));
}

/// Returns how many PEs are chosen. Arithmetic instead of a branch on the choice, which the processor could
/// not predict.
int Machine::write_ascending(const LaneMask& chosen, PolyField<std::int32_t> number) {
  const int shift = number.offset_bytes % 8 * 8;
  const std::uint64_t place = std::uint64_t{0xffffffffu} << shift;
  std::uint64_t next = 0;
  for (int first_pe = 0; first_pe < num_pes(); first_pe += kStripLanes) {
    const unsigned bits = chosen.strip_bits(first_pe / kStripLanes);
    std::uint64_t* const words = poly_memory_.strip(first_pe, number.offset_bytes / 8 * 8);
    for (int lane = 0; lane < kStripLanes; ++lane) {
      const std::uint64_t is_chosen = (bits >> lane) & 1u;
      std::uint64_t& word = words[lane];
      const std::uint64_t replaced = place & -is_chosen;
      word = (word & ~replaced) | ((next << shift) & replaced);
      next += is_chosen;
    }
  }
  return static_cast<int>(next);
}

/// A running count by doubling distance: in round r each PE adds the count of the PE 2^r to its left, which
/// takes 2^r steps along the path.
void Machine::charge_running_count() {
  std::uint64_t steps = 0;
  std::uint64_t rounds = 0;
  for (int distance = 1; distance < num_pes(); distance *= 2, ++rounds) steps += std::uint64_t(distance);
  issued_.clear();
  IssueTree::Node& node = issued_.root();
  node.counts[InstructionClass::swazzle] = steps;
  node.counts[InstructionClass::int16_alu] = rounds + 1;
  node.counts[InstructionClass::enable] = 2 * rounds;
  node.counts[InstructionClass::sram] = 1;
  node.counts[InstructionClass::reduce] = 1;
  node.reached = true;
  node.enabled_lanes = std::uint64_t(num_pes());
}

int Machine::number_ascending(const LaneMask& chosen, PolyField<std::int32_t> number) {
  if (access_observer() != nullptr) {
    access_observer()->kernel_begins("number_ascending");
    observe_poly(Access::write, {number.offset_bytes, sizeof(std::int32_t)}, chosen);
    access_observer()->kernel_ends();
  }
  const int count =
      found_another_way([&] { charge_running_count(); }, [&] { return write_ascending(chosen, number); });
  retire("number_ascending", issued_);
  return count;
}

int Machine::number_ascending(const LaneMask* chosen, int things, PolyField<std::int32_t> number) {
  if (access_observer() != nullptr) {
    access_observer()->kernel_begins("number_ascending");
    observe_poly(Access::write, {number.offset_bytes, sizeof(std::int32_t)}, LaneMask::first(num_pes()));
    access_observer()->kernel_ends();
  }
  charge_running_count();
  issued_.root().counts[InstructionClass::int16_alu] += std::uint64_t(things - 1);  // the PE's own, summed
  const int shift = number.offset_bytes % 8 * 8;
  const std::uint64_t place = std::uint64_t{0xffffffffu} << shift;
  std::uint64_t next = 0;
  for (int pe = 0; pe < num_pes(); ++pe) {
    std::uint64_t& word = poly_memory_.word(pe, number.offset_bytes / 8 * 8);
    word = (word & ~place) | (next << shift);
    for (int thing = 0; thing < things; ++thing) next += std::uint64_t{chosen[thing][pe]};
  }
  retire("number_ascending", issued_);
  return static_cast<int>(next);
}

void Machine::observe_swazzle(const char* name, PolyField<std::uint64_t> value, int from_neighbour) {
  const int first = 0;
  const int last = num_pes() - 1;
  LaneMask senders = LaneMask::first(num_pes());
  LaneMask receivers = senders;
  senders.set(from_neighbour < 0 ? last : first, false);
  receivers.set(from_neighbour < 0 ? first : last, false);
  const PolySpan bytes{value.offset_bytes, sizeof(std::uint64_t)};
  access_observer()->kernel_begins(name);
  observe_poly(Access::read, bytes, senders);
  observe_poly(Access::write, bytes, receivers);
  access_observer()->kernel_ends();
}

void Machine::swazzle_rows(PolyField<std::uint64_t> value, int from_neighbour) {
  const char* const name = from_neighbour < 0 ? "swazzle_up" : "swazzle_down";
  if (access_observer() != nullptr) observe_swazzle(name, value, from_neighbour);
  const auto word = [&](int pe) -> std::uint64_t& { return poly_memory_.word(pe, value.offset_bytes); };
  if (from_neighbour < 0) {
    for (int pe = num_pes() - 1; pe > 0; --pe) word(pe) = word(pe - 1);
  } else {
    for (int pe = 0; pe < num_pes() - 1; ++pe) word(pe) = word(pe + 1);
  }
  issued_.clear();
  IssueTree::Node& node = issued_.root();
  node.counts[InstructionClass::swazzle] = 1;
  node.counts[InstructionClass::sram] = 4;  // 8 bytes read and written
  node.reached = true;
  node.enabled_lanes = std::uint64_t(num_pes());
  retire(name, issued_);
}

void Machine::swazzle_up(PolyField<std::uint64_t> value) {
  swazzle_rows(value, -1);
}
void Machine::swazzle_down(PolyField<std::uint64_t> value) {
  swazzle_rows(value, +1);
}

}  // namespace cn
