#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "firmware/cn/chip/mono_range.hpp"

/// A fixed-function unit beside the PE array that answers queries by walking through a structure in mono
/// memory, as the ray units of the RPU do (Woop, Schmittler, Slusallek, "RPU: A Programmable Ray Processing
/// Unit for Realtime Ray Tracing", SIGGRAPH 2005). Firmware says what is searched and what comes out to the
/// bit; the chip says what each step costs.
namespace cn {

/// A step of a search: a piece of mono memory is fetched, then tested.
struct SearchStep {
  enum class Kind : std::uint8_t {
    node,  ///< where the search goes on: boxes
    leaf,  ///< what is searched for: triangles
  };
  Kind kind = Kind::node;
  int tests = 0;  ///< boxes or triangles in the piece
  MonoAddress from = 0;
  int bytes = 0;
};

/// What a search unit does to a query. It stands for the unit's datapath, and for the registers that point it
/// to the structure.
class SearchFunction {
 public:
  /// Copies bytes of mono memory.
  using Read = std::function<void(MonoAddress from, void* to, std::size_t bytes)>;
  struct Query {
    const std::uint8_t* query = nullptr;
    std::vector<std::uint8_t*> answers;        ///< as answer_bytes() says
    std::vector<SearchStep>* steps = nullptr;  ///< filled, in order
  };

  SearchFunction() = default;
  virtual ~SearchFunction() = default;
  SearchFunction(const SearchFunction&) = delete;
  SearchFunction& operator=(const SearchFunction&) = delete;

  /// Bytes of a query, and of each part of its answer: multiples of 8.
  virtual int query_bytes() const = 0;
  virtual std::vector<int> answer_bytes() const = 0;
  virtual void answer(const Read& mono, const std::vector<Query>& queries) = 0;
};

/// Arrays of a search unit's buffer, one entry for each query that it holds: the queries, then each part of
/// the answers.
struct SearchPlaces {
  int entries = 0;
  MonoAddress queries = 0;
  std::vector<MonoAddress> answers;
};

/// Divides the buffer among as many entries as fit, arrays aligned to packets of the network.
inline SearchPlaces search_places(const MonoRange& buffer, int query_bytes,
                                  const std::vector<int>& answer_bytes) {
  constexpr std::uint64_t kAlignment = 64;
  auto entry_bytes = std::uint64_t(query_bytes);
  for (const int bytes : answer_bytes) entry_bytes += std::uint64_t(bytes);
  const std::uint64_t gaps = kAlignment * answer_bytes.size();
  SearchPlaces places;
  places.entries = buffer.bytes > gaps ? static_cast<int>((buffer.bytes - gaps) / entry_bytes) : 0;
  places.queries = buffer.first;
  MonoAddress next = buffer.first;
  int bytes_before = query_bytes;
  for (const int bytes : answer_bytes) {
    next += std::uint64_t(places.entries) * std::uint64_t(bytes_before);
    next = (next + kAlignment - 1) / kAlignment * kAlignment;
    places.answers.push_back(next);
    bytes_before = bytes;
  }
  return places;
}

}  // namespace cn
