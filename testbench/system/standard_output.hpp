#pragma once

#include <string>

namespace testbench {

/// To be called before any file is opened. Gives standard input, output and error a descriptor each, so that
/// no file takes the number of one that the caller has closed. Collects what is printed, unless a terminal
/// shows it, so that finish_standard_output() knows why it could not be written.
void prepare_standard_streams();

/// To be called at the end. Throws RunError if a byte that was printed has not arrived (disk full, closed).
void finish_standard_output();

/// "csx600: MESSAGE" on standard error.
void print_error(const std::string& message);
/// "csx600: note: MESSAGE" on standard error: the run goes on.
void print_note(const std::string& message);

}  // namespace testbench
