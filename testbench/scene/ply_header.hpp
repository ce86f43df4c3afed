#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace testbench {

/// A number type of PLY.
struct PlyType {
  std::size_t bytes = 0;
  bool is_integer = false;
  double low = 0.0;   ///< of an integer type
  double high = 0.0;  ///< of an integer type
};

struct PlyProperty {
  std::string name;
  PlyType type;
  std::optional<PlyType> length_type;  ///< of a list: the type of the number of its entries
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyFormat { ascii, binary_little_endian, binary_big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  ///< of the header, its last line break included
  std::size_t lines = 0;
};

/// Reads the header of a PLY text, version 1.0. Throws InputError (file and line) for what is no such header,
/// and for elements that need more bytes than the file holds, so that their memory can be taken at once.
PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view text);

}  // namespace testbench
