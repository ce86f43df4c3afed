#pragma once

#include "firmware/cn/language/poly.hpp"

namespace cn {

/// Pushes a condition onto the enable stack; its destructor pops it.
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

/// Cn's if on a poly condition. The control unit never skips a branch on its own: both are issued, with the
/// PEs disabled whose condition chooses the other.
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

/// What a Cn programmer writes as `if (any(condition)) { poly if (condition) ... }`. It costs a reduction
/// over all PEs; the body is not issued when the condition holds on no PE.
template <class Body>
inline void poly_if_any(const mask& condition, Body&& body) {
  issue(InstructionClass::reduce);
  const std::size_t region = strip.next_region++;
  EnableScope scope(condition);
  if (any_enabled()) run_node(region, 0, body);
}

/// Cn's while on a poly condition: runs as long as the condition holds on any PE. A PE that fails it is
/// disabled for the rest of the loop. `condition` is evaluated before each pass and once more to leave.
template <class Condition, class Body>
inline void poly_while(Condition&& condition, Body&& body) {
  const std::size_t region = strip.next_region++;
  EnableScope scope{mask(strip.enabled)};
  bool again = true;  // even without an enabled PE, because the control unit must ask first
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
