#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "model/config/chip_parameters.hpp"

namespace model {

/// The text of a file. Throws ConfigError if it cannot be read.
std::string read_chip_file(const std::string& file);

/// A chip by the name of a preset, or from a file whose name ends in ".toml":
///
///     preset = "csx600"        optional base, default csx600
///     [pio]
///     setup_cycles = 200       any key of the parameter table
///     [poly.cycles]
///     fp64_add = 4
///
/// The result is validated. Throws ConfigError (one line: file, line, key, what was found, what is allowed).
///
/// @param read the text of a file; may throw what it likes. read_chip_file() unless the caller has checks of
/// its
///        own, such as how deep a text may nest before a library parses it
ChipConfig load_chip(std::string_view preset_or_file,
                     const std::function<std::string(const std::string& file)>& read = read_chip_file);

/// All parameters as a TOML file that load_chip() reads back to an equal chip, bit for bit.
std::string effective_toml(const ChipConfig& config);

}  // namespace model
