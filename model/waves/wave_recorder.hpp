#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "model/time/clock_domain.hpp"
#include "model/waves/vcd_writer.hpp"
#include "model/waves/wave_config.hpp"

namespace model {

/// Brings changes that come in several streams, each in the order of time, into one order, and writes those
/// within the windows as a VCD. Windows may be added while it runs; cycles that several cover are written
/// once.
class WaveRecorder {
 public:
  /// How a change combines with the value before.
  enum class Rule : std::uint8_t {
    assign,
    maximum,       ///< a count that two units report out of order
    set_or_clear,  ///< value 2b + 1 sets bit b, 2b clears it
  };
  struct Signal {
    VcdWriter::Signal vcd;
    std::uint64_t initial;
    Rule rule;
  };

  WaveRecorder(TextSink sink, const std::vector<Signal>& signals, const ClockDomain& clock,
               std::size_t streams);

  void add_window(const CycleWindow& window);
  /// Opens or closes a window whose other end is not known.
  void open_at(Cycles cycle) { add_edge(cycle, +1); }
  void close_at(Cycles cycle) { add_edge(cycle, -1); }
  /// False when all windows lie behind and none can come.
  bool wants_more() const { return recording_ || !edges_.empty() || expects_windows_; }
  void expect_windows(bool expected) { expects_windows_ = expected; }

  void change(std::size_t stream, Cycles cycle, std::size_t signal, std::uint64_t value);
  /// Writes everything before `end`. What is reported for an earlier cycle from now on is shown at `end`.
  void advance_to(Cycles end);
  /// Writes everything up to `cycle` and ends the file there.
  void finish(Cycles cycle);

  /// Whether `cycle`, not written yet, lies in a window that is known by now.
  bool covers(Cycles cycle) const;
  bool recorded() const { return recorded_; }
  /// First and last cycle of all windows together.
  Cycles first_recorded() const { return first_recorded_; }
  Cycles last_recorded() const { return last_recorded_; }
  /// Changes that were reported too late.
  std::uint64_t late_changes() const { return late_changes_; }

 private:
  static constexpr Cycles kNever = std::numeric_limits<Cycles>::max();
  struct Change {
    Cycles cycle;
    std::uint64_t value;
    std::size_t signal;
  };
  struct Stream {
    std::vector<Change> changes;
    std::size_t head = 0;
    Cycles next = kNever;  ///< cycle at the head
  };
  struct Edge {
    Cycles cycle;
    int step;
  };

  void add_edge(Cycles cycle, int step);
  Cycles next_cycle() const;
  void take(Stream& stream, Cycles cycle);
  void apply(const Change& change);
  void pass_edges(Cycles cycle);
  void write(Cycles cycle, bool was_recording);
  std::uint64_t picoseconds(Cycles cycle) const { return clock_.time_at(cycle).value(); }

  ClockDomain clock_;
  VcdWriter writer_;
  std::vector<Rule> rules_;
  std::vector<std::uint64_t> values_;
  std::vector<std::uint64_t> written_;
  std::vector<std::size_t> changed_;
  std::vector<Stream> streams_;
  std::vector<Edge> edges_;  ///< the next one last
  int open_windows_ = 0;
  bool expects_windows_ = false;
  bool recording_ = false;
  bool recorded_ = false;
  Cycles written_until_ = 0;
  Cycles first_recorded_ = 0;
  Cycles last_recorded_ = 0;
  std::uint64_t late_changes_ = 0;
};

}  // namespace model
