#include "model/pio/word_history.hpp"

#include <algorithm>

namespace model {

void WordHistory::add(Cycles first, Cycles last, std::uint64_t words) {
  recent_[added_++ & (recent_.size() - 1)] = {first, last, words, total_words_};
  total_words_ += words;
}

std::uint64_t WordHistory::before(Cycles cycle) const {
  std::uint64_t words = 0;
  const std::size_t oldest = added_ - std::min(added_, recent_.size());
  for (std::size_t i = added_; i-- > oldest;) {
    const Request& request = recent_[i & (recent_.size() - 1)];
    if (cycle >= request.last) return request.words_before + request.words;
    if (cycle > request.first)
      return request.words_before + request.words * (cycle - request.first) / (request.last - request.first);
    words = request.words_before;
  }
  return words;
}

}  // namespace model
