#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace fuzz {

/// Writes a file of the current directory.
void write_file(const char* name, std::string_view bytes);

/// Writes the parts of an input, which lines "====" part, as files of the current directory, the first with
/// the first name. A name without a part is removed, parts without a name are left out.
void write_parts(std::string_view input, std::initializer_list<const char*> names);

}  // namespace fuzz
