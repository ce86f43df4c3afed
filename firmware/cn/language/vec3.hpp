#pragma once

#include "firmware/cn/language/math.hpp"

namespace cn {

/// Three components, poly or mono. GLM serves mono vectors in the testbench. Here operands mix poly and mono,
/// and a mono operand must stay scalar.
template <class T>
struct vec3 {
  T x;
  T y;
  T z;
};

template <class A, class B>
inline auto operator+(const vec3<A>& a, const vec3<B>& b) -> vec3<decltype(a.x + b.x)> {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class A, class B>
inline auto operator-(const vec3<A>& a, const vec3<B>& b) -> vec3<decltype(a.x - b.x)> {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// Multiplies component by component.
template <class A, class B>
inline auto operator*(const vec3<A>& a, const vec3<B>& b) -> vec3<decltype(a.x * b.x)> {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

template <class A, class B>
inline auto operator*(const vec3<A>& a, const B& scale) -> vec3<decltype(a.x * scale)> {
  return {a.x * scale, a.y * scale, a.z * scale};
}

template <class A, class B>
inline auto dot(const vec3<A>& a, const vec3<B>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class A, class B>
inline auto cross(const vec3<A>& a, const vec3<B>& b) -> vec3<decltype(a.x * b.x)> {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
inline vec3<poly<T>> select(const mask& condition, const vec3<poly<T>>& if_set,
                            const vec3<poly<T>>& otherwise) {
  return {select(condition, if_set.x, otherwise.x), select(condition, if_set.y, otherwise.y),
          select(condition, if_set.z, otherwise.z)};
}

}  // namespace cn
