#include "firmware/cn/chip/transfer.hpp"
#include "firmware/cn/simd/level.hpp"

namespace cn {

void move_data_kernels_x86_64_v2(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
void move_data_kernels_x86_64_v3(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
void move_data_kernels_x86_64_v4(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);

namespace {

auto* move_data_at(Level level) {
  return at_level(level, [](auto built) {
    if constexpr (built == Level::x86_64_v4) return move_data_kernels_x86_64_v4;
    if constexpr (built == Level::x86_64_v3) return move_data_kernels_x86_64_v3;
    if constexpr (built == Level::x86_64_v2) return move_data_kernels_x86_64_v2;
  });
}

}  // namespace

/// A copy is a copy: unlike the kernels', its level need not be chosen by the user.
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  static const auto move = move_data_at(widest_level());
  move(transfer, poly, mono);
}

}  // namespace cn
