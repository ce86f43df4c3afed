#include "testbench/system/nearest_name.hpp"

#include <algorithm>
#include <numeric>

namespace testbench {
namespace {

/// Letters to insert, remove, replace or swap with their neighbour until one text is the other (optimal
/// string alignment, after Damerau 1964).
int edit_distance(const std::string& from, const std::string& to) {
  const std::size_t width = to.size() + 1;
  std::vector<int> distance((from.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> int& { return distance[i * width + j]; };
  for (std::size_t i = 0; i <= from.size(); ++i) at(i, 0) = int(i);
  for (std::size_t j = 0; j <= to.size(); ++j) at(0, j) = int(j);
  for (std::size_t i = 1; i <= from.size(); ++i)
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const bool replaced = from[i - 1] != to[j - 1];
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, at(i - 1, j - 1) + int(replaced)});
      const bool swapped = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
      if (swapped) at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  return at(from.size(), to.size());
}

int common_beginning(const std::string& a, const std::string& b) {
  const std::size_t most = std::min(a.size(), b.size());
  const auto end = std::mismatch(a.begin(), a.begin() + std::ptrdiff_t(most), b.begin()).first;
  return static_cast<int>(end - a.begin());
}

}  // namespace

std::string nearest_name(const std::string& word, const std::vector<std::string>& names) {
  // Nobody misspells a whole name: beyond this length, `word` is none.
  constexpr std::size_t kMostLetters = 100;
  if (word.size() > kMostLetters) return "";
  std::string nearest;
  int least = 0;
  for (const std::string& name : names) {
    const int distance = edit_distance(word, name);
    if (distance >= static_cast<int>(std::max(word.size(), name.size()))) continue;
    // A beginning in common says more than as many letters elsewhere.
    const int score = distance - common_beginning(word, name);
    if (nearest.empty() || score < least) {
      nearest = name;
      least = score;
    }
  }
  return nearest;
}

}  // namespace testbench
