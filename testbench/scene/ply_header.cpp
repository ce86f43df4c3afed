#include "testbench/scene/ply_header.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "testbench/files/text_lines.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

struct PlyTypeName {
  const char* names[2];
  PlyType type;
};

constexpr PlyTypeName kPlyTypes[] = {{{"char", "int8"}, {1, true, -128.0, 127.0}},
                                     {{"uchar", "uint8"}, {1, true, 0.0, 255.0}},
                                     {{"short", "int16"}, {2, true, -32768.0, 32767.0}},
                                     {{"ushort", "uint16"}, {2, true, 0.0, 65535.0}},
                                     {{"int", "int32"}, {4, true, -2147483648.0, 2147483647.0}},
                                     {{"uint", "uint32"}, {4, true, 0.0, 4294967295.0}},
                                     {{"float", "float32"}, {4, false}},
                                     {{"double", "float64"}, {8, false}}};

class PlyHeaderReader {
 public:
  PlyHeaderReader(const std::filesystem::path& file, std::string_view text) : file_(file), text_(text) {}

  PlyHeader read() {
    const std::size_t end = std::min(text_.find_first_of("\r\n"), text_.size());
    if (text_.substr(0, end) != "ply")
      fail("the first line", text_.substr(0, std::min<std::size_t>(end, 40)), "ply");
    line_end_ = text_.substr(end, 1) == "\r" && text_.substr(end, 2) != "\r\n" ? '\r' : '\n';
    bool has_format = false;
    for (std::string_view line = next_line(); line != "end_header"; line = next_line()) {
      const std::string_view keyword = take_word(line);
      if (keyword == "format")
        has_format = read_format(line);
      else if (keyword == "element")
        read_element(line);
      else if (keyword == "property")
        read_property(line);
      else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty())
        fail("header", keyword, "format, element, property, comment, obj_info, end_header");
    }
    if (!has_format) fail("header", "no format", kFormats);
    for (const PlyElement& element : header_.elements) require_bytes(element);
    return header_;
  }

 private:
  static constexpr const char* kFormats =
      "format ascii, binary_little_endian or binary_big_endian, of version 1.0";

  [[noreturn]] void fail(const std::string& what, std::string_view found, const std::string& allowed) const {
    throw InputError(file_.string() + ":" + std::to_string(std::max<std::size_t>(header_.lines, 1)) + ": " +
                     what + ": found " + in_quotes(found) + "; allowed: " + allowed);
  }

  std::string_view next_line() {
    if (header_.lines == 0) take_line();  // "ply"
    if (header_.bytes >= text_.size())
      fail("header", "the end of the file", "a header that ends with end_header");
    return trimmed(take_line());
  }

  std::string_view take_line() {
    const std::size_t begin = header_.bytes;
    const std::size_t end = std::min(text_.find(line_end_, begin), text_.size());
    header_.bytes = std::min(end + 1, text_.size());
    ++header_.lines;
    const std::string_view line = text_.substr(begin, end - begin);
    return !line.empty() && line.back() == '\r' ? line.substr(0, line.size() - 1) : line;
  }

  bool read_format(std::string_view line) {
    const std::string_view found = trimmed(line);
    const std::string_view name = take_word(line);
    if (name == "ascii")
      header_.format = PlyFormat::ascii;
    else if (name == "binary_little_endian")
      header_.format = PlyFormat::binary_little_endian;
    else if (name == "binary_big_endian")
      header_.format = PlyFormat::binary_big_endian;
    else
      fail("format", found, kFormats);
    if (trimmed(line) != "1.0") fail("format", found, kFormats);
    return true;
  }

  void read_element(std::string_view line) {
    const std::string_view found = trimmed(line);
    PlyElement element;
    element.name = take_word(line);
    const std::string_view count = trimmed(line);
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (count.empty() || error != std::errc() || end != count.data() + count.size())
      fail("element", found, "a name and a whole number");
    const auto same = [&](const PlyElement& other) { return other.name == element.name; };
    if (std::any_of(header_.elements.begin(), header_.elements.end(), same))
      fail("element", found, "each element once");
    header_.elements.push_back(element);
  }

  void read_property(std::string_view line) {
    const std::string_view found = trimmed(line);
    if (header_.elements.empty()) fail("property", found, "an element before it");
    PlyProperty property;
    std::string_view type = take_word(line);
    if (type == "list") {
      property.length_type = type_named(take_word(line), found);
      if (!property.length_type->is_integer)
        fail("property", found, "an integer type for the length of a list");
      type = take_word(line);
    }
    property.type = type_named(type, found);
    property.name = trimmed(line);
    std::vector<PlyProperty>& all = header_.elements.back().properties;
    const auto same = [&](const PlyProperty& other) { return other.name == property.name; };
    if (property.name.empty() || std::any_of(all.begin(), all.end(), same))
      fail("property", found, "a name, each once in an element");
    all.push_back(property);
  }

  PlyType type_named(std::string_view name, std::string_view found) const {
    for (const PlyTypeName& type : kPlyTypes)
      if (name == type.names[0] || name == type.names[1]) return type.type;
    fail("property", found,
         "char, uchar, short, ushort, int, uint, float or double, or list and two of them");
  }

  /// Each number of an ASCII file takes two bytes at least, a digit and a blank or line break.
  void require_bytes(const PlyElement& element) const {
    std::size_t least_bytes = 0;
    for (const PlyProperty& property : element.properties) {
      const PlyType& type = property.length_type ? *property.length_type : property.type;
      least_bytes += header_.format == PlyFormat::ascii ? 2 : type.bytes;
    }
    const std::size_t present = text_.size() - header_.bytes + 1;  // the last line break may be missing
    if (element.count > present / std::max<std::size_t>(least_bytes, 1))
      throw InputError(file_.string() + ": element " + element.name + ": found a count of " +
                       std::to_string(element.count) + "; allowed: as many as the file has bytes for");
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  char line_end_ = '\n';  ///< a \r before \n is no part of the line
  PlyHeader header_;
};

}  // namespace

PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view text) {
  return PlyHeaderReader(file, text).read();
}

}  // namespace testbench
