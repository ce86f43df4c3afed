#include "firmware/cn/transfer.hpp"

#include <cstring>

namespace cn {
namespace {

std::uint64_t load_word(const std::uint8_t* from) {
  std::uint64_t word;
  std::memcpy(&word, from, sizeof(word));
  return word;
}

void store_word(std::uint8_t* to, std::uint64_t word) {
  std::memcpy(to, &word, sizeof(word));
}

/// Eight neighbouring PEs, all enabled: reads and writes whole rows of the strip.
void move_strip(Direction direction, std::uint64_t* row, std::size_t row_pitch, int words,
                std::uint8_t* const (&places)[kStripLanes]) {
  if (direction == Direction::mono_to_poly) {
    for (int w = 0; w < words; ++w, row += row_pitch)
      for (int lane = 0; lane < kStripLanes; ++lane) row[lane] = load_word(places[lane] + 8 * w);
  } else {
    for (int w = 0; w < words; ++w, row += row_pitch)
      for (int lane = 0; lane < kStripLanes; ++lane) store_word(places[lane] + 8 * w, row[lane]);
  }
}

void move_pe(Direction direction, std::uint64_t* column, std::size_t row_pitch, int words,
             std::uint8_t* place) {
  for (int w = 0; w < words; ++w, column += row_pitch) {
    if (direction == Direction::mono_to_poly) {
      *column = load_word(place + 8 * w);
    } else {
      store_word(place + 8 * w, *column);
    }
  }
}

}  // namespace

void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono) {
  const auto row_pitch = static_cast<std::size_t>(poly.num_pes());
  const int words = transfer.poly.size_bytes / 8;
  std::uint64_t* const row = poly.row(transfer.poly.offset_bytes);
  for (int first_pe = 0; first_pe < poly.num_pes(); first_pe += kStripLanes) {
    const unsigned bits = transfer.enabled.strip_bits(first_pe / kStripLanes);
    if (bits == 0) continue;
    std::uint8_t* places[kStripLanes];
    for (int lane = 0; lane < kStripLanes; ++lane) places[lane] = mono + transfer.mono[first_pe + lane];
    if (bits == 0xffu) {
      move_strip(transfer.direction, row + first_pe, row_pitch, words, places);
      continue;
    }
    for (int lane = 0; lane < kStripLanes; ++lane)
      if ((bits >> lane) & 1u)
        move_pe(transfer.direction, row + first_pe + lane, row_pitch, words, places[lane]);
  }
}

}  // namespace cn
