#include "model/hazards/mono_footprint.hpp"

#include <algorithm>

namespace model {

MonoFootprint::MonoFootprint(const cn::Transfer& transfer, int num_pes)
    : piece_bytes_(std::uint64_t(transfer.poly.size_bytes)),
      enabled_(transfer.enabled),
      num_pes_(num_pes),
      array_(transfer.mono) {
  const bool is_array = transfer.mono.by_pe == nullptr;
  bool first = true;
  for (int pe = 0; pe < num_pes; ++pe) {
    if (!enabled_[pe]) continue;
    const cn::MonoAddress start = transfer.mono[pe];
    low_ = first ? start : std::min(low_, start);
    high_ = first ? start + piece_bytes_ : std::max(high_, start + piece_bytes_);
    first = false;
    if (!is_array) starts_.push_back(start);
  }
}

MonoFootprint::MonoFootprint(const MonoRange& range)
    : piece_bytes_(range.bytes), low_(range.first), high_(range.first + range.bytes), starts_{range.first} {}

std::vector<cn::MonoAddress> MonoFootprint::ascending_starts() const {
  std::vector<cn::MonoAddress> starts = starts_;
  if (starts.empty()) {
    for (int pe = 0; pe < num_pes_; ++pe)
      if (enabled_[pe]) starts.push_back(array_[pe]);
  } else {
    std::sort(starts.begin(), starts.end());
  }
  return starts;
}

std::optional<MonoRange> MonoFootprint::overlap(const MonoFootprint& other) const {
  if (low_ >= other.high_ || other.low_ >= high_) return std::nullopt;
  const std::vector<cn::MonoAddress> mine = ascending_starts();
  const std::vector<cn::MonoAddress> theirs = other.ascending_starts();
  // Pieces of one side have one length, so the one that ends first cannot meet anything that comes later.
  for (auto a = mine.begin(), b = theirs.begin(); a != mine.end() && b != theirs.end();) {
    const cn::MonoAddress from = std::max(*a, *b);
    const cn::MonoAddress to = std::min(*a + piece_bytes_, *b + other.piece_bytes_);
    if (from < to) return MonoRange{from, to - from};
    if (*a + piece_bytes_ < *b + other.piece_bytes_) {
      ++a;
    } else {
      ++b;
    }
  }
  return std::nullopt;
}

}  // namespace model
