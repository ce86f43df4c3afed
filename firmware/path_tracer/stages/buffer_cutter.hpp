#pragma once

#include "firmware/path_tracer/kernels/kernels.hpp"

namespace path_tracer {

/// Cuts records off a ring buffer, in order.
class BufferCutter {
 public:
  explicit BufferCutter(cn::PolySpan buffer) : offset_bytes_(buffer.offset_bytes) {}

  template <class Record>
  PolyPointer<Record> take(int count = 1) {
    const PolyPointer<Record> start(offset_bytes_);
    offset_bytes_ += count * PolyPointer<Record>::size_bytes();
    return start;
  }
  /// Takes so many bytes for records that begin as `Record` does.
  template <class Record>
  PolyPointer<Record> take_bytes(int bytes) {
    const PolyPointer<Record> start(offset_bytes_);
    offset_bytes_ += bytes;
    return start;
  }
  template <class T>
  PolyField<T> take_field() {
    const PolyField<T> field{offset_bytes_};
    offset_bytes_ += static_cast<int>(sizeof(T));
    return field;
  }
  PolyField<MonoAddress> take_place() { return take_field<MonoAddress>(); }

 private:
  int offset_bytes_;
};

}  // namespace path_tracer
