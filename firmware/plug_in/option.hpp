#pragma once

#include <charconv>
#include <string>
#include <type_traits>

namespace plug_in {

/// An option of a firmware, as the program that runs it sees it.
class OptionBase {
 public:
  OptionBase(std::string name, std::string meaning) : name_(std::move(name)), meaning_(std::move(meaning)) {}
  virtual ~OptionBase() = default;
  OptionBase(const OptionBase&) = delete;
  OptionBase& operator=(const OptionBase&) = delete;

  const std::string& name() const { return name_; }
  const std::string& meaning() const { return meaning_; }
  virtual std::string allowed_text() const = 0;
  virtual std::string value_text() const = 0;
  /// Returns false, and changes nothing, for a text that is not allowed.
  virtual bool set(const std::string& text) = 0;

 private:
  std::string name_;
  std::string meaning_;
};

/// The least and the greatest value that are allowed.
template <class T>
struct Range {
  T low;
  T high;
};

/// A number that the user may choose: `Option<int> blocks{*this, "blocks", 64, {1, 4096}, "blocks to add"}`.
template <class T>
class Option : public OptionBase {
  static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>, "options are numbers");

 public:
  /// @param owner a Firmware, which lists its options
  template <class Owner>
  Option(Owner& owner, std::string name, T default_value, Range<T> allowed, std::string meaning)
      : OptionBase(std::move(name), std::move(meaning)), value_(default_value), allowed_(allowed) {
    owner.add(*this);
  }

  operator T() const { return value_; }

  std::string allowed_text() const override { return text(allowed_.low) + ".." + text(allowed_.high); }
  std::string value_text() const override { return text(value_); }
  bool set(const std::string& written) override {
    T value{};
    const char* const end = written.data() + written.size();
    const auto [stop, error] = std::from_chars(written.data(), end, value);
    if (error != std::errc{} || stop != end) return false;
    if (!(value >= allowed_.low && value <= allowed_.high)) return false;
    value_ = value;
    return true;
  }

 private:
  static std::string text(T value) {
    char buffer[64];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof(buffer), value).ptr);
  }

  T value_;
  Range<T> allowed_;
};

}  // namespace plug_in
