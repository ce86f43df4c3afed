#pragma once

#include "firmware/cn/language/control.hpp"
#include "firmware/examples/dgemm.hpp"

namespace examples {

/// All 16 doubles of a PE's registers are in use: 8 are a tile of C, 4 a vector of B on its way along the
/// path, 4 the two rows of A for two steps. Elements of a vector operand may all be the same register.
inline void multiply_tiles(const MultiplyTilesArguments& arguments) {
  using Vector = cn::poly4<double>;
  const cn::mask computes = cn::pe_num() < cn::poly<std::int32_t>(cn::strip.num_pes - Dgemm::kFeeders);
  // Charges no instruction: on the chip, a sum begins with a multiply, which takes as long as the
  // multiply-add.
  const Vector zero(0.0, 0.0, 0.0, 0.0);
  for (int tile = 0; tile < arguments.tiles; ++tile) {
    const int place = arguments.first_tile + tile;
    const cn::VectorStream<double> b(arguments.b_in_place, place * Dgemm::kTileColumns, arguments.b_fed,
                                     tile * arguments.depth / Dgemm::kFeeders * Dgemm::kTileColumns,
                                     Dgemm::kFeeders);
    const auto of_c = [&](int row) {
      return cn::four_from((place * Dgemm::kRows + row) * Dgemm::kTileColumns);
    };
    Vector sum[Dgemm::kRows];
    for (int row = 0; row < Dgemm::kRows; ++row)
      sum[row].assign_all_lanes(arguments.first ? zero : arguments.c.load(of_c(row)));
    for (int k = 0; k < arguments.depth; k += 2) {
      const Vector a = arguments.a.load(cn::four_from(k * Dgemm::kRows));
      if (k % Dgemm::kFeeders == 0) b.feed();
      for (int step = 0; step < 2; ++step) {
        const Vector row_of_b = b.after(k + step);
        for (int row = 0; row < Dgemm::kRows; ++row) {
          const cn::poly<double>& factor = a[step * Dgemm::kRows + row];
          const Vector factors(factor, factor, factor, factor);
          sum[row].assign_all_lanes(multiply_add(row_of_b, factors, sum[row]));
        }
      }
    }
    const Vector next_row_of_b = b.after(arguments.depth);
    cn::poly_if(computes, [&] {
      for (int row = 0; row < Dgemm::kRows; ++row) arguments.c.store(of_c(row), sum[row]);
      arguments.b_in_place.store(cn::four_from(place * Dgemm::kTileColumns), next_row_of_b);
    });
  }
}

}  // namespace examples
