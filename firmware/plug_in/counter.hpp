#pragma once

#include <string>

namespace plug_in {

/// A number that a firmware reports beside what the chip counts, in its statistics and as a column of sweeps:
/// `Counter largest_error{*this, "largest_error", "-", "largest distance from the right result"}`.
class Counter {
 public:
  /// @param owner a Firmware, which lists its counters
  /// @param unit "-" of a ratio, "count" of a number of what the name says
  template <class Owner>
  Counter(Owner& owner, std::string name, std::string unit, std::string meaning)
      : name_(std::move(name)), unit_(std::move(unit)), meaning_(std::move(meaning)) {
    owner.add(*this);
  }
  Counter(const Counter&) = delete;
  Counter& operator=(const Counter&) = delete;

  /// May be called by check(), which changes nothing else.
  void set(double value) const { value_ = value; }

  const std::string& name() const { return name_; }
  const std::string& unit() const { return unit_; }
  const std::string& meaning() const { return meaning_; }
  double value() const { return value_; }

 private:
  std::string name_;
  std::string unit_;
  std::string meaning_;
  mutable double value_ = 0;
};

}  // namespace plug_in
