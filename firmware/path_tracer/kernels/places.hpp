#pragma once

#include "firmware/cn/language/exact.hpp"
#include "firmware/cn/language/poly_pointer.hpp"
#include "firmware/path_tracer/geometry/triangle.hpp"

namespace path_tracer {

/// Returns the mono address of the index-th record of an array.
inline poly<cn::MonoAddress> place_of(cn::MonoAddress first, const poly<std::int32_t>& index,
                                      std::size_t record_bytes) {
  const cn::WideProduct offset =
      cn::multiply_wide(cn::reinterpret_word<std::uint32_t>(index), static_cast<std::uint32_t>(record_bytes));
  return cn::join_words(offset) + first;
}

/// Returns a light's number, from its place among the lights.
inline poly<std::int32_t> light_number(const poly<cn::MonoAddress>& place, cn::MonoAddress lights) {
  const poly<double> offset = cn::convert<double>(cn::low_word(place - lights));
  return cn::convert<std::int32_t>(offset * (1.0 / sizeof(LightRecord)) + 0.5);
}

/// Writes the result of a finished search for the intersection stage.
inline void write_hit(const Nearest& nearest, const Point3& origin, const Direction3& direction,
                      const cn::PolyPointer<HitRecord>& hit) {
  const mask something = nearest.number >= 0;
  const mask front = nearest.determinant > 0.0;
  const poly<double> distance = nearest.distance / cn::abs(nearest.determinant);
  hit.set(&HitRecord::position, origin + direction * distance);
  hit.set(&HitRecord::hit, cn::select(something, poly<std::int32_t>(1), poly<std::int32_t>(0)));
  hit.set(&HitRecord::front, cn::select(front, poly<std::int32_t>(1), poly<std::int32_t>(0)));
}

}  // namespace path_tracer
