#include "testbench/sweep/sweep_plan.hpp"

#include <algorithm>

namespace testbench {
SweepPlan::SweepPlan(const Sweep& sweep, const std::vector<std::size_t>& left, bool in_full) {
  std::map<std::string, std::size_t> number_of;
  for (const std::size_t i : left) {
    const auto [entry, is_new] = number_of.emplace(sweep.points()[i].stream, streams_.size());
    if (is_new) streams_.emplace_back();
    streams_[entry->second].left.push_back(i);
  }
  for (Stream& stream : streams_)
    stream.replays =
        !in_full && stream.left.size() > 1 && can_be_replayed(sweep.points()[stream.left.front()]);
}

/// The server's own; else the one with the most points for each of those who would share it.
std::vector<SweepPlan::Stream>::iterator SweepPlan::choose(int server) {
  const auto own = stream_of_server_.find(server);
  if (own != stream_of_server_.end()) {
    Stream& stream = streams_[own->second];
    if (!stream.left.empty()) return streams_.begin() + std::ptrdiff_t(own->second);
    --stream.servers;
    stream_of_server_.erase(own);
  }
  return std::max_element(streams_.begin(), streams_.end(), [](const Stream& a, const Stream& b) {
    return a.left.size() * std::size_t(b.servers + 1) < b.left.size() * std::size_t(a.servers + 1);
  });
}

std::optional<SweepPlan::Order> SweepPlan::next(int server) {
  const auto stream = choose(server);
  if (stream == streams_.end() || stream->left.empty()) return std::nullopt;
  const auto number = std::size_t(stream - streams_.begin());
  if (stream_of_server_.emplace(server, number).second) ++stream->servers;
  const Order order{stream->left.front(), stream->replays};
  stream->left.pop_front();
  return order;
}

}  // namespace testbench
