#pragma once

#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace testbench {

/// The type of one value in a glTF file, in the terms of the specification's property reference.
struct GltfType {
  enum class Kind {
    integer,
    number,
    text,
    boolean,
    index,  ///< of an element of the top-level array `of`
    object  ///< of the type `of`
  };
  enum class Container { none, array, map };

  Kind kind;
  const char* of = "";  ///< array, type of object, or for text and integer the choices with blanks between
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool is_least_excluded = false;
  Container container = Container::none;
  std::size_t least_length = 0;  ///< of an array
  std::size_t most_length = 0;
  bool is_array_of_maps = false;
};

/// One line of the property reference: `property` of each object of the type `object`.
struct GltfRule {
  const char* object;
  const char* property;
  bool is_required;
  GltfType type;
};

/// All rules that hold for what is read, in the order of the specification's property reference.
struct GltfRules {
  const GltfRule* first;
  std::size_t size;

  const GltfRule* begin() const { return first; }
  const GltfRule* end() const { return first + size; }
};
GltfRules gltf_rules();

/// Checks `value` and all that lies in it against the rules for objects of type `object`. Properties without
/// a rule are ignored, as the specification wants of a reader. Throws InputError: file, JSON pointer, what
/// was found, what is allowed.
/// @param root the whole file, whose arrays indices point into
/// @param pointer the JSON pointer to `value`
void check_gltf(const std::string& file, const nlohmann::json& root, const nlohmann::json& value,
                std::string_view object, const std::string& pointer);

/// A JSON value for a message: one line of printable ASCII, cut off after 60 characters.
std::string json_in_message(const nlohmann::json& value);

[[noreturn]] void fail_in_gltf(const std::string& file, const std::string& where, const std::string& found,
                               const std::string& allowed);

}  // namespace testbench
