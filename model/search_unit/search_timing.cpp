#include "model/search_unit/search_timing.hpp"

#include <algorithm>

namespace model {

SearchTiming::SearchTiming(const ChipConfig::SearchUnit& config, Owner owner)
    : config_(config),
      owner_(std::move(owner)),
      in_flight_(std::size_t(config.units) * std::size_t(config.queries_in_flight)) {
  for (int unit = 0; unit < config.units; ++unit) {
    units_.emplace_back(config);
    for (int i = config.queries_in_flight; i-- > 0;)
      units_.back().free_places.push_back(unit * config.queries_in_flight + i);
  }
}

void SearchTiming::schedule(Cycles at, What what, int place, std::uint64_t line) {
  events_.push_back({std::max(at, now_), events_made_++, what, place, line});
  std::push_heap(events_.begin(), events_.end(), later);
}

void SearchTiming::start(int search, const std::vector<cn::SearchStep>& steps, Cycles at) {
  if (free_coming_.empty()) {
    free_coming_.push_back(static_cast<int>(coming_.size()));
    coming_.emplace_back();
  }
  const int number = free_coming_.back();
  free_coming_.pop_back();
  coming_[std::size_t(number)] = {search, steps};
  schedule(at, What::query, number);
}

void SearchTiming::arrived(int unit, cn::MonoAddress first, Cycles at) {
  schedule(at, What::line, unit, units_[std::size_t(unit)].cache.line_of(first));
}

void SearchTiming::forget_lines() {
  for (Unit& unit : units_) unit.cache.clear();
}

void SearchTiming::step() {
  std::pop_heap(events_.begin(), events_.end(), later);
  const Event event = events_.back();
  events_.pop_back();
  now_ = event.at;
  work_off(event);
  report();
}

void SearchTiming::work_off(const Event& event) {
  switch (event.what) {
    case What::query:
      queue_.push_back(std::move(coming_[std::size_t(event.place)]));
      free_coming_.push_back(event.place);
      ++statistics_.queries;
      return take_queries(now_);
    case What::line:
      return take_line(event.place, event.line, now_);
    case What::go_on:
      return go_on(event.place, now_);
    case What::test:
      return test(event.place, now_);
  }
}

void SearchTiming::report() {
  if (observer_ == nullptr) return;
  std::pair<int, int> counts{0, 0};
  for (const Unit& unit : units_) {
    counts.first += unit.in_flight;
    counts.second += unit.waiting;
  }
  if (counts == reported_) return;
  reported_ = counts;
  observer_->searching(counts.first, counts.second, now_);
}

/// The unit with the most free places takes the next query, among equals the first.
void SearchTiming::take_queries(Cycles now) {
  while (!queue_.empty()) {
    const auto unit = std::max_element(units_.begin(), units_.end(), [](const Unit& a, const Unit& b) {
      return a.free_places.size() < b.free_places.size();
    });
    if (unit->free_places.empty()) return;
    account(*unit, now);
    ++unit->in_flight;
    const int place = unit->free_places.back();
    unit->free_places.pop_back();
    in_flight_[std::size_t(place)] = {std::move(queue_.front()), 0, 0};
    queue_.pop_front();
    go_on(place, now);
  }
}

void SearchTiming::go_on(int place, Cycles now) {
  const InFlight& query = in_flight_[std::size_t(place)];
  if (query.step == query.query.steps.size()) return finish(place, now);
  look_up(place, query.query.steps[query.step], now);
}

void SearchTiming::look_up(int place, const cn::SearchStep& step, Cycles now) {
  Unit& unit = unit_of(place);
  InFlight& query = in_flight_[std::size_t(place)];
  const std::uint64_t last = unit.cache.line_of(step.from + std::uint64_t(step.bytes) - 1);
  Cycles known = now;
  for (std::uint64_t line = unit.cache.line_of(step.from); line <= last; ++line) {
    const Cycles start = std::max(now, unit.cache_free);
    unit.cache_free = start + cycles(1);
    known = start + cycles(config_.cache_hit_cycles);
    const SearchCache::Found found = unit.cache.look_up(line);
    if (found == SearchCache::Found::here) {
      ++statistics_.cache_hits;
      continue;
    }
    ++query.lines_missing;
    unit.waiting_for.push_back({line, place});
    if (found == SearchCache::Found::on_the_way) {
      ++statistics_.cache_joins;
      continue;
    }
    ++statistics_.cache_misses;
    statistics_.bytes_fetched += unit.cache.line_bytes();
    owner_.fetch(static_cast<int>(&unit - units_.data()), line * unit.cache.line_bytes(), known);
  }
  if (query.lines_missing == 0) return schedule(known, What::test, place);
  account(unit, now);
  ++unit.waiting;
}

void SearchTiming::take_line(int number, std::uint64_t line, Cycles now) {
  Unit& unit = units_[std::size_t(number)];
  unit.cache.arrived(line);
  const auto is_for = [&](const Unit::Waiting& waiting) { return waiting.line == line; };
  for (const Unit::Waiting& waiting : unit.waiting_for) {
    if (!is_for(waiting) || --in_flight_[std::size_t(waiting.place)].lines_missing > 0) continue;
    account(unit, now);
    --unit.waiting;
    schedule(now, What::test, waiting.place);
  }
  unit.waiting_for.erase(std::remove_if(unit.waiting_for.begin(), unit.waiting_for.end(), is_for),
                         unit.waiting_for.end());
}

void SearchTiming::test(int place, Cycles now) {
  Unit& unit = unit_of(place);
  InFlight& query = in_flight_[std::size_t(place)];
  const cn::SearchStep& step = query.query.steps[query.step++];
  const bool is_node = step.kind == cn::SearchStep::Kind::node;
  Cycles& free = is_node ? unit.nodes_free : unit.leaves_free;
  const Cycles turn = cycles(is_node ? 1 : config_.leaf_interval_cycles);
  const int turns = is_node ? (step.tests + config_.width - 1) / config_.width : step.tests;
  const Cycles start = std::max(now, free);
  const Cycles last = start + turn * Cycles(turns - 1);
  free = last + turn;
  ++(is_node ? statistics_.nodes : statistics_.leaves);
  (is_node ? statistics_.node_tests : statistics_.leaf_tests) += std::uint64_t(step.tests);
  (is_node ? statistics_.node_cycles : statistics_.leaf_cycles) += free - start;
  schedule(last + cycles(is_node ? config_.node_cycles : config_.leaf_cycles), What::go_on, place);
}

void SearchTiming::finish(int place, Cycles now) {
  Unit& unit = unit_of(place);
  account(unit, now);
  --unit.in_flight;
  unit.free_places.push_back(place);
  owner_.answered(in_flight_[std::size_t(place)].query.search, now);
  take_queries(now);
}

/// To be called before a unit's counts of queries change.
void SearchTiming::account(Unit& unit, Cycles now) {
  const Cycles passed = now - unit.accounted_for;
  unit.accounted_for = now;
  if (unit.in_flight > 0) statistics_.busy_cycles += passed;
  if (unit.in_flight > 0 && unit.waiting == unit.in_flight) statistics_.stalled_cycles += passed;
}

}  // namespace model
