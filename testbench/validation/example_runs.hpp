#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firmware/cn/machine.hpp"
#include "firmware/examples/dgemm.hpp"
#include "firmware/examples/monte_carlo.hpp"
#include "firmware/plug_in/firmware.hpp"

namespace testbench {

/// One of the example firmwares with its input and the check of its output.
struct ExampleRun {
  std::vector<std::uint8_t> mono;        ///< mono memory before the run, from address 0
  std::vector<std::uint8_t> scratchpad;  ///< cn::Machine::scratchpad() before the run, from its start
  std::function<void(cn::Machine&)> firmware;
  /// Throws RunError if mono memory does not hold the right results.
  std::function<void(const std::uint8_t* mono)> check;
  double work = 0;  ///< number of floating-point operations, or of samples
};

/// A prepared firmware with its buffers in place.
/// @param scratchpad addresses of the memory on the chip. Throws InputError for buffers that do not fit there
ExampleRun example_run(std::shared_ptr<plug_in::Firmware> firmware, int num_pes,
                       const cn::MonoRange& scratchpad = {});

/// The examples of firmware/examples/firmwares.hpp. `problem` gives the shape and the numbers; addresses are
/// set here.
/// @param scratchpad if it has bytes, the rows of B that travel down the path lie there
ExampleRun dgemm_run(const examples::Dgemm::Problem& problem, int num_pes, cn::Level level,
                     const cn::MonoRange& scratchpad = {});
ExampleRun monte_carlo_run(const examples::MonteCarlo::Problem& problem, int num_pes, cn::Level level);
ExampleRun fft_run(int images, int num_pes, cn::Level level);

}  // namespace testbench
