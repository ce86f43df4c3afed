#include "testbench/validation/example_runs.hpp"

#include <cmath>
#include <complex>
#include <cstring>
#include <memory>

#include "firmware/examples/fft.hpp"
#include "testbench/system/counter_random.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using examples::Dgemm;

constexpr double kPi = 3.14159265358979323846;

/// A pseudo-random number in [-1, 1) that depends only on its index.
double pseudo_random(std::uint64_t index) {
  return 2 * random_of(index) - 1;
}

template <class T>
T read(const std::uint8_t* mono, cn::MonoPointer<T> from, std::uint64_t index) {
  T value;
  std::memcpy(&value, mono + (from + index).address, sizeof(value));
  return value;
}

template <class T>
void write(std::vector<std::uint8_t>& mono, cn::MonoPointer<T> to, std::uint64_t index, const T& value) {
  std::memcpy(mono.data() + (to + index).address, &value, sizeof(value));
}

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
  return pseudo_random(2 * (i * 100003 + l));
}
double element_of_b(std::uint64_t l, std::uint64_t j) {
  return pseudo_random(2 * (l * 100003 + j) + 1);
}

void check_product(const DgemmBlocks& blocks, cn::MonoPointer<double> c, const std::uint8_t* mono) {
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
      const double found = read(mono, c, blocks.c(i, j));
      if (found != row[j])
        throw RunError("DGEMM: element (" + std::to_string(i) + ", " + std::to_string(j) + ") is " +
                       std::to_string(found) + ", a plain product gives " + std::to_string(row[j]));
    }
  }
}

/// Writes A and B in the layout that the firmware expects, to `mono` but for the rows of B that travel.
void write_factors(std::vector<std::uint8_t>& mono, std::vector<std::uint8_t>& travelling,
                   cn::MonoPointer<double> first_travelling, const Dgemm::Problem& problem,
                   const DgemmBlocks& blocks) {
  for (std::uint64_t i = 0; i < blocks.m(); ++i)
    for (std::uint64_t l = 0; l < blocks.k(); ++l) write(mono, problem.a, blocks.a(i, l), element_of_a(i, l));
  for (std::uint64_t j = 0; j < blocks.n(); ++j) {
    for (std::uint64_t pe = 0; pe < blocks.pes(); ++pe)
      write(mono, problem.b_start, blocks.b_start(pe, j), element_of_b(pe % blocks.k(), j));
    for (std::uint64_t l = 0; l < blocks.k(); ++l)
      write(travelling, first_travelling, blocks.b_stream(l, j), element_of_b(l, j));
  }
}

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// Mean and standard deviation of the payoff at maturity, by Black and Scholes (1973) and the second moment
/// of a truncated log-normal distribution.
struct Payoff {
  double mean;
  double deviation;
};

Payoff expected_payoff(const examples::MonteCarlo::Option& option) {
  const double diffusion = option.volatility * std::sqrt(option.maturity_years);
  const double growth = std::exp(option.rate * option.maturity_years);
  const double d2 =
      (std::log(option.spot / option.strike) + option.rate * option.maturity_years) / diffusion -
      diffusion / 2;
  const double forward = option.spot * growth;
  const double mean = forward * normal_cdf(d2 + diffusion) - option.strike * normal_cdf(d2);
  const double square = forward * forward * std::exp(diffusion * diffusion) * normal_cdf(d2 + 2 * diffusion) -
                        2 * option.strike * forward * normal_cdf(d2 + diffusion) +
                        option.strike * option.strike * normal_cdf(d2);
  return {mean, std::sqrt(square - mean * mean)};
}

examples::Complex pixel(std::uint64_t image, std::uint64_t y, std::uint64_t x) {
  const std::uint64_t index = 2 * ((image * examples::kFftSize + y) * examples::kFftSize + x);
  return {float(pseudo_random(index)), float(pseudo_random(index + 1))};
}

class FftCheck {
 public:
  FftCheck() {
    for (std::size_t k = 0; k < root_.size(); ++k)
      root_[k] = std::polar(1.0, -2 * kPi * double(k) / examples::kFftSize);
  }

  void image(std::uint64_t image, const std::uint8_t* mono, cn::MonoPointer<examples::Complex> result) const {
    check_energy(image, mono, result);
    for (std::uint64_t i = 0; i < kOutputs; ++i) {
      const std::uint64_t u = (i * 197 + image * 31 + 3) % kSize;
      const std::uint64_t v = (i * 331 + image * 17 + 5) % kSize;
      const std::complex<double> expected = output(image, u, v);
      const std::complex<double> found = to_double(read(mono, result, (image * kSize + v) * kSize + u));
      if (!(std::abs(found - expected) <= kTolerance))
        throw RunError("FFT: output (" + std::to_string(u) + ", " + std::to_string(v) + ") of image " +
                       std::to_string(image) + " is off by " + std::to_string(std::abs(found - expected)));
    }
  }

 private:
  static constexpr std::uint64_t kSize = examples::kFftSize;
  static constexpr std::uint64_t kOutputs = 24;
  /// Outputs have a magnitude of about 400; rounding in 18 stages of single precision leaves a relative error
  /// of 1e-6.
  static constexpr double kTolerance = 5e-3;

  static std::complex<double> to_double(const examples::Complex& a) { return {a.real, a.imaginary}; }

  std::complex<double> output(std::uint64_t image, std::uint64_t u, std::uint64_t v) const {
    std::complex<double> sum = 0;
    for (std::uint64_t y = 0; y < kSize; ++y)
      for (std::uint64_t x = 0; x < kSize; ++x)
        sum += to_double(pixel(image, y, x)) * root_[(u * y + v * x) % kSize];
    return sum;
  }

  void check_energy(std::uint64_t image, const std::uint8_t* mono,
                    cn::MonoPointer<examples::Complex> result) const {
    double before = 0;
    double after = 0;
    for (std::uint64_t i = 0; i < kSize * kSize; ++i) {
      before += std::norm(to_double(pixel(image, i / kSize, i % kSize)));
      after += std::norm(to_double(read(mono, result, image * kSize * kSize + i)));
    }
    const double ratio = after / (before * double(kSize * kSize));
    if (!(std::abs(ratio - 1) <= 1e-6))
      throw RunError("FFT: energy of image " + std::to_string(image) + " changed by a factor of " +
                     std::to_string(ratio));
  }

  std::array<std::complex<double>, kSize> root_;
};

}  // namespace

ExampleRun dgemm_run(Dgemm::Problem problem, int num_pes, cn::Level level, const cn::MonoRange& scratchpad) {
  const DgemmBlocks blocks(problem, num_pes);
  problem.a = {0};
  problem.b_start = problem.a + blocks.m() * blocks.k();
  problem.b_stream = problem.b_start + blocks.start_elements();
  problem.c = problem.b_stream + blocks.k() * blocks.n();
  ExampleRun run;
  run.mono.resize((problem.c + blocks.m() * blocks.n()).address);
  if (scratchpad.bytes == 0) {
    write_factors(run.mono, run.mono, problem.b_stream, problem, blocks);
  } else {
    run.scratchpad.resize(blocks.k() * blocks.n() * sizeof(double));
    if (run.scratchpad.size() > scratchpad.bytes)
      throw InputError("DGEMM needs " + std::to_string(run.scratchpad.size()) +
                       " bytes on the chip, on_chip_sram.size_bytes allows " +
                       std::to_string(scratchpad.bytes));
    write_factors(run.mono, run.scratchpad, {0}, problem, blocks);
    problem.b_stream = {scratchpad.first};
  }
  run.firmware = [problem, level](cn::Machine& machine) {
    Dgemm(machine, examples::kernels(level), problem).run();
  };
  run.check = [blocks, c = problem.c](const std::uint8_t* mono) { check_product(blocks, c, mono); };
  run.work = 2.0 * double(blocks.m()) * double(blocks.n()) * double(blocks.k());
  return run;
}

ExampleRun monte_carlo_run(examples::MonteCarlo::Problem problem, int num_pes, cn::Level level) {
  problem.sums = {0};
  ExampleRun run;
  run.mono.resize(std::size_t(num_pes) * sizeof(double));
  run.work = 2.0 * problem.pairs_per_kernel * problem.kernels * num_pes;
  run.firmware = [problem, level](cn::Machine& machine) {
    examples::MonteCarlo(machine, examples::kernels(level), problem).run();
  };
  run.check = [problem, num_pes, samples = run.work](const std::uint8_t* mono) {
    double sum = 0;
    for (int pe = 0; pe < num_pes; ++pe) sum += read(mono, problem.sums, std::uint64_t(pe));
    const Payoff expected = expected_payoff(problem.option);
    const double error = sum / samples - expected.mean;
    if (!(std::abs(error) <= 5 * expected.deviation / std::sqrt(samples)))
      throw RunError("Monte Carlo: mean payoff " + std::to_string(sum / samples) + ", Black-Scholes gives " +
                     std::to_string(expected.mean) + " +- " +
                     std::to_string(expected.deviation / std::sqrt(samples)));
  };
  return run;
}

ExampleRun fft_run(int images, cn::Level level) {
  const std::uint64_t pixels = std::uint64_t(images) * examples::kFftSize * examples::kFftSize;
  examples::Fft::Layout layout;
  layout.count = images;
  layout.tiles = layout.images + pixels;
  layout.results = layout.tiles + pixels;
  layout.twiddles = layout.results + pixels;
  ExampleRun run;
  run.mono.resize((layout.twiddles + examples::kComplexPerPe).address);
  for (std::uint64_t i = 0; i < pixels; ++i)
    write(run.mono, layout.images, i, pixel(0, i / examples::kFftSize, i % examples::kFftSize));
  for (std::uint64_t k = 0; k < examples::kComplexPerPe; ++k) {
    const std::complex<double> root = std::polar(1.0, -2 * kPi * double(k) / examples::kFftSize);
    write(run.mono, layout.twiddles, k, examples::Complex{float(root.real()), float(root.imag())});
  }
  run.firmware = [layout, level](cn::Machine& machine) {
    examples::Fft(machine, examples::kernels(level), layout).run();
  };
  run.check = [layout](const std::uint8_t* mono) {
    const FftCheck check;
    for (int image = 0; image < layout.count; ++image)
      check.image(std::uint64_t(image), mono, layout.results);
  };
  const double size = double(examples::kFftSize) * examples::kFftSize;
  run.work = images * 5 * size * std::log2(size);
  return run;
}

}  // namespace testbench
