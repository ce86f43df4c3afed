#include "model/waves/wave_recorder.hpp"

#include <algorithm>

namespace model {
namespace {

/// Changes that are written already leave a stream in batches of this many.
constexpr std::size_t kKeptChanges = 512;

std::vector<VcdWriter::Signal> vcd_signals(const std::vector<WaveRecorder::Signal>& signals) {
  std::vector<VcdWriter::Signal> vcd;
  for (const WaveRecorder::Signal& signal : signals) vcd.push_back(signal.vcd);
  return vcd;
}

}  // namespace

WaveRecorder::WaveRecorder(TextSink sink, const std::vector<Signal>& signals, const ClockDomain& clock,
                           std::size_t streams)
    : clock_(clock), writer_(std::move(sink), vcd_signals(signals)), streams_(streams) {
  for (const Signal& signal : signals) {
    rules_.push_back(signal.rule);
    values_.push_back(signal.initial);
  }
}

void WaveRecorder::add_window(const CycleWindow& window) {
  add_edge(window.first, +1);
  add_edge(window.last, -1);
}

void WaveRecorder::add_edge(Cycles cycle, int step) {
  const auto later = [](const Edge& a, const Edge& b) { return a.cycle > b.cycle; };
  const Edge edge{std::max(cycle, written_until_), step};
  edges_.insert(std::lower_bound(edges_.begin(), edges_.end(), edge, later), edge);
}

bool WaveRecorder::covers(Cycles cycle) const {
  int open = open_windows_;
  for (const Edge& edge : edges_)
    if (edge.cycle <= cycle) open += edge.step;
  return open > 0;
}

void WaveRecorder::change(std::size_t stream, Cycles cycle, std::size_t signal, std::uint64_t value) {
  if (cycle < written_until_) {
    if (recording_) ++late_changes_;
    cycle = written_until_;
  }
  Stream& to = streams_[stream];
  to.changes.push_back({cycle, value, signal});
  for (std::size_t i = to.changes.size() - 1; i > to.head && to.changes[i - 1].cycle > cycle; --i)
    std::swap(to.changes[i - 1], to.changes[i]);
  to.next = to.changes[to.head].cycle;
}

void WaveRecorder::advance_to(Cycles end) {
  for (Cycles cycle = next_cycle(); cycle < end; cycle = next_cycle()) {
    for (Stream& stream : streams_)
      if (stream.next == cycle) take(stream, cycle);
    const bool was_recording = recording_;
    pass_edges(cycle);
    write(cycle, was_recording);
  }
  written_until_ = std::max(written_until_, end);
}

Cycles WaveRecorder::next_cycle() const {
  Cycles next = edges_.empty() ? kNever : edges_.back().cycle;
  for (const Stream& stream : streams_) next = std::min(next, stream.next);
  return next;
}

void WaveRecorder::take(Stream& stream, Cycles cycle) {
  const std::size_t count = stream.changes.size();
  for (; stream.head < count && stream.changes[stream.head].cycle == cycle; ++stream.head)
    apply(stream.changes[stream.head]);
  if (stream.head < count) {
    if (stream.head >= kKeptChanges) {
      stream.changes.erase(stream.changes.begin(), stream.changes.begin() + std::ptrdiff_t(stream.head));
      stream.head = 0;
    }
    stream.next = stream.changes[stream.head].cycle;
  } else {
    stream.changes.clear();
    stream.head = 0;
    stream.next = kNever;
  }
}

void WaveRecorder::apply(const Change& change) {
  std::uint64_t& value = values_[change.signal];
  switch (rules_[change.signal]) {
    case Rule::assign:
      value = change.value;
      break;
    case Rule::maximum:
      value = std::max(value, change.value);
      break;
    case Rule::set_or_clear: {
      const std::uint64_t bit = std::uint64_t{1} << (change.value / 2);
      value = change.value % 2 == 1 ? value | bit : value & ~bit;
      break;
    }
  }
  changed_.push_back(change.signal);
}

void WaveRecorder::pass_edges(Cycles cycle) {
  for (; !edges_.empty() && edges_.back().cycle == cycle; edges_.pop_back())
    open_windows_ += edges_.back().step;
  recording_ = open_windows_ > 0;
}

void WaveRecorder::write(Cycles cycle, bool was_recording) {
  if (recording_ && !was_recording) {
    if (recorded_) writer_.pause(picoseconds(last_recorded_));
    if (!recorded_) first_recorded_ = cycle;
    recorded_ = true;
    writer_.record(picoseconds(cycle), values_);
    written_ = values_;
  } else if (recording_) {
    bool timed = false;
    for (const std::size_t signal : changed_) {
      if (values_[signal] == written_[signal]) continue;
      if (!timed) writer_.time(picoseconds(cycle));
      timed = true;
      writer_.change(signal, values_[signal]);
      written_[signal] = values_[signal];
    }
  } else if (was_recording) {
    last_recorded_ = cycle;
    writer_.time(picoseconds(cycle));
  }
  changed_.clear();
}

void WaveRecorder::finish(Cycles cycle) {
  advance_to(cycle + 1);
  if (recording_) {
    last_recorded_ = cycle;
    writer_.time(picoseconds(cycle));
    recording_ = false;
  }
  edges_.clear();
  writer_.flush();
}

}  // namespace model
