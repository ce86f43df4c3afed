#include "firmware/cn/math.hpp"

#include <sleef.h>

namespace cn {
namespace {

using Chunk = Lanes<double>::Chunk;

// SLEEF's "cinz" functions are bit-reproducible: the same result on every vector extension, without fused
// multiply-add. One set of names a native width.
#if defined(__AVX512F__)
auto sincos_chunk(Chunk a) {
  return Sleef_cinz_sincosd8_u10avx512fnofma(a);
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

poly<double> exp(const poly<double>& a) {
  issue(InstructionClass::fp64_exp);
  return poly<double>(each_chunk<double>([&](int i) { return exp_chunk(a.lanes().chunk[i]); }));
}

poly<double> log(const poly<double>& a) {
  issue(InstructionClass::fp64_log);
  return poly<double>(each_chunk<double>([&](int i) { return log_chunk(a.lanes().chunk[i]); }));
}

}  // namespace cn
