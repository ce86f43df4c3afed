#include "firmware/examples/fft.hpp"

#include <algorithm>

#include "firmware/examples/mono_cost.hpp"

namespace examples {
namespace {

/// Bits of the index that the exchange swaps with bits 0 to 4 of the PE's number within its group.
///
/// Rows: PE 2 r + h has column 2 m + h of row r at the bit-reversed m, so index bit 7 - j is bit j of m.
/// After the exchange, the low five bits of m are the PE's (fft_places undoes their order) and a tile's index
/// has, from bit 7 down, bits 1, 2, 3, 0 of r, then h, then bits 5, 6, 7 of m.
constexpr int kRowExchange[kGroupBits] = {3, 4, 7, 6, 5};
/// Columns: PE t has tile t of its 16 columns, rows 16 t to 16 t + 15. After the exchange, PEs 2 c and 2 c +
/// 1 have the even and odd rows of one column, each in bit-reversed order: bits 1, 2, 3 of r, then all of t.
constexpr int kColumnExchange[kGroupBits] = {4, 3, 2, 1, 0};

cn::PolyField<cn::MonoAddress> allocate_place(cn::Machine& machine, const char* name) {
  return {machine.poly_memory().allocate(name, sizeof(cn::MonoAddress)).offset_bytes};
}

}  // namespace

Fft::Fft(cn::Machine& machine, const Kernels& kernels, const Layout& layout)
    : machine_(machine), kernels_(kernels), layout_(layout) {
  if (machine.num_pes() % (1 << kGroupBits) != 0)
    throw cn::MachineFault("FFT: found " + std::to_string(machine.num_pes()) +
                           " PEs, allowed is a multiple of 32");
  if (layout.count < 2)
    throw cn::MachineFault("FFT: found " + std::to_string(layout.count) + " images, allowed is 2 or more");
  for (cn::PolySpan& buffer : buffer_) buffer = machine.poly_memory().allocate("half lines", kPieceBytes);
  scratch_ = machine.poly_memory().allocate("scratch", kPieceBytes / 2);
  places_ = {allocate_place(machine, "tiles to save"), allocate_place(machine, "tiles to load"),
             allocate_place(machine, "result")};
  loaded_ = machine.allocate_semaphore("loaded");
  saved_ = machine.allocate_semaphore("saved");
}

/// Uses two buffers: while one is in process, the other is saved and then loaded, each during one half of the
/// step.
void Fft::run() {
  machine_.run(kernels_.fft_places, places_, cn::LaneMask::first(machine_.num_pes()));
  load(0);
  machine_.sem_wait(loaded_);
  for (int number = 0; number < steps(); ++number) {
    const bool rows = step(number).pass == 0;
    rows ? transform(number) : exchange(number);
    if (number > 0) machine_.sem_wait(saved_);
    if (number + 1 < steps()) load(number + 1);
    rows ? exchange(number) : transform(number);
    save(number);
    if (number + 1 < steps()) machine_.sem_wait(loaded_);
  }
  machine_.sem_wait(saved_);
}

Fft::Step Fft::step(int number) const {
  const int steps_per_pass = layout_.count * batches();
  const int in_pass = number % steps_per_pass;
  return {number / steps_per_pass, in_pass / batches(), in_pass % batches()};
}

cn::LaneMask Fft::enabled(const Step& step) const {
  const int groups_left = (1 << kGroupBits) - step.batch * groups();
  return cn::LaneMask::first(std::min(groups(), groups_left) << kGroupBits);
}

void Fft::load(int number) {
  machine_.issue_mono(kRequestInstructions);
  const Step at = step(number);
  const std::uint64_t image = std::uint64_t(at.image) * kImageBytes;
  const auto first_group = std::uint64_t(at.batch) * std::uint64_t(groups());
  const cn::MonoPlaces from =
      at.pass == 0
          ? cn::MonoPlaces::array(layout_.images.address + image + first_group * kTileRowBytes, kPieceBytes)
          : machine_.places_in(places_.tile_load, layout_.tiles.address + image + first_group * kPieceBytes);
  machine_.async_copy_m2p(loaded_, buffer_[number % 2], from, enabled(at));
}

void Fft::save(int number) {
  machine_.issue_mono(kRequestInstructions);
  const Step at = step(number);
  const std::uint64_t image = std::uint64_t(at.image) * kImageBytes;
  const auto first_group = std::uint64_t(at.batch) * std::uint64_t(groups());
  const cn::MonoPlaces to =
      at.pass == 0
          ? machine_.places_in(places_.tile_save, layout_.tiles.address + image + first_group * kTileRowBytes)
          : machine_.places_in(places_.result,
                               layout_.results.address + image + first_group * (2 * kLineBytes));
  machine_.async_copy_p2m(saved_, to, buffer_[number % 2], enabled(at));
}

FftArguments Fft::arguments(int number) {
  FftArguments arguments;
  arguments.data = PolyArray<std::uint64_t>(buffer_[number % 2]);
  arguments.scratch = PolyArray<std::uint64_t>(scratch_);
  arguments.twiddles = machine_.read_mono(layout_.twiddles, kComplexPerPe);
  arguments.from_reversed = step(number).pass == 1;
  return arguments;
}

/// Transforms lines of 512 numbers in two PEs each: 256 numbers within each PE, then butterflies between the
/// two.
void Fft::transform(int number) {
  FftArguments arguments = this->arguments(number);
  const cn::LaneMask all = enabled(step(number));
  const auto between_pes = [&] {
    for (arguments.half = 0; arguments.half < 2; ++arguments.half) {
      machine_.run(kernels_.fft_pair, arguments, all);
      machine_.run(kernels_.fft_pair_store, arguments, all);
    }
  };
  if (arguments.from_reversed) {
    machine_.run(kernels_.fft_local, arguments, all);
    machine_.run(kernels_.fft_twiddle, arguments, all);
    between_pes();
  } else {
    between_pes();
    machine_.run(kernels_.fft_twiddle, arguments, all);
    machine_.run(kernels_.fft_local, arguments, all);
  }
}

void Fft::exchange(int number) {
  FftArguments arguments = this->arguments(number);
  const Step at = step(number);
  for (int bit = 0; bit < kGroupBits; ++bit) {
    arguments.pe_bit = bit;
    arguments.index_bit = at.pass == 0 ? kRowExchange[bit] : kColumnExchange[bit];
    machine_.run(kernels_.fft_exchange, arguments, enabled(at));
    machine_.run(kernels_.fft_exchange_store, arguments, enabled(at));
  }
}

}  // namespace examples
