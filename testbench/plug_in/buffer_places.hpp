#pragma once

#include <cstdint>

#include "firmware/plug_in/firmware.hpp"

namespace testbench {

/// How far into each memory the buffers reach.
struct BufferBytes {
  std::uint64_t ddr = 0;
  std::uint64_t on_chip_sram = 0;
};

/// Places the buffers of a prepared firmware one behind the other, each in the memory that it asks for.
/// Throws InputError for buffers that do not fit.
BufferBytes place_buffers(const plug_in::Firmware& firmware, std::uint64_t ddr_bytes,
                          const cn::MonoRange& on_chip_sram);

}  // namespace testbench
