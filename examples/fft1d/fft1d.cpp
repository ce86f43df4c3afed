// Transforms of 1,024 complex numbers in single precision, batch after batch through three buffers.
//
// The number n = 128 r + q of a transform is loaded into PE q / 16, as number 16 r + q % 16 of the PE. Three
// stages within the PE transform over r and leave k1 = k mod 8 in bit-reversed order. PEs then exchange
// numbers, so that a PE has one k1 and all q; it multiplies by exp(-2 pi i q k1 / 1024) and transforms over q
// (Bailey, 1990, "FFTs in external or hierarchical memory"). Results are in bit-reversed order.

#include <cmath>
#include <complex>

#include "firmware/plug_in/firmware.hpp"
#include "kernels.hpp"

namespace fft1d {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kBuffers = 3;
constexpr int kPieceBytes = kOfPe * int{sizeof(Complex)};
constexpr int kRunBytes = kRun * int{sizeof(Complex)};

std::complex<double> root(double k, double of) {
  return std::polar(1.0, -2 * kPi * k / of);
}
Complex to_single(const std::complex<double>& a) {
  return {float(a.real()), float(a.imag())};
}

std::size_t bit_reversed(std::size_t number, int bits) {
  std::size_t reversed = 0;
  for (int bit = 0; bit < bits; ++bit) reversed |= (number >> bit & 1) << (bits - 1 - bit);
  return reversed;
}

/// A number in [-1, 1) that depends only on its index (the finaliser of SplitMix64: Steele, Lea and Flood,
/// 2014).
float input_of(std::uint64_t index) {
  std::uint64_t z = (index + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return float(double((z ^ (z >> 31)) >> 40) * 0x1p-23 - 1);
}

/// In double precision, by halves (Cooley and Tukey, 1965).
std::vector<std::complex<double>> transformed(const std::vector<std::complex<double>>& from) {
  const std::size_t half = from.size() / 2;
  if (half == 0) return from;
  std::vector<std::complex<double>> even(half), odd(half), result(from.size());
  for (std::size_t i = 0; i < half; ++i) even[i] = from[2 * i], odd[i] = from[2 * i + 1];
  even = transformed(even);
  odd = transformed(odd);
  for (std::size_t i = 0; i < half; ++i) {
    const std::complex<double> turned = root(double(i), double(from.size())) * odd[i];
    result[i] = even[i] + turned;
    result[i + half] = even[i] - turned;
  }
  return result;
}

class Fft1d : public plug_in::Firmware {
 public:
  Fft1d() : Firmware("fft1d", "transforms of 1,024 complex numbers in single precision") {}

  void prepare(int num_pes) override;
  void run(cn::Machine& machine) override;
  void check() const override;
  plug_in::Work work() const override { return {double(input_.size()) / kSize, "transforms"}; }

 private:
  struct Chip {
    cn::Machine& machine;
    cn::LaneMask all;
    cn::PolySpan data[kBuffers];
    cn::PolySpan scratch;
    cn::PolySpan factors;
    PlaceArguments places;
    cn::Semaphore loaded;
    cn::Semaphore saved;
  };
  std::uint64_t batch_bytes(const Chip& on, int batch) const {
    return std::uint64_t(batch) * std::uint64_t(on.machine.num_pes()) * kPieceBytes;
  }
  static Chip allocate(cn::Machine& machine);
  void load_factors(const Chip& on) const;
  void load(const Chip& on, int batch) const;
  void save(const Chip& on, int batch) const;
  void exchange_numbers(const Chip& on, int batch) const;
  void transform(const Chip& on, int batch) const;
  void run_with_copies(const Chip& on) const;
  void run_without_copies(const Chip& on) const;

  plug_in::Option<int> batches_{*this, "batches", 24, {1, 10000}, "batches of one transform for every 8 PEs"};
  plug_in::Option<int> copies_{*this, "copies", 1, {0, 1}, "0: copies from and to mono memory take no time"};
  plug_in::Option<int> pieces_{
      *this, "pieces", 1, {1, kGroup}, "1 or 8 pieces in which a PE loads its numbers"};
  plug_in::MonoBuffer<Complex> input_{*this, "input", plug_in::Use::upload};
  plug_in::MonoBuffer<Complex> twiddles_{*this, "twiddles", plug_in::Use::upload};
  plug_in::MonoBuffer<Complex> factors_{*this, "factors", plug_in::Use::upload};
  plug_in::MonoBuffer<Complex> output_{*this, "output", plug_in::Use::download};
};

void Fft1d::prepare(int num_pes) {
  if (num_pes % kGroup != 0)
    throw plug_in::OptionError("found " + std::to_string(num_pes) + " PEs, allowed is a multiple of 8");
  if (pieces_ != 1 && pieces_ != kGroup)
    throw plug_in::OptionError("pieces: found " + std::to_string(pieces_) + ", allowed is 1 or 8");
  input_.resize(std::size_t(batches_) * std::size_t(num_pes) * kOfPe);
  output_.resize(input_.size());
  for (std::size_t i = 0; i < input_.size(); ++i) input_[i] = {input_of(2 * i), input_of(2 * i + 1)};
  twiddles_.resize(kOfPe);
  for (std::size_t k = 0; k < kOfPe; ++k) twiddles_[k] = to_single(root(double(k), 2 * kOfPe));
  factors_.resize(kSize);
  for (std::size_t pe = 0; pe < kGroup; ++pe)
    for (std::size_t q = 0; q < kOfPe; ++q)
      factors_[pe * kOfPe + q] = to_single(root(double(q * bit_reversed(pe, kGroupBits)), kSize));
}

Fft1d::Chip Fft1d::allocate(cn::Machine& machine) {
  Chip on{machine, cn::LaneMask::first(machine.num_pes()), {}, {}, {}, {}, {}, {}};
  cn::PolyMemory& memory = machine.poly_memory();
  for (cn::PolySpan& data : on.data) data = memory.allocate("data", kPieceBytes);
  on.scratch = memory.allocate("scratch", kPieceBytes / 2);
  on.factors = memory.allocate("factors", kPieceBytes);
  on.places.input = {memory.allocate("place of the input", sizeof(cn::MonoAddress)).offset_bytes};
  on.places.factors = {memory.allocate("place of the factors", sizeof(cn::MonoAddress)).offset_bytes};
  on.loaded = machine.allocate_semaphore("loaded");
  on.saved = machine.allocate_semaphore("saved");
  return on;
}

void Fft1d::load_factors(const Chip& on) const {
  on.machine.run(cn::kernel<PlaceArguments, places>("places"), on.places, on.all);
  on.machine.async_copy_m2p(on.loaded, on.factors,
                            on.machine.places_in(on.places.factors, factors_.mono().address), on.all);
  on.machine.sem_wait(on.loaded);
}

/// One request for each piece; each signals.
void Fft1d::load(const Chip& on, int batch) const {
  const cn::MonoAddress first = input_.mono().address + batch_bytes(on, batch);
  const cn::PolySpan data = on.data[batch % kBuffers];
  if (pieces_ == 1)
    on.machine.async_copy_m2p(on.loaded, data, cn::MonoPlaces::array(first, kPieceBytes), on.all);
  for (int r = 0; r < pieces_ && pieces_ > 1; ++r)
    on.machine.async_copy_m2p(on.loaded, {data.offset_bytes + r * kRunBytes, kRunBytes},
                              on.machine.places_in(on.places.input, first + std::uint64_t(r) * kPieceBytes),
                              on.all);
}

void Fft1d::exchange_numbers(const Chip& on, int batch) const {
  for (int bit = 0; bit < kGroupBits; ++bit) {
    const ExchangeArguments arguments{cn::PolyArray<std::uint64_t>(on.data[batch % kBuffers]),
                                      cn::PolyArray<std::uint64_t>(on.scratch), bit};
    on.machine.run(cn::kernel<ExchangeArguments, exchange>("exchange"), arguments, on.all);
    on.machine.run(cn::kernel<ExchangeArguments, exchange_store>("exchange_store"), arguments, on.all);
  }
}

void Fft1d::save(const Chip& on, int batch) const {
  on.machine.async_copy_p2m(
      on.saved, cn::MonoPlaces::array(output_.mono().address + batch_bytes(on, batch), kPieceBytes),
      on.data[batch % kBuffers], on.all);
}

void Fft1d::transform(const Chip& on, int batch) const {
  const cn::PolyArray<std::uint64_t> data(on.data[batch % kBuffers]);
  const Complex* const twiddles = on.machine.read_mono(twiddles_.mono(), kOfPe);
  const auto run_stages = [&](int last_span) {
    on.machine.run(cn::kernel<StageArguments, stages>("stages"), {data, twiddles, last_span}, on.all);
  };
  if (pieces_ == 1) exchange_numbers(on, batch);
  run_stages(kRun);
  exchange_numbers(on, batch);
  on.machine.run(cn::kernel<TurnArguments, turn>("turn"), {data, cn::PolyArray<std::uint64_t>(on.factors)},
                 on.all);
  run_stages(1);
}

/// While a batch is transformed, the next is loaded and the last one saved.
void Fft1d::run_with_copies(const Chip& on) const {
  load(on, 0);
  for (int batch = 0; batch < batches_; ++batch) {
    for (int piece = 0; piece < pieces_; ++piece) on.machine.sem_wait(on.loaded);
    if (batch >= kBuffers - 1) on.machine.sem_wait(on.saved);
    if (batch + 1 < batches_) load(on, batch + 1);
    transform(on, batch);
    save(on, batch);
  }
  for (int batch = std::max(0, batches_ - (kBuffers - 1)); batch < batches_; ++batch)
    on.machine.sem_wait(on.saved);
}

void Fft1d::run_without_copies(const Chip& on) const {
  for (int batch = 0; batch < batches_; ++batch) {
    {
      const cn::Untimed untimed(on.machine);
      load(on, batch);
      for (int piece = 0; piece < pieces_; ++piece) on.machine.sem_wait(on.loaded);
    }
    transform(on, batch);
    const cn::Untimed untimed(on.machine);
    save(on, batch);
    on.machine.sem_wait(on.saved);
  }
}

void Fft1d::run(cn::Machine& machine) {
  const Chip on = allocate(machine);
  load_factors(on);
  copies_ != 0 ? run_with_copies(on) : run_without_copies(on);
}

void Fft1d::check() const {
  constexpr double kTolerance = 1e-4;  // outputs are near 26; ten stages of single precision
  for (std::size_t first = 0; first < input_.size(); first += kSize) {
    std::vector<std::complex<double>> numbers(kSize);
    for (std::size_t n = 0; n < kSize; ++n)
      numbers[n] = {input_[first + n].real, input_[first + n].imaginary};
    numbers = transformed(numbers);
    for (std::size_t i = 0; i < kSize; ++i) {
      const std::complex<double> found{output_[first + i].real, output_[first + i].imaginary};
      const std::size_t k = bit_reversed(i, 10);
      if (!(std::abs(found - numbers[k]) <= kTolerance))
        throw plug_in::CheckFailed("output " + std::to_string(k) + " of transform " +
                                   std::to_string(first / kSize) + " is off by " +
                                   std::to_string(std::abs(found - numbers[k])));
    }
  }
}

}  // namespace
}  // namespace fft1d

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  return std::make_unique<fft1d::Fft1d>();
}
