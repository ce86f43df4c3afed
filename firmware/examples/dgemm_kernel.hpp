#pragma once

#include "firmware/examples/kernels.hpp"

namespace examples {

/// Registers of a PE hold 16 doubles: 12 are a tile of C of 4 rows and 3 columns, 4 a piece of a column of A.
/// B is mono: each of its elements is broadcast to all PEs as an operand. A tile's multiply-add comes back to
/// the same sums after 12 cycles, later than the 8 of multiplier and adder together.
inline void multiply_block(const MultiplyBlockArguments& arguments) {
  using Vector = cn::poly4<double>;
  constexpr int kTileColumns = 3;
  for (int column = 0; column < arguments.columns; column += kTileColumns) {
    for (int row = 0; row < arguments.rows; row += 4) {
      const auto place = [&](int j) { return cn::four_from((column + j) * arguments.rows + row); };
      const auto a = [&](int k) { return arguments.a.load(cn::four_from(k * arguments.rows + row)); };
      const auto b = [&](int k, int j) { return arguments.b[k * arguments.columns + column + j]; };
      Vector sum[kTileColumns];
      if (arguments.first) {
        const Vector column_of_a = a(0);
        for (int j = 0; j < kTileColumns; ++j) sum[j].become(column_of_a * b(0, j));
      } else {
        for (int j = 0; j < kTileColumns; ++j) sum[j].become(arguments.c.load(place(j)));
      }
      for (int k = arguments.first ? 1 : 0; k < arguments.depth; ++k) {
        const Vector column_of_a = a(k);
        for (int j = 0; j < kTileColumns; ++j) sum[j].become(multiply_add(column_of_a, b(k, j), sum[j]));
      }
      for (int j = 0; j < kTileColumns; ++j) arguments.c.store(place(j), sum[j]);
    }
  }
}

}  // namespace examples
