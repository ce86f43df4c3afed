#include "firmware/cn/language/poly.hpp"

#include <functional>
#include <set>

#include "tests/support/number_samples.hpp"
#include "tests/support/strip_fixture.hpp"

namespace poly_test {

using cn::InstructionClass;
using cn::mask;
using cn::poly;
using test_support::counts;
using test_support::extremes;
using test_support::fill_pairs;
using test_support::load;
using test_support::PerPe;
using test_support::same;
using test_support::store;

/// Scalar arithmetic; integers modulo 2^bits.
template <class T, class Operation>
T scalar(Operation operation, T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    return operation(a, b);
  } else {
    return static_cast<T>(operation(static_cast<std::uint64_t>(a), static_cast<std::uint64_t>(b)));
  }
}

template <class T>
class CnPoly : public test_support::StripFixture {
 protected:
  CnPoly() : StripFixture(1024), a(per_pe<T>()), b(per_pe<T>()) { fill_pairs(a, b); }

  // Type-erased, so that all kernels have one type: GCC takes a second for each type.
  using OnPoly = std::function<poly<T>(const poly<T>&, const poly<T>&)>;
  using OnScalar = std::function<T(T, T)>;

  void expect_same(const char* what, const OnPoly& on_poly, const OnScalar& on_scalar) {
    PerPe<T> found = per_pe<T>();
    PerPe<T> expected = per_pe<T>();
    run([&] { store(found, on_poly(load(a), load(b))); });
    for (std::size_t i = 0; i < a.size(); ++i) expected[i] = on_scalar(a[i], b[i]);
    compare(what, found, expected);
  }

  void compare(const char* what, const PerPe<T>& found, const PerPe<T>& expected) {
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!same(found[i], expected[i]))
        ADD_FAILURE() << a[i] << " " << what << " " << b[i] << ": " << found[i] << ", not " << expected[i];
  }

  /// Tries poly with poly, and a mono operand on each side.
  template <class Operation>
  void expect_same_operation(const char* what, Operation operation) {
    const auto on_scalar = [&](T x, T y) { return scalar(operation, x, y); };
    expect_same(what, operation, on_scalar);
    for (const T mono : extremes<T>()) {
      expect_same(
          what, [&](const auto& x, const auto&) { return operation(x, mono); },
          [&](T x, T) { return on_scalar(x, mono); });
      expect_same(
          what, [&](const auto&, const auto& y) { return operation(mono, y); },
          [&](T, T y) { return on_scalar(mono, y); });
    }
  }

  void expect_same_condition(const char* what,
                             const std::function<mask(const poly<T>&, const poly<T>&)>& operation,
                             const std::function<bool(T, T)>& on_scalar) {
    PerPe<char> found = per_pe<char>();
    run([&] { store(found, operation(load(a), load(b))); });
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_EQ(bool(found[i]), on_scalar(a[i], b[i])) << a[i] << what << b[i];
  }

  PerPe<T> a;
  PerPe<T> b;
};

using Types =
    testing::Types<double, float, std::int16_t, std::int32_t, std::uint32_t, std::int64_t, std::uint64_t>;
TYPED_TEST_SUITE(CnPoly, Types);

TYPED_TEST(CnPoly, AddsSubtractsMultipliesAsScalarsDo) {
  this->expect_same_operation("+", [](auto x, auto y) { return x + y; });
  this->expect_same_operation("-", [](auto x, auto y) { return x - y; });
  this->expect_same_operation("*", [](auto x, auto y) { return x * y; });
  this->expect_same(
      "negated, not", [](const auto& x, const auto&) { return -x; },
      [](TypeParam x, TypeParam) {
        if constexpr (std::is_floating_point_v<TypeParam>) return -x;
        return static_cast<TypeParam>(std::uint64_t{0} - static_cast<std::uint64_t>(x));
      });
}

TYPED_TEST(CnPoly, DividesFloatingPoint) {
  if constexpr (std::is_floating_point_v<TypeParam>) {
    this->expect_same_operation("/", [](auto x, auto y) { return x / y; });
  }
}

TYPED_TEST(CnPoly, CombinesAndShiftsBits) {
  if constexpr (std::is_integral_v<TypeParam>) {
    this->expect_same_operation("&", [](auto x, auto y) { return x & y; });
    this->expect_same_operation("|", [](auto x, auto y) { return x | y; });
    this->expect_same_operation("^", [](auto x, auto y) { return x ^ y; });
    for (int bits = 0; bits < int(8 * sizeof(TypeParam)); ++bits) {
      this->expect_same(
          "<<", [&](const auto& x, const auto&) { return x << bits; },
          [&](TypeParam x, TypeParam) { return static_cast<TypeParam>(std::uint64_t(x) << bits); });
      this->expect_same(
          ">>", [&](const auto& x, const auto&) { return x >> bits; },
          [&](TypeParam x, TypeParam) { return static_cast<TypeParam>(x >> bits); });
    }
  }
}

TYPED_TEST(CnPoly, ComparesAsScalarsDo) {
  this->expect_same_condition(
      " < ", [](auto x, auto y) { return x < y; }, [](auto x, auto y) { return x < y; });
  this->expect_same_condition(
      " <= ", [](auto x, auto y) { return x <= y; }, [](auto x, auto y) { return x <= y; });
  this->expect_same_condition(
      " > ", [](auto x, auto y) { return x > y; }, [](auto x, auto y) { return x > y; });
  this->expect_same_condition(
      " >= ", [](auto x, auto y) { return x >= y; }, [](auto x, auto y) { return x >= y; });
  this->expect_same_condition(
      " == ", [](auto x, auto y) { return x == y; }, [](auto x, auto y) { return x == y; });
  this->expect_same_condition(
      " != ", [](auto x, auto y) { return x != y; }, [](auto x, auto y) { return x != y; });
}

TYPED_TEST(CnPoly, MonoValueReachesEveryPe) {
  for (const TypeParam mono : extremes<TypeParam>())
    this->expect_same(
        "broadcast", [&](const auto&, const auto&) { return poly<TypeParam>(mono); },
        [&](TypeParam, TypeParam) { return mono; });
}

TYPED_TEST(CnPoly, AssignmentReachesEnabledPesOnly) {
  PerPe<TypeParam> assigned = this->a;
  PerPe<TypeParam> renamed = this->a;
  PerPe<TypeParam> fresh = this->a;
  cn::LaneMask enabled;
  for (int pe = 0; pe < this->num_pes(); ++pe) enabled.set(pe, pe % 3 == 1);
  this->run(enabled, [&] {
    poly<TypeParam> x = load(this->a);
    x = load(this->b);
    store(assigned, x);
    poly<TypeParam> y = load(this->a);
    y.assign_all_lanes(load(this->b));
    store(renamed, y);
    const poly<TypeParam> copy = y;
    store(fresh, copy);
  });
  for (std::size_t i = 0; i < this->a.size(); ++i) {
    EXPECT_TRUE(same(assigned[i], i % 3 == 1 ? this->b[i] : this->a[i])) << i;
    EXPECT_TRUE(same(renamed[i], this->b[i])) << i;
    EXPECT_TRUE(same(fresh[i], this->b[i])) << i;
  }
}

TYPED_TEST(CnPoly, CompoundAssignmentIsMaskedToo) {
  const auto check = [&](auto compound, auto plain) {
    PerPe<TypeParam> found = this->a;
    cn::LaneMask enabled;
    for (int pe = 0; pe < this->num_pes(); ++pe) enabled.set(pe, pe % 5 != 2);
    this->run(enabled, [&] {
      poly<TypeParam> x = load(this->a);
      compound(x, load(this->b));
      store(found, x);
    });
    for (std::size_t i = 0; i < this->a.size(); ++i)
      EXPECT_TRUE(same(found[i], i % 5 != 2 ? scalar(plain, this->a[i], this->b[i]) : this->a[i])) << i;
  };
  check([](auto& x, const auto& y) { x += y; }, [](auto x, auto y) { return x + y; });
  check([](auto& x, const auto& y) { x -= y; }, [](auto x, auto y) { return x - y; });
  check([](auto& x, const auto& y) { x *= y; }, [](auto x, auto y) { return x * y; });
}

TYPED_TEST(CnPoly, SelectTakesBitsUnchangedFromEitherSide) {
  this->expect_same(
      "select", [](const auto& x, const auto& y) { return cn::select(cn::pe_num() < 300, x, y); },
      [at = 0](TypeParam x, TypeParam y) mutable { return at++ < 300 ? x : y; });
}

/// Each operator is one instruction of the type's class.
TYPED_TEST(CnPoly, IssuesOneInstructionAnOperator) {
  using Traits = cn::PolyTraits<TypeParam>;
  const poly<TypeParam> x(TypeParam(3));
  const poly<TypeParam> y(TypeParam(2));
  poly<TypeParam> variable = x;
  const TypeParam mono(7);
  const auto add = counts({{Traits::kAdd, 1}});
  const auto mul = counts({{Traits::kMul, 1}});
  const auto issues = [&](const cn::IssueCounts& expected, const std::function<void()>& operation) {
    EXPECT_EQ(this->issued_by(operation), expected);
  };
  issues(add, [&] { x + y; });
  issues(add, [&] { x + mono; });
  issues(add, [&] { mono + x; });
  issues(add, [&] { x - y; });
  issues(add, [&] { x - mono; });
  issues(add, [&] { mono - x; });
  issues(add, [&] { -x; });
  issues(mul, [&] { x* y; });
  issues(mul, [&] { x* mono; });
  issues(mul, [&] { mono* x; });
  issues(add, [&] { (void)(x < y); });
  issues(add, [&] { (void)(x <= y); });
  issues(add, [&] { (void)(x > y); });
  issues(add, [&] { (void)(x >= mono); });
  issues(add, [&] { (void)(x == y); });
  issues(add, [&] { (void)(x != y); });
  if constexpr (std::is_floating_point_v<TypeParam>) {
    issues(counts({{Traits::kDiv, 1}}), [&] { x / y; });
    issues(counts({{Traits::kDiv, 1}}), [&] { x / mono; });
    issues(counts({{Traits::kDiv, 1}}), [&] { mono / x; });
  } else {
    issues(add, [&] { x& y; });
    issues(add, [&] { x | y; });
    issues(add, [&] { x ^ y; });
    issues(add, [&] { x >> 1; });
    issues(add, [&] { x << 1; });
  }
  issues(counts({{InstructionClass::move, 1}}), [&] { variable = y; });
  issues(counts({{InstructionClass::move, 1}, {Traits::kAdd, 1}}), [&] { variable += y; });
  issues(counts({{InstructionClass::move, 1}}), [&] { cn::select(mask{}, x, y); });
  issues(counts({}), [&] {
    poly<TypeParam> copy = x;
    copy.assign_all_lanes(y);
  });
}

TEST(CnPolyClasses, BelongToTheType) {
  const auto classes = [](auto zero) {
    using Traits = cn::PolyTraits<decltype(zero)>;
    return std::pair(Traits::kAdd, Traits::kMul);
  };
  EXPECT_EQ(classes(0.0), std::pair(InstructionClass::fp64_add, InstructionClass::fp64_mul));
  EXPECT_EQ(classes(0.0f), std::pair(InstructionClass::fp32_add, InstructionClass::fp32_mul));
  EXPECT_EQ(classes(std::int16_t{}), std::pair(InstructionClass::int16_alu, InstructionClass::int16_mul));
  EXPECT_EQ(classes(std::int32_t{}), std::pair(InstructionClass::int32_alu, InstructionClass::int32_mul));
  EXPECT_EQ(classes(std::uint32_t{}), std::pair(InstructionClass::int32_alu, InstructionClass::int32_mul));
  EXPECT_EQ(classes(std::int64_t{}), std::pair(InstructionClass::int64_alu, InstructionClass::int64_mul));
  EXPECT_EQ(classes(std::uint64_t{}), std::pair(InstructionClass::int64_alu, InstructionClass::int64_mul));
  EXPECT_EQ(cn::PolyTraits<double>::kDiv, InstructionClass::fp64_div);
  EXPECT_EQ(cn::PolyTraits<float>::kDiv, InstructionClass::fp32_div);
  EXPECT_EQ(
      std::set<std::string_view>(cn::kInstructionClassNames.begin(), cn::kInstructionClassNames.end()).size(),
      cn::kInstructionClasses);
}

}  // namespace poly_test
