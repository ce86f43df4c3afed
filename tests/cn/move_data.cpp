// A program of one level, tests/cn, has no choice of levels to make (select_move_data.cpp).

#include "firmware/cn/chip/transfer.hpp"

namespace cn {
namespace CN_LEVEL {
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
}

void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  CN_LEVEL::move_data(transfer, poly, mono);
}

}  // namespace cn
