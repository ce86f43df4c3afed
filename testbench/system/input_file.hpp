#pragma once

#include <filesystem>
#include <string>

namespace testbench {

/// The content of a file. Throws InputError, with `allowed` as the file that is wanted, if it cannot be read.
std::string read_input_file(const std::filesystem::path& path, const std::string& allowed);

}  // namespace testbench
