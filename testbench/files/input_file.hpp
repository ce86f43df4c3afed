#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace testbench {

inline constexpr std::uint64_t kMostInputBytes = std::uint64_t{1} << 34;  ///< meshes are the largest
inline constexpr std::uint64_t kMostTomlBytes = std::uint64_t{1} << 24;   ///< files that people write

/// The content of a file. Throws InputError, with `allowed` as the file that is wanted, if it cannot be read,
/// is no regular file (FIFOs and devices may never end) or is larger than `most_bytes`.
std::string read_input_file(const std::filesystem::path& path, const std::string& allowed,
                            std::uint64_t most_bytes = kMostInputBytes);

/// Throws as read_input_file() does, for a file that a library reads.
void require_input_file(const std::filesystem::path& path, const std::string& allowed,
                        std::uint64_t most_bytes = kMostInputBytes);

}  // namespace testbench
