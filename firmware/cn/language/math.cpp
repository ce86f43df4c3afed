#include "firmware/cn/language/math.hpp"

#include <sleef.h>

namespace cn {
namespace {

using Chunk = Lanes<double>::Chunk;

// SLEEF's "cinz" functions are bit-reproducible: the same result on every vector extension, without fused
// multiply-add. Each native width has its own set of names.
#if defined(__AVX512F__)
auto sincos_chunk(Chunk a) {
  return Sleef_cinz_sincosd8_u10avx512fnofma(a);
}
Chunk atan2_chunk(Chunk y, Chunk x) {
  return Sleef_cinz_atan2d8_u10avx512fnofma(y, x);
}
Chunk exp_chunk(Chunk a) {
  return Sleef_cinz_expd8_u10avx512fnofma(a);
}
Chunk log_chunk(Chunk a) {
  return Sleef_cinz_logd8_u10avx512fnofma(a);
}
#elif defined(__AVX2__)
auto sincos_chunk(Chunk a) {
  return Sleef_cinz_sincosd4_u10avx(a);
}
Chunk atan2_chunk(Chunk y, Chunk x) {
  return Sleef_cinz_atan2d4_u10avx(y, x);
}
Chunk exp_chunk(Chunk a) {
  return Sleef_cinz_expd4_u10avx(a);
}
Chunk log_chunk(Chunk a) {
  return Sleef_cinz_logd4_u10avx(a);
}
#else
auto sincos_chunk(Chunk a) {
  return Sleef_cinz_sincosd2_u10sse2(a);
}
Chunk atan2_chunk(Chunk y, Chunk x) {
  return Sleef_cinz_atan2d2_u10sse2(y, x);
}
Chunk exp_chunk(Chunk a) {
  return Sleef_cinz_expd2_u10sse2(a);
}
Chunk log_chunk(Chunk a) {
  return Sleef_cinz_logd2_u10sse2(a);
}
#endif

}  // namespace

SineCosine sincos(const poly<double>& radians) {
  issue(InstructionClass::fp64_sincos);
  Lanes<double> sine;
  Lanes<double> cosine;
  for (int i = 0; i < Lanes<double>::kChunks; ++i) {
    const auto both = sincos_chunk(radians.lanes().chunk[i]);
    sine.chunk[i] = both.x;
    cosine.chunk[i] = both.y;
  }
  return {poly<double>(sine), poly<double>(cosine)};
}

poly<double> atan2(const poly<double>& y, const poly<double>& x) {
  issue(InstructionClass::fp64_atan2);
  return poly<double>(
      each_chunk<double>([&](int i) { return atan2_chunk(y.lanes().chunk[i], x.lanes().chunk[i]); }));
}

poly<double> exp(const poly<double>& a) {
  issue(InstructionClass::fp64_exp);
  return poly<double>(each_chunk<double>([&](int i) { return exp_chunk(a.lanes().chunk[i]); }));
}

poly<double> log(const poly<double>& a) {
  issue(InstructionClass::fp64_log);
  return poly<double>(each_chunk<double>([&](int i) { return log_chunk(a.lanes().chunk[i]); }));
}

}  // namespace cn
