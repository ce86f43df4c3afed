#pragma once

#include <unistd.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/wave_probe.hpp"
#include "tests/support/systemc_fixture.hpp"
#include "tests/support/vcd_reader.hpp"

namespace test_support {

/// Stands for the control unit: reports ahead of time, then lets time pass.
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
  WaveProbeFixture() {
    directory = std::filesystem::temp_directory_path() / ("wave_probe_test." + std::to_string(getpid()));
    std::filesystem::create_directory(directory);
  }
  ~WaveProbeFixture() override {
    probe.reset();
    std::filesystem::remove_all(directory);
  }

  std::string file() const { return (directory / "test.vcd").string(); }

  void make_probe(model::Cycles first = 0, model::Cycles last = model::WaveConfig{}.last_cycle,
                  double clock_hz = 1e9) {
    clock = model::ClockDomain(clock_hz);
    probe = std::make_unique<model::WaveProbe>("probe", model::WaveConfig{file(), first, last}, clock,
                                               [this] { return memory; });
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

  std::filesystem::path directory;
  model::ClockDomain clock{1e9};
  model::MemoryCounters memory;
  std::unique_ptr<model::WaveProbe> probe;
};

inline std::uint64_t state(model::CycleCause cause) {
  return std::uint64_t(cause) + 1;
}

using ChangeList = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

/// (time in ps, value) of all changes, the initial value first.
inline ChangeList changes(const VcdReader& vcd, const std::string& path) {
  ChangeList list;
  for (const auto& change : vcd.signal(path).changes) list.emplace_back(change.time, change.value);
  return list;
}

}  // namespace test_support
