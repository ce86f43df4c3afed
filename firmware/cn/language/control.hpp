#pragma once

#include "firmware/cn/language/poly.hpp"

namespace cn {

/// Pushes a condition onto the enable stack for as long as it lives.
class EnableScope {
 public:
  explicit EnableScope(const mask& condition) : outer_(strip.enabled) {
    issue(InstructionClass::enable);
    narrow(condition);
  }
  ~EnableScope() {
    issue(InstructionClass::enable);
    strip.enabled = outer_;
  }
  EnableScope(const EnableScope&) = delete;
  EnableScope& operator=(const EnableScope&) = delete;

  /// Enables the complement of the condition within the outer scope: the else part.
  void invert() {
    issue(InstructionClass::enable);
    strip.enabled = outer_ & ~strip.enabled;
  }

  void narrow(const mask& condition) { strip.enabled = strip.enabled & condition.lanes(); }

 private:
  MaskLanes outer_;
};

/// Cn's if on a poly condition. The control unit never jumps over a branch on its own: both are issued, PEs
/// that are not concerned are disabled.
template <class Then>
inline void poly_if(const mask& condition, Then&& then) {
  EnableScope scope(condition);
  then();
}

template <class Then, class Otherwise>
inline void poly_if(const mask& condition, Then&& then, Otherwise&& otherwise) {
  EnableScope scope(condition);
  then();
  scope.invert();
  otherwise();
}

inline bool any_enabled() {
  return mask_bits(strip.enabled) != 0;
}

/// What a Cn programmer writes as `if (any(condition)) { poly if (condition) ... }`: pays for a reduction
/// over all PEs, and the body is not issued when no PE wants it.
template <class Body>
inline void poly_if_any(const mask& condition, Body&& body) {
  issue(InstructionClass::reduce);
  const std::size_t region = strip.next_region++;
  EnableScope scope(condition);
  if (any_enabled()) run_node(region, 0, body);
}

/// Cn's while on a poly condition: runs as long as it holds on any PE; a PE that fails it is off for the rest
/// of the loop. `condition` is evaluated before each pass and once more to leave.
template <class Condition, class Body>
inline void poly_while(Condition&& condition, Body&& body) {
  const std::size_t region = strip.next_region++;
  EnableScope scope{mask(strip.enabled)};
  bool again = true;  // even without an enabled PE: the control unit knows only after it has asked
  for (std::size_t iteration = 0; again; ++iteration) {
    run_node(region, iteration, [&] {
      issue(InstructionClass::reduce);
      scope.narrow(condition());
      again = any_enabled();
      if (again) run_node(strip.next_region++, 0, body);
    });
  }
}

}  // namespace cn
