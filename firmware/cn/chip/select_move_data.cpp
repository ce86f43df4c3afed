#include "firmware/cn/chip/transfer.hpp"
#include "firmware/cn/simd/level.hpp"

namespace cn {

namespace level_x86_64_v2 {
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
}
namespace level_x86_64_v3 {
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
}
namespace level_x86_64_v4 {
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);
}

namespace {

auto* move_data_at(Level level) {
  return at_level(level, [](auto built) {
    if constexpr (built == Level::x86_64_v4) return level_x86_64_v4::move_data;
    if constexpr (built == Level::x86_64_v3) return level_x86_64_v3::move_data;
    if constexpr (built == Level::x86_64_v2) return level_x86_64_v2::move_data;
  });
}

}  // namespace

/// A copy is a copy: unlike the kernels', its level need not be chosen by the user.
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  static const auto move = move_data_at(widest_level());
  move(transfer, poly, mono);
}

}  // namespace cn
