#pragma once

#include <string>
#include <vector>

namespace testbench {

/// Whether a firmware's name is the path of a file: it has a slash or ends in ".so".
bool is_firmware_file(const std::string& name);

/// The file of a firmware: the path that is given, or for a name such as "dgemm" the one of that name that
/// was installed with the program (../lib/csx600 or, in a build tree, lib/csx600 beside the program). Throws
/// InputError for a name without such a file.
std::string firmware_path(const std::string& name);

/// "dgemm" of "libdgemm.so"; "" of a file that is no library's.
std::string firmware_name(const std::string& file);

/// The names of the firmwares that were installed with the program, sorted.
std::vector<std::string> installed_firmwares();

}  // namespace testbench
