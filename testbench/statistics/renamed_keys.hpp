#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "testbench/statistics/statistics_file.hpp"

namespace testbench {

/// A key of statistics files, golden tables and sweeps that files of earlier versions call otherwise. Each
/// stands for all keys below it, too: a renamed section is one entry.
struct RenamedKey {
  std::string_view old_key;
  std::string_view new_key;
};
const std::vector<RenamedKey>& renamed_keys();

/// What `key` is called now; "" for one that was not renamed.
std::string new_name_of(std::string_view key);

/// Throws InputError, one line that names `origin` (a file or option), the key and its new name, when `key`
/// is an old one.
void require_current_key(const std::string& origin, std::string_view key);
/// The same of every key.
void require_current_keys(const std::string& origin, const FlatStatistics& statistics);

}  // namespace testbench
