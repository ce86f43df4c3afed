#include "testbench/scene/obj_numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <string>

#include "testbench/scene/obj_mesh.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr std::string_view kBlanks = " \t";

/// Removes the next blank-separated word from the front of `line` and returns it; empty at the end of the
/// line.
std::string_view take_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(kBlanks), line.size());
  const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

/// Calls `use(line_number, line)` for every line; lines end with \n, \r\n or \r.
template <class Use>
void for_each_line(std::string_view text, Use use) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    use(number, text.substr(0, end));
    const std::size_t ending = text.substr(end, 2) == "\r\n" ? 2 : 1;
    text.remove_prefix(std::min(end + ending, text.size()));
  }
}

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t line, std::string_view what,
                       std::string_view found, std::string_view allowed) {
  std::ostringstream message;
  message << file.string() << ":" << line << ": " << what << ": found '" << found
          << "'; allowed: " << allowed;
  throw InputError(message.str());
}

/// The range that a number must lie in, and its description for error messages.
struct Range {
  double low;
  double high;
  const char* allowed;
};

constexpr Range kCoordinateRange{-kMaxCoordinate, kMaxCoordinate, "3 finite numbers of at most 1e100"};
constexpr Range kReflectanceRange{0.0, 1.0, "3 numbers from 0 to 1"};
constexpr Range kEmissionRange{0.0, kMaxEmission, "3 numbers from 0 to 1e12"};

bool parse_number(std::string_view word, double& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);  // from_chars knows only '-'
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
}

glm::dvec3 take_vector(const std::filesystem::path& file, std::size_t line_number, std::string_view line,
                       const std::string& what, const Range& range) {
  const std::string_view found = trimmed(line);
  glm::dvec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    double value = 0.0;
    if (!parse_number(take_word(line), value) || value < range.low || value > range.high) {
      fail(file, line_number, what, found, range.allowed);
    }
    result[axis] = value;
  }
  return result;
}

}  // namespace

std::vector<glm::dvec3> scan_vertices(const std::filesystem::path& file, std::string_view text) {
  std::vector<glm::dvec3> vertices;
  for_each_line(text, [&](std::size_t number, std::string_view line) {
    if (take_word(line) != "v") return;
    vertices.push_back(
        take_vector(file, number, line, "vertex " + std::to_string(vertices.size() + 1), kCoordinateRange));
  });
  return vertices;
}

std::vector<Material> scan_materials(const std::filesystem::path& file, std::string_view text) {
  std::vector<Material> materials;
  std::set<std::string> names;
  const auto current = [&](std::size_t number, std::string_view keyword) -> Material& {
    if (materials.empty()) fail(file, number, "MTL line", keyword, "newmtl before it");
    return materials.back();
  };
  for_each_line(text, [&](std::size_t number, std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword == "newmtl") {
      materials.emplace_back();
      materials.back().name = trimmed(line);
      const std::string& name = materials.back().name;
      if (name.empty() || !names.insert(name).second) {
        fail(file, number, "newmtl", name, "a name, each defined once");
      }
    } else if (keyword == "Kd") {
      Material& material = current(number, keyword);
      material.reflectance =
          take_vector(file, number, line, "material '" + material.name + "': Kd", kReflectanceRange);
    } else if (keyword == "Ke") {
      Material& material = current(number, keyword);
      material.emission =
          take_vector(file, number, line, "material '" + material.name + "': Ke", kEmissionRange);
    } else if (keyword == "map_Kd" || keyword == "map_Ke") {
      const std::string& name = current(number, keyword).name;
      fail(file, number, "material '" + name + "': " + std::string(keyword), trimmed(line),
           "Kd and Ke colours, no textures");
    }
  });
  if (materials.empty()) throw InputError(file.string() + ": found no material; allowed: one newmtl or more");
  return materials;
}

}  // namespace testbench
