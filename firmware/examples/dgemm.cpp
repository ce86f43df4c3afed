#include "firmware/examples/dgemm.hpp"

#include "firmware/examples/mono_cost.hpp"

namespace examples {
namespace {

constexpr int kDoubleBytes = sizeof(double);

void require_multiple(const char* what, int found, int of) {
  if (found < of || found % of != 0)
    throw cn::MachineFault("DGEMM " + std::string(what) + ": found " + std::to_string(found) +
                           ", allowed is a positive multiple of " + std::to_string(of));
}

cn::LaneMask pes_from_to(int first, int end) {
  return cn::LaneMask::first(end).without(cn::LaneMask::first(first));
}

}  // namespace

Dgemm::Dgemm(cn::Machine& machine, const Kernels& kernels, const Problem& problem)
    : machine_(machine), kernels_(kernels), problem_(problem) {
  const Shape& shape = problem.shape;
  require_multiple("chunk_tiles", shape.chunk_tiles, 1);
  require_multiple("tiles", shape.tiles, shape.chunk_tiles);
  require_multiple("depth", shape.depth, kFeeders);
  if (computing_pes() <= 0)
    throw cn::MachineFault("DGEMM: found " + std::to_string(machine.num_pes()) +
                           " PEs, allowed are more than " + std::to_string(kFeeders));
  c_ = machine.poly_memory().allocate("C", shape.tiles * kRows * kTileColumns * kDoubleBytes);
  b_ = machine.poly_memory().allocate("B", shape.tiles * kTileColumns * kDoubleBytes);
  for (cn::PolySpan& a : a_) a = machine.poly_memory().allocate("A", shape.depth * kRows * kDoubleBytes);
  if (2 * fed(0).size_bytes > c_.size_bytes)
    throw cn::MachineFault("DGEMM: found two chunks of " + std::to_string(fed(0).size_bytes) +
                           " bytes in a feeder, allowed are together the " + std::to_string(c_.size_bytes) +
                           " bytes that C has");
  a_loaded_ = machine.allocate_semaphore("A loaded");
  b_loaded_ = machine.allocate_semaphore("B loaded");
  fed_ = machine.allocate_semaphore("feeders loaded");
  saved_ = machine.allocate_semaphore("C saved");
}

/// Loads everything a step ahead. A is loaded for the panel after, in as many parts as there are steps, so
/// that B does not wait for it.
void Dgemm::run() {
  load_b_stream(0);
  for (int part = 0; part < chunks(); ++part) load_a(0, part);
  for (int number = 0; number < steps(); ++number) {
    const Step at = step(number);
    if (at.chunk == 0 && at.panel == 0) load_b_start(at);
    if (number + 1 < steps()) load_b_stream(number + 1);
    if (at.chunk == 0)
      for (int part = 0; part < chunks(); ++part) machine_.sem_wait(a_loaded_);
    if (number + chunks() < steps()) load_a(panel_number(number) + 1, at.chunk);
    machine_.sem_wait(fed_);
    multiply(number);
    if (at.panel + 1 == problem_.panels && at.chunk + 1 == chunks()) save_c(at);
  }
}

Dgemm::Step Dgemm::step(int number) const {
  const int panel = panel_number(number);
  const int block = panel / problem_.panels;
  return {block / problem_.column_blocks, block % problem_.column_blocks, panel % problem_.panels,
          number % chunks()};
}

/// Returns one of two buffers.
cn::PolySpan Dgemm::fed(int number) const {
  const Shape& shape = problem_.shape;
  const int bytes = shape.chunk_tiles * shape.depth / kFeeders * kTileColumns * kDoubleBytes;
  return {c_.offset_bytes + number % 2 * bytes, bytes};
}

void Dgemm::load_a(int panel_number, int part) {
  machine_.issue_mono(kRequestInstructions);
  const Step at = step(panel_number * chunks());
  const cn::PolySpan to = a_[panel_number % 2];
  const auto bytes = std::uint64_t(to.size_bytes);
  const auto panel = std::uint64_t(at.row_block) * std::uint64_t(problem_.panels) + std::uint64_t(at.panel);
  const cn::MonoAddress from = problem_.a.address + panel * std::uint64_t(computing_pes()) * bytes;
  const cn::LaneMask pes =
      pes_from_to(part * computing_pes() / chunks(), (part + 1) * computing_pes() / chunks());
  machine_.async_copy_m2p(a_loaded_, to, cn::MonoPlaces::array(from, bytes), pes);
}

void Dgemm::load_b_start(const Step& at) {
  machine_.issue_mono(kRequestInstructions);
  const auto bytes = std::uint64_t(b_.size_bytes);
  const cn::MonoAddress from =
      problem_.b_start.address + std::uint64_t(at.column_block) * std::uint64_t(computing_pes()) * bytes;
  machine_.async_copy_m2p(b_loaded_, b_, cn::MonoPlaces::array(from, bytes),
                          cn::LaneMask::first(computing_pes()));
  machine_.sem_wait(b_loaded_);
}

void Dgemm::load_b_stream(int number) {
  machine_.issue_mono(kRequestInstructions);
  const Step at = step(number);
  const cn::PolySpan to = fed(number);
  const auto bytes = std::uint64_t(to.size_bytes);
  const auto panel =
      std::uint64_t(at.column_block) * std::uint64_t(problem_.panels) + std::uint64_t(at.panel);
  const std::uint64_t chunk = panel * std::uint64_t(chunks()) + std::uint64_t(at.chunk);
  // The first feeder is PE computing_pes(). Its address is computed by PE number and wraps.
  const cn::MonoAddress from =
      problem_.b_stream.address + chunk * kFeeders * bytes - std::uint64_t(computing_pes()) * bytes;
  machine_.async_copy_m2p(fed_, to, cn::MonoPlaces::array(from, bytes),
                          pes_from_to(computing_pes(), machine_.num_pes()));
}

void Dgemm::multiply(int number) {
  const Step at = step(number);
  const Shape& shape = problem_.shape;
  MultiplyTilesArguments arguments;
  arguments.a = PolyArray<double>(a_[panel_number(number) % 2]);
  arguments.b_in_place = PolyArray<double>(b_);
  arguments.b_fed = PolyArray<double>(fed(number));
  arguments.c = PolyArray<double>(c_);
  arguments.first_tile = at.chunk * shape.chunk_tiles;
  arguments.tiles = shape.chunk_tiles;
  arguments.depth = shape.depth;
  arguments.first = at.panel == 0;
  machine_.run(kernels_.multiply_tiles, arguments, cn::LaneMask::first(machine_.num_pes()));
}

void Dgemm::save_c(const Step& at) {
  machine_.issue_mono(kRequestInstructions);
  const auto block =
      std::uint64_t(at.row_block) * std::uint64_t(problem_.column_blocks) + std::uint64_t(at.column_block);
  const auto bytes = std::uint64_t(c_.size_bytes);
  const cn::MonoAddress to = problem_.c.address + block * std::uint64_t(computing_pes()) * bytes;
  machine_.async_copy_p2m(saved_, cn::MonoPlaces::array(to, bytes), c_, cn::LaneMask::first(computing_pes()));
  machine_.sem_wait(saved_);
}

}  // namespace examples
