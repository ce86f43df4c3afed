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

}  // namespace

Dgemm::Dgemm(cn::Machine& machine, const Kernels& kernels, const Problem& problem)
    : machine_(machine), kernels_(kernels), problem_(problem), all_(cn::LaneMask::first(machine.num_pes())) {
  const Shape& shape = problem.shape;
  require_multiple("rows", shape.rows, 4);
  require_multiple("columns", shape.columns, 3);
  require_multiple("depth", shape.depth, 1);
  c_ = machine.poly_memory().allocate("C", shape.rows * shape.columns * kDoubleBytes);
  for (cn::PolySpan& a : a_) a = machine.poly_memory().allocate("A", shape.rows * shape.depth * kDoubleBytes);
  loaded_ = machine.allocate_semaphore("A loaded");
  saved_ = machine.allocate_semaphore("C saved");
}

void Dgemm::run() {
  load_a(0);
  for (int number = 0; number < steps(); ++number) {
    if (number + 1 < steps()) load_a(number + 1);
    multiply(number);
  }
}

Dgemm::Step Dgemm::step(int number) const {
  const int block = number / problem_.depth_blocks;
  return {block / problem_.column_blocks, block % problem_.column_blocks, number % problem_.depth_blocks};
}

void Dgemm::load_a(int number) {
  machine_.issue_mono(kRequestInstructions);
  const Step at = step(number);
  const cn::PolySpan to = a_[number % 2];
  const auto elements = std::uint64_t(to.size_bytes / kDoubleBytes);
  const auto block =
      std::uint64_t(at.row_block) * std::uint64_t(problem_.depth_blocks) + std::uint64_t(at.depth_block);
  const cn::MonoPointer<double> from = problem_.a + block * std::uint64_t(machine_.num_pes()) * elements;
  machine_.async_copy_m2p(loaded_, to, cn::MonoPlaces::array(from.address, std::uint64_t(to.size_bytes)),
                          all_);
}

void Dgemm::multiply(int number) {
  const Step at = step(number);
  const Shape& shape = problem_.shape;
  const auto elements = std::uint64_t(shape.depth) * std::uint64_t(shape.columns);
  const auto block =
      std::uint64_t(at.column_block) * std::uint64_t(problem_.depth_blocks) + std::uint64_t(at.depth_block);
  MultiplyBlockArguments arguments;
  arguments.b = machine_.read_mono(problem_.b + block * elements, elements);
  arguments.a = PolyArray<double>(a_[number % 2]);
  arguments.c = PolyArray<double>(c_);
  arguments.rows = shape.rows;
  arguments.columns = shape.columns;
  arguments.depth = shape.depth;
  arguments.first = at.depth_block == 0;
  machine_.sem_wait(loaded_);
  machine_.run(kernels_.multiply_block, arguments, all_);
  if (at.depth_block + 1 == problem_.depth_blocks) save_c(at);
}

void Dgemm::save_c(const Step& at) {
  machine_.issue_mono(kRequestInstructions);
  const auto block =
      std::uint64_t(at.row_block) * std::uint64_t(problem_.column_blocks) + std::uint64_t(at.column_block);
  const auto bytes = std::uint64_t(c_.size_bytes);
  const cn::MonoAddress to = problem_.c.address + block * std::uint64_t(machine_.num_pes()) * bytes;
  machine_.async_copy_p2m(saved_, cn::MonoPlaces::array(to, bytes), c_, all_);
  machine_.sem_wait(saved_);
}

}  // namespace examples
