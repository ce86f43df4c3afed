#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace testbench {

/// The JSON as text, on one line, or over several with `indent` blanks a level. Bytes that are no UTF-8, as
/// in the name of a file, become U+FFFD: such a name costs no run.
std::string json_text(const nlohmann::ordered_json& json, int indent = -1);

/// What a value of a JSON file may be. A count is an integer of 0 or more.
enum class JsonType : std::uint8_t { text, flag, count, number, number_or_none, scalar, list, object, any };

/// One key that a file must hold, or may hold: a row of the file's schema.
struct SchemaRow {
  std::string key;  ///< the path, joined by dots; "*" is every element or member, of which there may be none
  JsonType type;
  bool required = true;
};
using Schema = std::vector<SchemaRow>;

/// The object that a text holds. Throws InputError, one line that names `origin` and the line, when the text
/// is empty, nests too deep (nesting.hpp), is no JSON object, or has more members or longer keys than csx600
/// writes: work on it takes a time linear in its size.
/// @param allowed "a statistics file"
/// @param first_line the number of the text's first line in its file
nlohmann::ordered_json parse_json_object(const std::string& text, const std::string& origin,
                                         const std::string& allowed, std::size_t first_line = 1);

/// Throws InputError with line, key, what was found and what is allowed, for the first row that `json`
/// breaks.
/// @param text what `json` was parsed from, in which the line is looked up
void require_schema(const nlohmann::ordered_json& json, const Schema& schema, const std::string& text,
                    const std::string& origin, std::size_t first_line = 1);

}  // namespace testbench
