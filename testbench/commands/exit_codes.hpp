#pragma once

namespace testbench {

/// How the program ends, and what that means.
struct ExitCode {
  int code;
  const char* meaning;
};
inline constexpr ExitCode kDone = {0, "The command did what it was asked to do."};
inline constexpr ExitCode kRunFailed = {
    1,
    "A run failed or was interrupted, or what was compared differs. No output of a failed run is left; "
    "what an interrupted render wrote is whole and marked partial."};
inline constexpr ExitCode kWrongInput = {
    2, "The command line or an input file is wrong. One line names it, what was found and what is allowed."};
inline constexpr ExitCode kExitCodes[] = {kDone, kRunFailed, kWrongInput};

}  // namespace testbench
