#include "firmware/examples/stream.hpp"

#include <cstring>
#include <vector>

#include "model/config/chip_presets.hpp"
#include "model/csx600.hpp"
#include "testbench/machine/native_machine.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace stream_test {

using examples::Stream;

constexpr int kPes = 96;
constexpr Stream::Problem kProblem{{0}, {1 << 20}, 0.75, 300, 9, 80};
constexpr std::size_t kElements = std::size_t(kPes) * 9 * 80;

enum class Form { alone, with_threads };

std::vector<double> input(int array) {
  std::vector<double> values(kElements);
  for (std::size_t i = 0; i < kElements; ++i) values[i] = double(i * 7 % 1000) + 0.25 * array;
  return values;
}

std::vector<double> expected() {
  std::vector<double> y = input(1);
  const std::vector<double> x = input(0);
  for (std::size_t i = 0; i < kElements; ++i)
    for (int step = 0; step < kProblem.steps; ++step) y[i] = y[i] * kProblem.factor + x[i];
  return y;
}

void write_input(std::uint8_t* mono) {
  std::memcpy(mono + kProblem.x.address, input(0).data(), kElements * sizeof(double));
  std::memcpy(mono + kProblem.y.address, input(1).data(), kElements * sizeof(double));
}

std::vector<double> output(const std::uint8_t* mono) {
  std::vector<double> y(kElements);
  std::memcpy(y.data(), mono + kProblem.y.address, kElements * sizeof(double));
  return y;
}

void run_stream(cn::Machine& machine, Form form) {
  Stream stream(machine, examples::kernels(cn::narrowest_level()), kProblem);
  if (form == Form::alone) return stream.run_alone();
  stream.run_with_threads();
}

class StreamExample : public test_support::SystemCFixture {
 protected:
  /// Runs it on the chip and compares what it leaves in mono memory.
  model::ControlStatistics run_on_chip(Form form) {
    sc_core::sc_curr_simcontext = new sc_core::sc_simcontext();
    sc_core::sc_default_global_context = sc_core::sc_curr_simcontext;
    model::Csx600 chip("chip", model::default_chip_config());
    write_input(chip.mono_ddr->memory().data());
    chip.control_unit.load([form](cn::Machine& machine) { run_stream(machine, form); });
    elaborate();
    chip.control_unit.start();
    sc_core::sc_start();
    chip.control_unit.rethrow_failure();
    EXPECT_TRUE(chip.control_unit.finished());
    EXPECT_EQ(output(chip.mono_ddr->memory().data()), expected());
    return chip.control_unit.statistics();
  }
};

TEST_F(StreamExample, GivesTheSameNativelyAloneAndWithThreads) {
  for (const Form form : {Form::alone, Form::with_threads}) {
    testbench::NativeMachine machine(kPes, 6144, 2 << 20);
    write_input(machine.mono());
    machine.run_firmware([form](cn::Machine& chip) { run_stream(chip, form); });
    EXPECT_EQ(output(machine.mono()), expected());
  }
}

TEST_F(StreamExample, ThreadsHideTheKernelsBehindTheCopies) {
  const model::ControlStatistics alone = run_on_chip(Form::alone);
  const model::ControlStatistics with_threads = run_on_chip(Form::with_threads);
  RecordProperty("alone_cycles", std::to_string(alone.total()));
  RecordProperty("with_threads_cycles", std::to_string(with_threads.total()));
  EXPECT_EQ(with_threads[model::CycleCause::poly], alone[model::CycleCause::poly]);
  // Copies take longer than kernels here. PIO is idle in the first kernel at most, and in the last.
  const auto hidden = alone.exposed_pio() - with_threads.exposed_pio();
  EXPECT_GT(alone.exposed_pio(), alone[model::CycleCause::poly]);
  EXPECT_GE(hidden, alone[model::CycleCause::poly] * 7 / 9);
  EXPECT_LE(hidden, alone[model::CycleCause::poly]);
}

}  // namespace stream_test
