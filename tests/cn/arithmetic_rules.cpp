// A program that ends with 0 if it was compiled with the arithmetic that equal bits on every machine take
// (IEEE 754, each operation rounded once), and otherwise prints the rules that are broken. It is built as the
// kernels are, and with flags that break a rule each.
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace {

/// A value that the compiler cannot compute with in advance.
double at_run_time(double value) {
  volatile double hidden = value;
  return hidden;
}

std::uint64_t bits_of(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// The product is 1 - 2^-54, which rounds to 1, so the sum is 0; rounded once, after the addition, it is
/// -2^-54.
bool rounds_products() {
  const double above = at_run_time(1 + 0x1p-27);
  const double below = at_run_time(1 - 0x1p-27);
  return bits_of(above * below + at_run_time(-1)) == bits_of(0);
}

/// 1 + 1e300 rounds to 1e300, so the difference is 0; in another order it is 1.
bool keeps_order() {
  const double large = at_run_time(1e300);
  const double one = at_run_time(1);
  return bits_of((one + large) - large) == bits_of(0);
}

/// The inverse of 49 is rounded, so some products with it are not the rounded quotients.
bool divides() {
  const double divisor = at_run_time(49);
  const double inverse = at_run_time(1) / divisor;
  const volatile double stored = inverse;  // used at once it would be a quotient of the same numbers
  int different = 0;
  for (int i = 1; i <= 64; ++i) {
    const double numerator = at_run_time(i);
    if (bits_of(numerator / divisor) != bits_of(numerator * stored)) ++different;
  }
  return different > 0;
}

bool has_signed_zeros() {
  return bits_of(at_run_time(-0.0) + 0.0) == bits_of(0.0);
}

bool has_not_a_number() {
  const double zero = at_run_time(0);
  const double undefined = zero / zero;
  return undefined != undefined;
}

/// -ffast-math links a start-up file that switches them off for the whole program.
bool has_denormals() {
  return bits_of(at_run_time(0x1p-1022) * at_run_time(0.5)) == bits_of(0x1p-1023);
}

struct Rule {
  const char* name;
  bool (*holds)();
};

constexpr Rule kRules[] = {
    {"a product is rounded before it is added", rounds_products},
    {"sums keep their order", keeps_order},
    {"a quotient is no product with an inverse", divides},
    {"zeros have signs", has_signed_zeros},
    {"not-a-number is unequal to itself", has_not_a_number},
    {"denormal numbers are not flushed to zero", has_denormals},
};

}  // namespace

int main() {
  int broken = 0;
  for (const Rule& rule : kRules) {
    if (rule.holds()) continue;
    std::printf("broken: %s\n", rule.name);
    ++broken;
  }
  return broken == 0 ? 0 : 1;
}
