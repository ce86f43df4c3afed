#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "firmware/cn/chip/search_unit.hpp"

namespace cn {

/// The buffer of a search unit as its readers and writers see it, without time: queries are written, and an
/// answer is found when it is first asked for.
class SearchBuffer {
 public:
  /// Entries [first, last).
  struct Entries {
    int first = 0;
    int last = 0;
  };

  explicit SearchBuffer(const MonoRange& range) : range_(range), bytes_(range.bytes) {}

  /// From now on queries are those of `function`; the buffer has none.
  void program(std::shared_ptr<SearchFunction> function);

  /// Within the buffer; addresses count from its start.
  void write(std::uint64_t address, const std::uint8_t* from, std::uint64_t bytes);
  void read(std::uint64_t address, std::uint8_t* to, std::uint64_t bytes, const SearchFunction::Read& mono);

  std::uint64_t bytes() const { return bytes_.size(); }
  int entries() const { return places_.entries; }
  /// The queries whose last byte is among these.
  Entries queries_ended_in(std::uint64_t address, std::uint64_t bytes) const;
  /// Where an entry's query ends.
  std::uint64_t end_of_query(int entry) const {
    return std::uint64_t(entry + 1) * std::uint64_t(function_->query_bytes());
  }
  /// The entries of which these bytes hold parts of answers.
  Entries answers_in(std::uint64_t address, std::uint64_t bytes) const;
  /// The steps that the answer to an entry's query takes.
  const std::vector<SearchStep>& steps(int entry, const SearchFunction::Read& mono);

 private:
  enum class State : std::uint8_t { empty, asked, answered };
  struct Array {
    std::uint64_t first = 0;
    int record_bytes = 0;
  };
  Entries entries_in(const Array& array, std::uint64_t address, std::uint64_t bytes) const;
  /// Answers queries from `entry` on, as many at a time as are asked for side by side.
  void answer_from(int entry, const SearchFunction::Read& mono);

  MonoRange range_;
  std::vector<std::uint8_t> bytes_;
  std::shared_ptr<SearchFunction> function_;
  SearchPlaces places_;
  std::vector<Array> answers_;
  std::vector<State> states_;
  std::vector<std::vector<SearchStep>> steps_;
};

}  // namespace cn
