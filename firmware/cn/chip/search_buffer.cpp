#include "firmware/cn/chip/search_buffer.hpp"

#include <algorithm>
#include <cstring>

namespace cn {
namespace {

/// A function works on the queries of a vector of the simulator at a time.
constexpr int kQueriesAtATime = 8;

}  // namespace

void SearchBuffer::program(std::shared_ptr<SearchFunction> function) {
  function_ = std::move(function);
  const std::vector<int> answer_bytes = function_->answer_bytes();
  places_ = search_places(range_, function_->query_bytes(), answer_bytes);
  answers_.clear();
  for (std::size_t i = 0; i < answer_bytes.size(); ++i)
    answers_.push_back({places_.answers[i] - range_.first, answer_bytes[i]});
  states_.assign(std::size_t(places_.entries), State::empty);
  steps_.assign(std::size_t(places_.entries), {});
}

void SearchBuffer::write(std::uint64_t address, const std::uint8_t* from, std::uint64_t bytes) {
  const bool is_new = std::memcmp(bytes_.data() + address, from, bytes) != 0;
  if (is_new) std::memcpy(bytes_.data() + address, from, bytes);
  if (!function_) return;
  const Entries touched = entries_in({0, function_->query_bytes()}, address, bytes);
  const Entries ended = queries_ended_in(address, bytes);
  for (int entry = touched.first; entry < touched.last; ++entry) {
    State& state = states_[std::size_t(entry)];
    const bool is_ended = entry >= ended.first && entry < ended.last;
    if (is_new || (is_ended && state == State::empty)) state = is_ended ? State::asked : State::empty;
  }
}

void SearchBuffer::read(std::uint64_t address, std::uint8_t* to, std::uint64_t bytes,
                        const SearchFunction::Read& mono) {
  const Entries entries = answers_in(address, bytes);
  for (int entry = entries.first; entry < entries.last; ++entry)
    if (states_[std::size_t(entry)] == State::asked) answer_from(entry, mono);
  std::memcpy(to, bytes_.data() + address, bytes);
}

SearchBuffer::Entries SearchBuffer::entries_in(const Array& array, std::uint64_t address,
                                               std::uint64_t bytes) const {
  const auto record_bytes = std::uint64_t(array.record_bytes);
  const std::uint64_t last = array.first + std::uint64_t(places_.entries) * record_bytes;
  const std::uint64_t begin = std::clamp(address, array.first, last);
  const std::uint64_t end = std::clamp(address + bytes, array.first, last);
  if (begin >= end) return {};
  return {static_cast<int>((begin - array.first) / record_bytes),
          static_cast<int>((end - array.first + record_bytes - 1) / record_bytes)};
}

SearchBuffer::Entries SearchBuffer::queries_ended_in(std::uint64_t address, std::uint64_t bytes) const {
  if (!function_) return {};
  const auto query_bytes = std::uint64_t(function_->query_bytes());
  const auto before = [&](std::uint64_t end) {
    return static_cast<int>(std::min(end / query_bytes, std::uint64_t(places_.entries)));
  };
  return {before(address), before(address + bytes)};
}

SearchBuffer::Entries SearchBuffer::answers_in(std::uint64_t address, std::uint64_t bytes) const {
  for (const Array& array : answers_) {
    const Entries entries = entries_in(array, address, bytes);
    if (entries.first < entries.last) return entries;
  }
  return {};
}

const std::vector<SearchStep>& SearchBuffer::steps(int entry, const SearchFunction::Read& mono) {
  if (states_[std::size_t(entry)] == State::asked) answer_from(entry, mono);
  return steps_[std::size_t(entry)];
}

void SearchBuffer::answer_from(int entry, const SearchFunction::Read& mono) {
  std::vector<SearchFunction::Query> queries;
  for (int i = entry; i < std::min(entry + kQueriesAtATime, places_.entries); ++i) {
    if (states_[std::size_t(i)] != State::asked) continue;
    SearchFunction::Query query;
    query.query = bytes_.data() + std::uint64_t(i) * std::uint64_t(function_->query_bytes());
    for (const Array& array : answers_)
      query.answers.push_back(bytes_.data() + array.first +
                              std::uint64_t(i) * std::uint64_t(array.record_bytes));
    query.steps = &steps_[std::size_t(i)];
    queries.push_back(std::move(query));
    states_[std::size_t(i)] = State::answered;
  }
  function_->answer(mono, queries);
}

}  // namespace cn
