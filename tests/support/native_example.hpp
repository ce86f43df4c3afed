#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "testbench/machine/native_machine.hpp"
#include "testbench/system/error.hpp"
#include "testbench/validation/example_runs.hpp"

namespace test_support {

/// Mono memory after a native run.
inline std::vector<std::uint8_t> run_natively(const testbench::ExampleRun& run, int num_pes,
                                              const cn::MonoRange& scratchpad = {}) {
  testbench::NativeMachine machine(num_pes, 6144, run.mono.size(), scratchpad);
  std::memcpy(machine.mono(), run.mono.data(), run.mono.size());
  if (!run.scratchpad.empty())
    std::memcpy(machine.scratchpad_bytes(), run.scratchpad.data(), run.scratchpad.size());
  run.firmware(machine);
  return {machine.mono(), machine.mono() + machine.mono_bytes()};
}

/// The message of `run.check` for `mono`; empty if the results are right.
inline std::string verdict(const testbench::ExampleRun& run, const std::vector<std::uint8_t>& mono) {
  try {
    run.check(mono.data());
    return {};
  } catch (const testbench::RunError& error) {
    return error.what();
  }
}

}  // namespace test_support
