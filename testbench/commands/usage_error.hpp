#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace testbench {

/// What is wrong with a command line that CLI11 has refused with `error`: of an unknown command or option,
/// the name and the known one nearest to it; otherwise what CLI11 says.
/// @param words of the command line, without the program's name
std::string usage_error_text(const CLI::App& program, const CLI::Error& error,
                             const std::vector<std::string>& words);

}  // namespace testbench
