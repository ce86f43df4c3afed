#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace model {

/// Creates an empty file that SystemC can then write to; a named pipe is left alone. Returns what is wrong,
/// or an empty text.
std::string create_vcd_file(const std::filesystem::path& file);

/// SystemC gives the initial values of a file no time, which viewers read as time 0 even if the file was
/// begun later. Writes the time before them, over the comment that stands there. Leaves a named pipe, and a
/// file of another form, as it is.
void write_initial_time(const std::filesystem::path& file, std::uint64_t time_units);

/// The time stamp in the last line of a file, which SystemC writes when it closes one; nothing if the last
/// line is another.
std::optional<std::uint64_t> closing_time(const std::filesystem::path& file);

}  // namespace model
