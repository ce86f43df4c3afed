#pragma once

#include <memory>
#include <string>
#include <vector>

namespace testbench {

/// An expression over numbers with names like those of a sweep's columns ("chip.pes * poly.sram_bytes <=
/// 589824"), as muParser reads them: + - * / ^, comparisons (0 or 1), && ||, ?:, min, max, abs, sqrt, exp,
/// ln, log10, ...
class Expression {
 public:
  /// @param origin where the text is from, for messages: "sweep.toml:7: constraint.sram". Throws InputError
  ///   for what is no expression.
  Expression(std::string text, std::string origin);

  const std::string& text() const { return text_; }
  const std::string& origin() const { return origin_; }
  /// What it is about, each name once.
  const std::vector<std::string>& names() const { return names_; }

  /// @param values one for each of names(). Not a number, or infinite, where it divides by 0 or the like.
  double value(const std::vector<double>& values) const;

 private:
  std::string text_;
  std::string origin_;
  std::vector<std::string> names_;
};

}  // namespace testbench
