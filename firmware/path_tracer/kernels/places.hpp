#pragma once

#include "firmware/cn/language/exact.hpp"
#include "firmware/cn/language/poly_pointer.hpp"
#include "firmware/path_tracer/geometry/triangle.hpp"
#include "firmware/path_tracer/kernels/traversal_kernels.hpp"
#include "firmware/path_tracer/records/tails.hpp"

namespace path_tracer {

/// Returns the mono address of the index-th record of an array.
inline poly<cn::MonoAddress> place_of(cn::MonoAddress first, const poly<std::int32_t>& index,
                                      std::size_t record_bytes) {
  const cn::WideProduct offset =
      cn::multiply_wide(cn::reinterpret_word<std::uint32_t>(index), static_cast<std::uint32_t>(record_bytes));
  return cn::join_words(offset) + first;
}

inline poly<cn::MonoAddress> place_of(const MonoRecords& records, const poly<std::int32_t>& index) {
  return place_of(records.first, index, std::size_t(records.record_bytes));
}

/// Returns a light's number, from its place among the lights.
inline poly<std::int32_t> light_number(const poly<cn::MonoAddress>& place, cn::MonoAddress lights) {
  const poly<double> offset = cn::convert<double>(cn::low_word(place - lights));
  return cn::convert<std::int32_t>(offset * (1.0 / sizeof(LightRecord)) + 0.5);
}

/// The record at `place` bytes behind the start of another, in its tail (records/tails.hpp).
template <class Tail, class Record>
cn::PolyPointer<Tail> tail(const cn::PolyPointer<Record>& record, int place = sizeof(Record)) {
  return cn::PolyPointer<Tail>(record.span().offset_bytes + place);
}

/// The PassedRecord behind a record's DirectionRecord.
template <class Record>
cn::PolyPointer<PassedRecord> passed_behind(const cn::PolyPointer<Record>& record) {
  return tail<PassedRecord>(tail<DirectionRecord>(record));
}

/// Writes the result of a finished search for the intersection stage.
/// @param has_tail whether an ArrivalRecord follows
inline void write_hit(const Nearest& nearest, const Point3& origin, const Direction3& direction,
                      const cn::PolyPointer<HitRecord>& hit, bool has_tail) {
  const mask something = nearest.number >= 0;
  const mask front = nearest.determinant > 0.0;
  const poly<double> distance = nearest.distance / cn::abs(nearest.determinant);
  hit.set(&HitRecord::position, origin + direction * distance);
  hit.set(&HitRecord::hit, cn::select(something, poly<std::int32_t>(1), poly<std::int32_t>(0)));
  hit.set(&HitRecord::front, cn::select(front, poly<std::int32_t>(1), poly<std::int32_t>(0)));
  if (!has_tail) return;
  const auto arrival = tail<ArrivalRecord>(hit);
  arrival.set(&ArrivalRecord::direction, direction);
  arrival.set(&ArrivalRecord::distance, distance);
}

}  // namespace path_tracer
