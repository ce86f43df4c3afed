#include "testbench/plug_in/buffer_places.hpp"

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using plug_in::MonoBufferBase;

/// Buffers start on a multiple of this, so that a PE's pieces are aligned if the firmware's sizes are.
constexpr std::uint64_t kBufferAlignment = 256;

/// Addresses of one memory, given to one buffer after the other.
class Places {
 public:
  Places(cn::MonoRange range, const char* size_key) : range_(range), size_key_(size_key) {}

  void place(MonoBufferBase& buffer) {
    const std::uint64_t first = (end_ + kBufferAlignment - 1) / kBufferAlignment * kBufferAlignment;
    buffer.place_at(range_.first + first);
    end_ = first + buffer.size_bytes();
  }
  std::uint64_t bytes(const plug_in::Firmware& firmware) const {
    if (end_ > range_.bytes)
      throw InputError(firmware.name() + ": buffers need " + std::to_string(end_) +
                       " bytes of mono memory, " + size_key_ + " allows " + std::to_string(range_.bytes));
    return end_;
  }

 private:
  cn::MonoRange range_;
  const char* size_key_;
  std::uint64_t end_ = 0;
};

}  // namespace

BufferBytes place_buffers(const plug_in::Firmware& firmware, std::uint64_t ddr_bytes,
                          const cn::MonoRange& on_chip_sram) {
  Places in_ddr({0, ddr_bytes}, "ddr.size_bytes");
  Places on_chip(on_chip_sram, "on_chip_sram.size_bytes");
  for (MonoBufferBase* const buffer : firmware.buffers())
    (buffer->memory() == plug_in::Memory::ddr ? in_ddr : on_chip).place(*buffer);
  return {in_ddr.bytes(firmware), on_chip.bytes(firmware)};
}

}  // namespace testbench
