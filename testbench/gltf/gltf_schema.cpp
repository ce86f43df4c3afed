#include "testbench/gltf/gltf_schema.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using GltfKind = GltfType::Kind;
using GltfContainer = GltfType::Container;

/// "mesh" for "meshes", "node" for "nodes".
std::string singular(std::string_view array) {
  const bool is_es = array == "meshes";
  return std::string(array.substr(0, array.size() - (is_es ? 2 : 1)));
}

std::string range_of(const GltfType& type) {
  std::ostringstream text;
  text << (type.kind == GltfKind::integer ? "an integer" : "a number");
  if (std::isfinite(type.least)) text << (type.is_least_excluded ? " above " : " from ") << type.least;
  if (std::isfinite(type.most)) {
    text << " to ";
    if (type.most == std::floor(type.most))
      text << std::uint64_t(type.most);
    else
      text << type.most;
  }
  return text.str();
}

std::string choices_of(const GltfType& type) {
  std::string text = type.of;
  for (std::size_t i = text.find(' '); i != std::string::npos; i = text.find(' ', i + 2))
    text.replace(i, 1, ", ");
  return text;
}

std::string element_of(const GltfType& type) {
  if (type.kind == GltfKind::boolean) return "true or false";
  if (type.kind == GltfKind::index) return "the index of a " + singular(type.of);
  if (type.kind == GltfKind::object) return "an object";
  if (*type.of != '\0') return choices_of(type);
  return type.kind == GltfKind::text ? "a text" : range_of(type);
}

std::string allowed_by(const GltfType& type) {
  if (type.container == GltfContainer::none) return element_of(type);
  if (type.container == GltfContainer::map) return "an object, each value " + element_of(type);
  const bool is_open = type.most_length == std::numeric_limits<std::size_t>::max();
  return "an array of " + std::to_string(type.least_length) + (is_open ? " or more" : "") + ", each " +
         element_of(type);
}

/// JSON Schema takes a number with a fraction of zero for an integer; beyond 2^53 that cannot be told.
bool is_integer(const nlohmann::json& value) {
  if (value.is_number_integer()) return true;
  if (!value.is_number()) return false;
  const double number = value.get<double>();
  return number == std::floor(number) && std::abs(number) <= 0x1p53;
}

bool is_choice(const std::string& text, const GltfType& type) {
  std::istringstream choices(type.of);
  return *type.of == '\0' || std::find(std::istream_iterator<std::string>(choices), {}, text) !=
                                 std::istream_iterator<std::string>();
}

bool is_in_range(double number, const GltfType& type) {
  return std::isfinite(number) && (type.is_least_excluded ? number > type.least : number >= type.least) &&
         number <= type.most;
}

class GltfChecker {
 public:
  GltfChecker(const std::string& file, const nlohmann::json& root) : file_(file), root_(root) {}

  void check_object(const nlohmann::json& value, std::string_view object, const std::string& pointer) const {
    for (const GltfRule& rule : gltf_rules()) {
      if (object != rule.object) continue;
      const auto property = value.find(rule.property);
      const std::string place = pointer + "/" + rule.property;
      if (property != value.end())
        check(*property, rule.type, place);
      else if (rule.is_required)
        fail_in_gltf(file_, place, "none", allowed_by(rule.type));
    }
  }

 private:
  void check(const nlohmann::json& value, const GltfType& type, const std::string& pointer) const {
    if (type.container == GltfContainer::none) return check_element(value, type, pointer);
    const bool is_array = type.container == GltfContainer::array;
    if (is_array ? !value.is_array() : !value.is_object()) fail(value, type, pointer);
    if (is_array && (value.size() < type.least_length || value.size() > type.most_length))
      fail_in_gltf(file_, pointer, "an array of " + std::to_string(value.size()), allowed_by(type));
    for (const auto& [key, element] : value.items())
      check_member(element, type, std::string(pointer).append("/").append(key));
  }

  /// An element of an array, which may be a map of its own (targets of a primitive).
  void check_member(const nlohmann::json& value, const GltfType& type, const std::string& pointer) const {
    if (type.container == GltfContainer::array && type.is_array_of_maps) {
      GltfType map = type;
      map.container = GltfContainer::map;
      return check(value, map, pointer);
    }
    check_element(value, type, pointer);
  }

  void check_element(const nlohmann::json& value, const GltfType& type, const std::string& pointer) const {
    switch (type.kind) {
      case GltfKind::object:
        if (!value.is_object()) fail(value, type, pointer);
        return check_object(value, type.of, pointer);
      case GltfKind::index:
        return check_index(value, type, pointer);
      case GltfKind::boolean:
        if (!value.is_boolean()) fail(value, type, pointer);
        return;
      case GltfKind::text:
        if (!value.is_string() || !is_choice(value.get<std::string>(), type)) fail(value, type, pointer);
        return;
      case GltfKind::integer:
        if (!is_integer(value) || !is_choice(std::to_string(value.get<std::int64_t>()), type))
          fail(value, type, pointer);
        [[fallthrough]];
      case GltfKind::number:
        if (!value.is_number() || !is_in_range(value.get<double>(), type)) fail(value, type, pointer);
    }
  }

  void check_index(const nlohmann::json& value, const GltfType& type, const std::string& pointer) const {
    const auto array = root_.find(type.of);
    const std::size_t size = array == root_.end() || !array->is_array() ? 0 : array->size();
    if (is_integer(value) && value.get<double>() >= 0.0 && value.get<double>() < double(size)) return;
    const std::string name = singular(type.of);
    fail_in_gltf(file_, pointer, name + " " + json_in_message(value),
                 size == 0 ? "none, the file holds no " + name : "0 to " + std::to_string(size - 1));
  }

  [[noreturn]] void fail(const nlohmann::json& value, const GltfType& type,
                         const std::string& pointer) const {
    fail_in_gltf(file_, pointer, json_in_message(value), allowed_by(type));
  }

  const std::string& file_;
  const nlohmann::json& root_;
};

}  // namespace

void check_gltf(const std::string& file, const nlohmann::json& root, const nlohmann::json& value,
                std::string_view object, const std::string& pointer) {
  GltfChecker(file, root).check_object(value, object, pointer);
}

std::string json_in_message(const nlohmann::json& value) {
  constexpr std::size_t kLongest = 60;
  if (value.is_structured() && value.size() > kLongest)
    return value.is_array() ? "an array of " + std::to_string(value.size()) : "an object";
  const std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

void fail_in_gltf(const std::string& file, const std::string& where, const std::string& found,
                  const std::string& allowed) {
  throw InputError(file + ": " + (where.empty() ? "" : where + ": ") + "found " + found +
                   "; allowed: " + allowed);
}

}  // namespace testbench
