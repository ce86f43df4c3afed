#pragma once

#include <string>

namespace testbench {

/// A text as a field of a CSV file (RFC 4180), in quotes where it holds a comma, a quote or the end of a
/// line. Spreadsheets run fields that begin with = + - @, a tabulator or CR as formulas: such a text gets an
/// apostrophe before it, which they take as "this is text". Numbers are no texts and are written as they are.
std::string csv_text(const std::string& text);
/// The same in quotes, whatever it holds.
std::string csv_quoted(const std::string& text);

}  // namespace testbench
