#include "testbench/sweep/expression.hpp"

#include <muParser.h>

#include <limits>

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr std::size_t kMostCharacters = 1000;

mu::Parser parser_of(const std::string& text) {
  mu::Parser parser;
  parser.DefineNameChars("0123456789_.abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
  parser.SetExpr(text);
  return parser;
}

/// Names are constants of the parser, so that "=", which would give a variable another value, is refused.
double evaluate(mu::Parser& parser, const std::vector<std::string>& names,
                const std::vector<double>& values) {
  for (std::size_t i = 0; i < names.size(); ++i) parser.DefineConst(names[i], values[i]);
  return parser.Eval();
}

}  // namespace

Expression::Expression(std::string text, std::string origin)
    : text_(std::move(text)), origin_(std::move(origin)) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(
        origin_ + ": found '" + text_ + "': " + why +
        "; allowed: an expression over columns, for example chip.pes * poly.sram_bytes <= 589824");
  };
  if (text_.empty() || text_.size() > kMostCharacters)
    throw InputError(origin_ + ": found " + std::to_string(text_.size()) +
                     " characters; allowed: an expression of 1 to " + std::to_string(kMostCharacters));
  try {
    mu::Parser parser = parser_of(text_);
    for (const auto& [name, unused] : parser.GetUsedVar()) names_.push_back(name);
    evaluate(parser, names_, std::vector<double>(names_.size(), 1));
    if (parser.GetNumResults() != 1) refuse("several values, separated by commas");
  } catch (const mu::ParserError& error) {
    refuse(error.GetMsg());
  }
}

double Expression::value(const std::vector<double>& values) const {
  try {
    mu::Parser parser = parser_of(text_);
    return evaluate(parser, names_, values);
  } catch (const mu::ParserError&) {
    return std::numeric_limits<double>::quiet_NaN();  // a function outside its domain
  }
}

}  // namespace testbench
