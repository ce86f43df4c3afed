#include "firmware/cn/chip/transfer.hpp"
#include "firmware/cn/simd/level.hpp"

namespace cn {

void move_data_kernels_x86_64_v2(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
void move_data_kernels_x86_64_v3(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
void move_data_kernels_x86_64_v4(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);

/// A copy is a copy: unlike the kernels', its level need not be chosen by the user.
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  static const auto move = at_level(widest_level(), move_data_kernels_x86_64_v2, move_data_kernels_x86_64_v3,
                                    move_data_kernels_x86_64_v4);
  move(transfer, poly, mono);
}

}  // namespace cn
