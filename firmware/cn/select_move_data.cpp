#include "firmware/cn/transfer.hpp"

namespace cn {

void move_data_kernels_x86_64_v2(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
void move_data_kernels_x86_64_v3(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
void move_data_kernels_x86_64_v4(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);

namespace {

auto widest_move_data() {
  if (__builtin_cpu_supports("x86-64-v4")) return &move_data_kernels_x86_64_v4;
  if (__builtin_cpu_supports("x86-64-v3")) return &move_data_kernels_x86_64_v3;
  return &move_data_kernels_x86_64_v2;
}

}  // namespace

/// A copy is a copy: unlike the kernels', its level need not be chosen by the user.
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  static const auto move = widest_move_data();
  move(transfer, poly, mono);
}

}  // namespace cn
