#pragma once

#include <array>

#include "firmware/cn/language/math.hpp"
#include "firmware/cn/language/poly4.hpp"

/// Conditions and signs of vectors (poly4.hpp). The elements of a vector share a PE's enable bit, so a
/// condition on them is four conditions of the PE.
namespace cn {

using mask4 = std::array<mask, 4>;

namespace vector4 {

template <class T>
inline const Lanes<typename poly<T>::Lane>& lanes_of(const poly4<T>& a, int element) {
  return a[element].lanes();
}
inline Lanes<double> lanes_of(double a, int) {
  return broadcast(a);
}
inline Lanes<float> lanes_of(float a, int) {
  return broadcast(a);
}

/// A comparison is a subtraction, whose elements follow each other through the adder; each of the four flags
/// is then taken into the test register.
template <Comparison comparison, class T, class A, class B>
inline mask4 compare(const A& a, const B& b) {
  issue(Vector4Traits<T>::kAdd);
  issue(InstructionClass::int16_alu, 4);
  issue_operand(a);
  issue_operand(b);
  const auto flag = [&](int e) { return mask(compare_lanes<comparison>(lanes_of(a, e), lanes_of(b, e))); };
  return {flag(0), flag(1), flag(2), flag(3)};
}

/// Applies a function of poly variables to each element of one or two vectors.
template <class T, class F>
inline poly4<T> map(const poly4<T>& a, F&& f) {
  return {f(a[0]), f(a[1]), f(a[2]), f(a[3])};
}
template <class T, class F>
inline poly4<T> map(const poly4<T>& a, const poly4<T>& b, F&& f) {
  return {f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])};
}

}  // namespace vector4

/// The operand type B is poly4<T> or T, here and below.
template <class T, class B>
inline mask4 operator<(const poly4<T>& a, const B& b) {
  return vector4::compare<Comparison::less, T>(a, b);
}
template <class T, class B>
inline mask4 operator<=(const poly4<T>& a, const B& b) {
  return vector4::compare<Comparison::less_or_equal, T>(a, b);
}
template <class T, class B>
inline mask4 operator>=(const poly4<T>& a, const B& b) {
  return vector4::compare<Comparison::less_or_equal, T>(b, a);
}
template <class T, class B>
inline mask4 operator==(const poly4<T>& a, const B& b) {
  return vector4::compare<Comparison::equal, T>(a, b);
}

inline mask4 operator&(const mask4& a, const mask4& b) {
  return {a[0] & b[0], a[1] & b[1], a[2] & b[2], a[3] & b[3]};
}
inline mask4 operator|(const mask4& a, const mask4& b) {
  return {a[0] | b[0], a[1] | b[1], a[2] | b[2], a[3] | b[3]};
}

/// Clears the sign bits, each in one 16-bit word.
inline poly4<double> abs(const poly4<double>& a) {
  return vector4::map(a, [](const poly<double>& element) { return abs(element); });
}

/// Returns `a` with its signs changed where those of `by` are negative.
inline poly4<double> flip_sign(const poly4<double>& a, const poly4<double>& by) {
  return vector4::map(
      a, by, [](const poly<double>& element, const poly<double>& sign) { return flip_sign(element, sign); });
}

}  // namespace cn
