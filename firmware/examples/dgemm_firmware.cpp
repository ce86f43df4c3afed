#include <optional>

#include "firmware/examples/firmwares.hpp"
#include "firmware/plug_in/random.hpp"

namespace examples {
namespace {

/// The places of the elements of a DGEMM problem in mono memory.
class DgemmBlocks {
 public:
  DgemmBlocks(const Dgemm::Problem& problem, int num_pes)
      : pes_(std::uint64_t(num_pes) - kFeeders),
        tiles_(std::uint64_t(problem.shape.tiles)),
        chunk_tiles_(std::uint64_t(problem.shape.chunk_tiles)),
        depth_(std::uint64_t(problem.shape.depth)),
        column_blocks_(std::uint64_t(problem.column_blocks)),
        m_(kRows * pes_ * std::uint64_t(problem.row_blocks)),
        n_(kColumns * tiles_ * column_blocks_),
        k_(depth_ * std::uint64_t(problem.panels)) {}

  std::uint64_t m() const { return m_; }
  std::uint64_t n() const { return n_; }
  std::uint64_t k() const { return k_; }
  std::uint64_t start_elements() const { return column_blocks_ * pes_ * tiles_ * kColumns; }

  /// The first term that is added in the sums of row i. PE i / 2 computes the row and starts with the term of
  /// its own number.
  std::uint64_t first_term(std::uint64_t i) const { return i / kRows % pes_ % k_; }

  std::uint64_t a(std::uint64_t i, std::uint64_t l) const {
    const std::uint64_t term = (l + k_ - first_term(i)) % k_;
    const std::uint64_t panel = i / (kRows * pes_) * (k_ / depth_) + term / depth_;
    return ((panel * pes_ + i / kRows % pes_) * depth_ + term % depth_) * kRows + i % kRows;
  }
  std::uint64_t b_start(std::uint64_t pe, std::uint64_t j) const {
    return (j / block_columns() * pes_ + pe) * block_columns() + j % block_columns();
  }
  std::uint64_t b_stream(std::uint64_t l, std::uint64_t j) const {
    const std::uint64_t turn = (l + k_ - pes_ % k_) % k_;
    const std::uint64_t tile = j / kColumns % tiles_;
    const std::uint64_t panel = j / block_columns() * (k_ / depth_) + turn / depth_;
    const std::uint64_t chunk = panel * (tiles_ / chunk_tiles_) + tile / chunk_tiles_;
    const std::uint64_t of_feeder = (chunk * kFeeders + turn % kFeeders) * chunk_tiles_ + tile % chunk_tiles_;
    return (of_feeder * (depth_ / kFeeders) + turn % depth_ / kFeeders) * kColumns + j % kColumns;
  }
  std::uint64_t c(std::uint64_t i, std::uint64_t j) const {
    const std::uint64_t block = i / (kRows * pes_) * column_blocks_ + j / block_columns();
    const std::uint64_t tile = (block * pes_ + i / kRows % pes_) * tiles_ + j / kColumns % tiles_;
    return (tile * kRows + i % kRows) * kColumns + j % kColumns;
  }
  std::uint64_t pes() const { return pes_; }

 private:
  static constexpr std::uint64_t kRows = Dgemm::kRows;
  static constexpr std::uint64_t kColumns = Dgemm::kTileColumns;
  static constexpr std::uint64_t kFeeders = Dgemm::kFeeders;

  std::uint64_t block_columns() const { return tiles_ * kColumns; }

  std::uint64_t pes_, tiles_, chunk_tiles_, depth_, column_blocks_, m_, n_, k_;
};

double element_of_a(std::uint64_t i, std::uint64_t l) {
  return 2 * plug_in::random_of(2 * (i * 100003 + l)) - 1;
}
double element_of_b(std::uint64_t l, std::uint64_t j) {
  return 2 * plug_in::random_of(2 * (l * 100003 + j) + 1) - 1;
}

class DgemmFirmware : public plug_in::Firmware {
 public:
  DgemmFirmware(const Kernels& kernels, const Dgemm::Problem& problem, bool b_on_chip)
      : Firmware("DGEMM", "C = A B in double precision"),
        kernels_(kernels),
        tiles_{*this, "tiles", problem.shape.tiles, {1, 128}, "of 4 columns in a PE's block of C"},
        depth_{*this, "depth", problem.shape.depth, {8, 1024}, "of a panel, a multiple of 8"},
        chunk_tiles_{*this,
                     "chunk_tiles",
                     problem.shape.chunk_tiles,
                     {1, 128},
                     "tiles for which B is loaded at a time; divides tiles"},
        row_blocks_{*this, "row_blocks", problem.row_blocks, {1, 64}, "blocks of 2 rows a PE"},
        column_blocks_{*this, "column_blocks", problem.column_blocks, {1, 64}, "blocks of 4 x tiles columns"},
        panels_{*this, "panels", problem.panels, {1, 1024}, "K = panels x depth"},
        b_on_chip_{
            *this, "b_on_chip", b_on_chip ? 1 : 0, {0, 1}, "1: rows of B lie in the memory on the chip"} {}

  void prepare(int num_pes) override;
  void run(cn::Machine& machine) override { Dgemm(machine, kernels_, problem()).run(); }
  void check() const override;
  plug_in::Work work() const override {
    return {2.0 * double(blocks_->m()) * double(blocks_->n()) * double(blocks_->k()),
            "floating-point operations"};
  }

 private:
  Dgemm::Problem problem() const {
    return {{tiles_, depth_, chunk_tiles_},
            row_blocks_,
            column_blocks_,
            panels_,
            a_.mono(),
            b_start_.mono(),
            b_stream_.mono(),
            c_.mono()};
  }

  const Kernels& kernels_;
  std::optional<DgemmBlocks> blocks_;
  plug_in::Option<int> tiles_, depth_, chunk_tiles_, row_blocks_, column_blocks_, panels_, b_on_chip_;
  plug_in::MonoBuffer<double> a_{*this, "A", plug_in::Use::upload};
  plug_in::MonoBuffer<double> b_start_{*this, "first rows of B", plug_in::Use::upload};
  plug_in::MonoBuffer<double> b_stream_{*this, "B", plug_in::Use::upload};
  plug_in::MonoBuffer<double> c_{*this, "C", plug_in::Use::download};
};

/// Throws for shapes that Dgemm refuses, before their blocks are laid out.
void require_shape(int num_pes, int tiles, int depth, int chunk_tiles) {
  if (num_pes <= Dgemm::kFeeders)
    throw plug_in::OptionError("found " + std::to_string(num_pes) + " PEs, allowed are more than " +
                               std::to_string(Dgemm::kFeeders));
  if (tiles % chunk_tiles != 0)
    throw plug_in::OptionError("tiles: found " + std::to_string(tiles) +
                               ", allowed is a multiple of chunk_tiles, " + std::to_string(chunk_tiles));
  if (depth % Dgemm::kFeeders != 0)
    throw plug_in::OptionError("depth: found " + std::to_string(depth) + ", allowed is a multiple of " +
                               std::to_string(Dgemm::kFeeders));
  // In a feeder, two chunks of rows of B lie where the others have C.
  if (chunk_tiles * depth / Dgemm::kFeeders > tiles)
    throw plug_in::OptionError("chunk_tiles: found " + std::to_string(chunk_tiles) + ", with depth " +
                               std::to_string(depth) + " allowed are at most " +
                               std::to_string(tiles * Dgemm::kFeeders / depth));
}

void DgemmFirmware::prepare(int num_pes) {
  require_shape(num_pes, tiles_, depth_, chunk_tiles_);
  const DgemmBlocks& blocks = blocks_.emplace(problem(), num_pes);
  a_.resize(blocks.m() * blocks.k());
  b_start_.resize(blocks.start_elements());
  b_stream_.resize(blocks.k() * blocks.n());
  c_.resize(blocks.m() * blocks.n());
  b_stream_.put_in(b_on_chip_ != 0 ? plug_in::Memory::on_chip_sram : plug_in::Memory::ddr);
  for (std::uint64_t i = 0; i < blocks.m(); ++i)
    for (std::uint64_t l = 0; l < blocks.k(); ++l) a_[blocks.a(i, l)] = element_of_a(i, l);
  for (std::uint64_t j = 0; j < blocks.n(); ++j) {
    for (std::uint64_t pe = 0; pe < blocks.pes(); ++pe)
      b_start_[blocks.b_start(pe, j)] = element_of_b(pe % blocks.k(), j);
    for (std::uint64_t l = 0; l < blocks.k(); ++l) b_stream_[blocks.b_stream(l, j)] = element_of_b(l, j);
  }
}

void DgemmFirmware::check() const {
  const DgemmBlocks& blocks = *blocks_;
  std::vector<double> b(blocks.k() * blocks.n());
  for (std::uint64_t l = 0; l < blocks.k(); ++l)
    for (std::uint64_t j = 0; j < blocks.n(); ++j) b[l * blocks.n() + j] = element_of_b(l, j);
  std::vector<double> row(blocks.n());
  for (std::uint64_t i = 0; i < blocks.m(); ++i) {
    row.assign(row.size(), 0.0);
    for (std::uint64_t term = 0; term < blocks.k(); ++term) {
      const std::uint64_t l = (blocks.first_term(i) + term) % blocks.k();
      const double a = element_of_a(i, l);
      for (std::uint64_t j = 0; j < blocks.n(); ++j) row[j] += a * b[l * blocks.n() + j];
    }
    for (std::uint64_t j = 0; j < blocks.n(); ++j) {
      const double found = c_[blocks.c(i, j)];
      if (found != row[j])
        throw plug_in::CheckFailed("element (" + std::to_string(i) + ", " + std::to_string(j) + ") is " +
                                   std::to_string(found) + ", a plain product gives " +
                                   std::to_string(row[j]));
    }
  }
}

}  // namespace

std::unique_ptr<plug_in::Firmware> make_dgemm(const Kernels& kernels, const Dgemm::Problem& problem,
                                              bool b_on_chip) {
  return std::make_unique<DgemmFirmware>(kernels, problem, b_on_chip);
}

}  // namespace examples
