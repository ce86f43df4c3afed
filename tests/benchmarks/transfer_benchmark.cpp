// Simulator time of programmed I/O: the copy itself, its description, its booking in the memory.

#include <benchmark/benchmark.h>

#include <numeric>
#include <random>

#include "firmware/cn/chip/transfer.hpp"
#include "model/config/chip_presets.hpp"
#include "model/memory/ddr_timing.hpp"
#include "model/transaction/mono_pieces.hpp"

namespace {

constexpr int kPes = 96;
constexpr int kPolyBytes = 6144;
constexpr std::size_t kMonoBytes = 1 << 20;

enum class Places { array, gather };

/// A transfer of `bytes` per PE. Gathers address ascending records with gaps, as in the path tracer.
class Request {
 public:
  Request(cn::Direction direction, Places places, int bytes, int enabled_pes, unsigned seed) {
    std::mt19937 random(seed);
    cn::MonoAddress next = 0;
    for (cn::MonoAddress& address : addresses_) {
      address = next;
      next += std::uint64_t(bytes) * (1 + random() % 3);
    }
    std::vector<int> pes(kPes);
    std::iota(pes.begin(), pes.end(), 0);
    std::shuffle(pes.begin(), pes.end(), random);
    for (int i = 0; i < enabled_pes; ++i) transfer_.enabled.set(pes[std::size_t(i)], true);
    transfer_.direction = direction;
    transfer_.poly = {1024, bytes};
    transfer_.mono = places == Places::array ? cn::MonoPlaces::array(64, std::uint64_t(bytes))
                                             : cn::MonoPlaces::each(addresses_.data(), 64);
  }
  const cn::Transfer& transfer() const { return transfer_; }

 private:
  std::vector<cn::MonoAddress> addresses_ = std::vector<cn::MonoAddress>(kPes);
  cn::Transfer transfer_;
};

/// Requests that differ in enabled PEs and addresses, because the branch predictor of the x86 would learn a
/// single repeated request.
class Requests {
 public:
  Requests(cn::Direction direction, Places places, const benchmark::State& state) {
    for (unsigned seed = 1; seed <= kRequests; ++seed)
      requests_.emplace_back(direction, places, static_cast<int>(state.range(0)),
                             static_cast<int>(state.range(1)), seed);
  }
  const cn::Transfer& next() { return requests_[next_++ % kRequests].transfer(); }

  static constexpr std::size_t kRequests = 256;

 private:
  std::vector<Request> requests_;
  std::size_t next_ = 0;
};

void bytes_and_pes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"bytes", "pes"});
  for (const int bytes : {24, 56, 104, 192}) benchmark->Args({bytes, kPes});
  for (const int bytes : {24, 56, 104}) benchmark->Args({bytes, kPes / 2});
}

template <cn::Direction direction, Places places>
void move_data(benchmark::State& state) {
  Requests requests(direction, places, state);
  cn::PolyMemory poly(kPes, kPolyBytes);
  std::vector<std::uint8_t> mono(kMonoBytes);
  for (auto _ : state) {
    cn::move_data(requests.next(), poly, mono.data());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * state.range(0) * state.range(1));
}
BENCHMARK(move_data<cn::Direction::mono_to_poly, Places::array>)->Apply(bytes_and_pes);
BENCHMARK(move_data<cn::Direction::mono_to_poly, Places::gather>)->Apply(bytes_and_pes);
BENCHMARK(move_data<cn::Direction::poly_to_mono, Places::array>)->Apply(bytes_and_pes);
BENCHMARK(move_data<cn::Direction::poly_to_mono, Places::gather>)->Apply(bytes_and_pes);

model::MonoPieces::Rules rules() {
  return {model::Divisor(64), false};
}

template <Places places>
void describe(benchmark::State& state) {
  Requests requests(cn::Direction::mono_to_poly, places, state);
  model::MonoPieces pieces;
  for (auto _ : state) {
    pieces.describe(requests.next(), kPes, rules());
    benchmark::DoNotOptimize(pieces.packets());
  }
}
BENCHMARK(describe<Places::array>)->Apply(bytes_and_pes);
BENCHMARK(describe<Places::gather>)->Apply(bytes_and_pes);

template <Places places>
void ddr_access(benchmark::State& state) {
  Requests requests(cn::Direction::mono_to_poly, places, state);
  std::vector<model::MonoPieces> pieces(Requests::kRequests);
  for (model::MonoPieces& request : pieces) request.describe(requests.next(), kPes, rules());
  model::DdrTiming timing(model::preset("csx600").ddr);
  model::Cycles now = 0;
  std::size_t next = 0;
  for (auto _ : state) now = timing.access(pieces[next++ % pieces.size()].runs(), false, now).finish;
  benchmark::DoNotOptimize(now);
}
BENCHMARK(ddr_access<Places::array>)->Apply(bytes_and_pes);
BENCHMARK(ddr_access<Places::gather>)->Apply(bytes_and_pes);

}  // namespace
