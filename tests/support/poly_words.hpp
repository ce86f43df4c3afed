#pragma once

#include <cstdint>
#include <vector>

#include "firmware/cn/chip/poly_memory.hpp"

namespace test_support {

/// The words of all SRAMs, with word w of PE p at [w * num_pes + p], whatever the layout of PolyMemory.
/// @param bytes_per_pe as given to the memory's constructor
inline std::vector<std::uint64_t> poly_words(const cn::PolyMemory& memory, int bytes_per_pe) {
  std::vector<std::uint64_t> words;
  for (int offset_bytes = 0; offset_bytes < bytes_per_pe; offset_bytes += 8)
    for (int pe = 0; pe < memory.num_pes(); ++pe) words.push_back(memory.word(pe, offset_bytes));
  return words;
}

}  // namespace test_support
