#pragma once

#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "model/waves/wave_probe.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/test_chip.hpp"
#include "tests/support/vcd_reader.hpp"

namespace test_support {

/// Stands in for the control unit: reports ahead of time, then advances time.
class Reporter : public sc_core::sc_module {
 public:
  using Body = std::function<void(Reporter&)>;

  Reporter(const sc_core::sc_module_name& name, const model::ClockDomain& clock, Body body)
      : sc_module(name), clock_(clock), body_(std::move(body)) {
    SC_HAS_PROCESS(Reporter);
    SC_THREAD(run);
  }

  void wait_until(model::Cycles cycle) { wait(clock_.time_at(cycle) - sc_core::sc_time_stamp()); }

 private:
  void run() { body_(*this); }

  model::ClockDomain clock_;
  Body body_;
};

class WaveProbeFixture : public test_support::SystemCFixture {
 protected:
  /// A probe that shows everything; a cycle takes one nanosecond by default.
  void make_probe(model::Cycles first = 0, model::Cycles last = model::CycleWindow{}.last,
                  double clock_hz = 1e9) {
    model::WaveConfig config;
    config.windows = {{first, last}};
    make_probe(config, clock_hz);
  }
  void make_probe(model::WaveConfig config, double clock_hz = 1e9) {
    chip.chip.clock_hz = clock_hz;
    clock = model::ClockDomain(clock_hz);
    if (!config.selection.level) config.selection.level = model::WaveLevel::detail;
    probe = std::make_unique<model::WaveProbe>(
        "probe", config, chip, [this](std::string_view text) { file << text; }, [this] { return memory; });
  }
  /// What was written, if the probe has finished.
  VcdReader vcd() const {
    std::istringstream in(file.str());
    return VcdReader(in);
  }

  void simulate(Reporter::Body body) {
    Reporter reporter("reporter", clock, std::move(body));
    sc_core::sc_start();
  }

  void transfer(std::uint64_t id, cn::Direction direction, model::Cycles started, model::Cycles finished,
                std::uint64_t bytes = 64, int queue_depth = 0) {
    model::PioEvent event;
    event.id = id;
    event.direction = direction;
    event.bytes = bytes;
    event.started = started;
    event.queue_depth = queue_depth;
    probe->started(event);
    event.finished = finished;
    probe->finished(event);
  }
  void load(std::uint64_t id, model::Cycles started, model::Cycles finished) {
    transfer(id, cn::Direction::mono_to_poly, started, finished);
  }
  void save(std::uint64_t id, model::Cycles started, model::Cycles finished) {
    transfer(id, cn::Direction::poly_to_mono, started, finished);
  }

  std::ostringstream file;
  model::ChipConfig chip = test_chip();
  model::ClockDomain clock{1e9};
  model::MemoryCounters memory;
  std::unique_ptr<model::WaveProbe> probe;
};

inline std::uint64_t state(model::CycleCause cause) {
  return std::uint64_t(cause) + 1;
}

using ChangeList = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

/// Time in ps and value of all changes, the initial value first.
inline ChangeList changes(const VcdReader& vcd, const std::string& path) {
  ChangeList list;
  for (const auto& change : vcd.signal(path).changes) list.emplace_back(change.time, change.value);
  return list;
}

}  // namespace test_support
