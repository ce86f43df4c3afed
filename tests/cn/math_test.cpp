#include "firmware/cn/language/math.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "firmware/cn/language/vec3.hpp"
#include "tests/support/number_samples.hpp"
#include "tests/support/strip_fixture.hpp"

namespace math_test {

using cn::InstructionClass;
using cn::poly;
using cn::vec3;
using test_support::counts;
using test_support::extremes;
using test_support::fill_pairs;
using test_support::load;
using test_support::PerPe;
using test_support::same;
using test_support::store;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Returns the distance in units of the last place of a double of the exact value's size.
double ulps(double found, long double exact) {
  const double rounded = static_cast<double>(exact);
  const double next = std::nextafter(std::abs(rounded), kInfinity);
  return static_cast<double>(std::abs(found - exact) / (static_cast<long double>(next) - std::abs(rounded)));
}

class CnMath : public test_support::StripFixture {
 protected:
  CnMath() : StripFixture(1024) {}

  template <class T, class Function>
  PerPe<T> apply(const PerPe<T>& to, Function function) {
    PerPe<T> values = to;
    values.resize(std::size_t(num_pes()));
    run([&] { store(values, poly<T>(function(load(values)))); });
    values.resize(to.size());
    return values;
  }

  template <class Function>
  double apply_one(double to, Function function) {
    return apply(PerPe<double>{to}, function)[0];
  }

  /// Largest error in ulps over random arguments of both signs (or positive ones), and `hash` of all results.
  template <class Function, class Exact>
  double largest_error(double low, double high, Function function, Exact exact) {
    std::mt19937_64 random(3);
    double largest = 0;
    for (int round = 0; round < 64; ++round) {
      PerPe<double> arguments = per_pe<double>();
      for (double& argument : arguments)
        argument = low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
      const PerPe<double> found = apply(arguments, function);
      for (std::size_t i = 0; i < found.size(); ++i) {
        largest = std::max(largest, ulps(found[i], exact(static_cast<long double>(arguments[i]))));
        std::uint64_t bits;
        std::memcpy(&bits, &found[i], sizeof(bits));
        hash = (hash ^ bits) * 0x100000001b3u;
      }
    }
    return largest;
  }

  std::uint64_t hash = 0xcbf29ce484222325u;
};

const auto sine = [](const poly<double>& a) { return cn::sincos(a).sine; };
const auto cosine = [](const poly<double>& a) { return cn::sincos(a).cosine; };
const auto exponential = [](const poly<double>& a) { return cn::exp(a); };
const auto logarithm = [](const poly<double>& a) { return cn::log(a); };

TEST_F(CnMath, SquareRootIsCorrectlyRounded) {
  PerPe<double> doubles = per_pe<double>();
  PerPe<float> floats = per_pe<float>();
  PerPe<double> unused = doubles;
  PerPe<float> unused_floats = floats;
  fill_pairs(unused, doubles);
  fill_pairs(unused_floats, floats);
  const auto root = [](const auto& a) { return cn::sqrt(a); };
  const PerPe<double> double_roots = apply(doubles, root);
  const PerPe<float> float_roots = apply(floats, root);
  for (std::size_t i = 0; i < doubles.size(); ++i) {
    EXPECT_TRUE(same(double_roots[i], std::sqrt(doubles[i]))) << doubles[i];
    EXPECT_TRUE(same(float_roots[i], std::sqrt(floats[i]))) << floats[i];
  }
  EXPECT_EQ(apply_one(2.0, root), 1.4142135623730951);
}

TEST_F(CnMath, SineAndCosineAreWithinOneUlp) {
  for (const double range : {1e-3, 3.2, 6.3, 1e3, 1e6}) {
    EXPECT_LE(largest_error(-range, range, sine, [](long double a) { return sinl(a); }), 1.0) << range;
    EXPECT_LE(largest_error(-range, range, cosine, [](long double a) { return cosl(a); }), 1.0) << range;
  }
}

TEST_F(CnMath, SineAndCosineOfSpecialValues) {
  EXPECT_EQ(apply_one(0.0, sine), 0.0);
  EXPECT_TRUE(std::signbit(apply_one(-0.0, sine)));
  EXPECT_EQ(apply_one(0.0, cosine), 1.0);
  for (const double a : {kInfinity, -kInfinity, kNan}) {
    EXPECT_TRUE(std::isnan(apply_one(a, sine))) << a;
    EXPECT_TRUE(std::isnan(apply_one(a, cosine))) << a;
  }
}

TEST_F(CnMath, ExponentialIsWithinOneUlp) {
  for (const double range : {1e-3, 1.0, 30.0, 700.0})
    EXPECT_LE(largest_error(-range, range, exponential, [](long double a) { return expl(a); }), 1.0) << range;
}

TEST_F(CnMath, ExponentialOfSpecialValues) {
  EXPECT_EQ(apply_one(0.0, exponential), 1.0);
  EXPECT_EQ(apply_one(-0.0, exponential), 1.0);
  EXPECT_EQ(apply_one(kInfinity, exponential), kInfinity);
  EXPECT_EQ(apply_one(710.0, exponential), kInfinity);
  EXPECT_EQ(apply_one(-kInfinity, exponential), 0.0);
  EXPECT_EQ(apply_one(-1100.0, exponential), 0.0);
  EXPECT_TRUE(std::isnan(apply_one(kNan, exponential)));
}

TEST_F(CnMath, LogarithmIsWithinOneUlp) {
  for (const auto& [low, high] :
       {std::pair(0.9, 1.1), {1e-9, 1.0}, {1.0, 1e9}, {1e-300, 1e-299}, {1e300, 1.7e308}})
    EXPECT_LE(largest_error(low, high, logarithm, [](long double a) { return logl(a); }), 1.0) << low;
  constexpr double kDenormal = 3e-310;
  EXPECT_LE(ulps(apply_one(kDenormal, logarithm), logl(kDenormal)), 1.0);
}

TEST_F(CnMath, LogarithmOfSpecialValues) {
  EXPECT_EQ(apply_one(1.0, logarithm), 0.0);
  EXPECT_EQ(apply_one(0.0, logarithm), -kInfinity);
  EXPECT_EQ(apply_one(kInfinity, logarithm), kInfinity);
  for (const double a : {-1.0, -kInfinity, kNan}) EXPECT_TRUE(std::isnan(apply_one(a, logarithm))) << a;
}

/// The bits that every x86-64 level must give; this test is built for each level. (Taken once from the SSE2
/// build.)
TEST_F(CnMath, EveryLevelGivesTheSameBits) {
  const auto ignore_error = [](long double) { return 0.0L; };
  largest_error(-7.0, 7.0, sine, ignore_error);
  largest_error(-1e6, 1e6, cosine, ignore_error);
  largest_error(-700.0, 700.0, exponential, ignore_error);
  largest_error(1e-9, 1e9, logarithm, ignore_error);
  largest_error(
      0.0, 1e9, [](const auto& a) { return 1.0 / cn::sqrt(a) * 3.0 + a; }, ignore_error);
  EXPECT_EQ(hash, 0xe4bda3e362053dfau);
}

class CnArcTangent : public CnMath {
 protected:
  /// Results for points (x, y), one for each PE.
  PerPe<double> angles(const PerPe<double>& y, const PerPe<double>& x) {
    PerPe<double> found = per_pe<double>();
    run([&] { store(found, cn::atan2(load(y), load(x))); });
    return found;
  }
};

TEST_F(CnArcTangent, IsWithinOneUlpAndTheSameAtEveryLevel) {
  std::mt19937_64 random(4);
  double largest = 0;
  for (int round = 0; round < 64; ++round) {
    PerPe<double> y = per_pe<double>();
    PerPe<double> x = per_pe<double>();
    const auto number = [&] {
      const double mantissa = static_cast<double>(random() >> 11) * 0x1p-52 - 1.0;
      return std::ldexp(mantissa, static_cast<int>(random() % 41) - 20);
    };
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = number(), x[i] = number();
    const PerPe<double> found = angles(y, x);
    for (std::size_t i = 0; i < y.size(); ++i) {
      largest = std::max(largest, ulps(found[i], atan2l(y[i], x[i])));
      std::uint64_t bits;
      std::memcpy(&bits, &found[i], sizeof(bits));
      hash = (hash ^ bits) * 0x100000001b3u;
    }
  }
  EXPECT_LE(largest, 1.0);
  EXPECT_EQ(hash, 8733621676086656265u);
}

TEST_F(CnArcTangent, QuadrantsAndZeros) {
  PerPe<double> y = per_pe(0.0);
  PerPe<double> x = per_pe(0.0);
  const double points[][2] = {{0, 1}, {0, -1}, {1, 0}, {-1, 0}, {0, 0}, {-0.0, -1}, {kNan, 1}, {1, kNan}};
  for (std::size_t i = 0; i < std::size(points); ++i) y[i] = points[i][0], x[i] = points[i][1];
  const PerPe<double> found = angles(y, x);
  for (std::size_t i = 0; i < std::size(points); ++i)
    EXPECT_TRUE(same(found[i], std::atan2(y[i], x[i]))) << y[i] << ", " << x[i];
}

TEST_F(CnMath, SignsAreBits) {
  PerPe<double> a = per_pe<double>();
  PerPe<double> b = per_pe<double>();
  fill_pairs(a, b);
  PerPe<double> magnitude = a;
  PerPe<double> flipped = a;
  run([&] {
    store(magnitude, cn::abs(load(a)));
    store(flipped, cn::flip_sign(load(a), load(b)));
  });
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(same(magnitude[i], std::abs(a[i]))) << a[i];
    EXPECT_TRUE(same(flipped[i], std::signbit(b[i]) ? -a[i] : a[i])) << a[i] << " by " << b[i];
  }
}

template <class T>
void expect_min_max(PerPe<T> a, PerPe<T> b, PerPe<T> smallest, PerPe<T> largest) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(same(smallest[i], b[i] < a[i] ? b[i] : a[i])) << a[i] << " and " << b[i];
    EXPECT_TRUE(same(largest[i], a[i] < b[i] ? b[i] : a[i])) << a[i] << " and " << b[i];
  }
}

TEST_F(CnMath, MinimumAndMaximumCompareAsScalarsDo) {
  const auto check = [&](auto zero) {
    using T = decltype(zero);
    PerPe<T> a = per_pe<T>();
    PerPe<T> b = per_pe<T>();
    PerPe<T> smallest = a;
    PerPe<T> largest = a;
    fill_pairs(a, b);
    run([&] {
      store(smallest, cn::min(load(a), load(b)));
      store(largest, cn::max(load(a), load(b)));
    });
    expect_min_max(a, b, smallest, largest);
  };
  check(0.0);
  check(0.0f);
  check(std::int32_t{});
  check(std::uint64_t{});
}

TEST_F(CnMath, FunctionsIssueTheirOwnClass) {
  const poly<double> a = 2.0;
  const poly<float> f = 2.0f;
  EXPECT_EQ(issued_by([&] { cn::sqrt(a); }), counts({{InstructionClass::fp64_sqrt, 1}}));
  EXPECT_EQ(issued_by([&] { cn::sqrt(f); }), counts({{InstructionClass::fp32_sqrt, 1}}));
  EXPECT_EQ(issued_by([&] { cn::sincos(a); }), counts({{InstructionClass::fp64_sincos, 1}}));
  EXPECT_EQ(issued_by([&] { cn::exp(a); }), counts({{InstructionClass::fp64_exp, 1}}));
  EXPECT_EQ(issued_by([&] { cn::log(a); }), counts({{InstructionClass::fp64_log, 1}}));
  EXPECT_EQ(issued_by([&] { cn::atan2(a, a); }), counts({{InstructionClass::fp64_atan2, 1}}));
  EXPECT_EQ(issued_by([&] { cn::abs(a); }), counts({{InstructionClass::int16_alu, 1}}));
  EXPECT_EQ(issued_by([&] { cn::flip_sign(a, a); }), counts({{InstructionClass::int16_alu, 2}}));
  const auto compare_and_move = counts({{InstructionClass::fp64_add, 1}, {InstructionClass::move, 1}});
  EXPECT_EQ(issued_by([&] { cn::min(a, a); }), compare_and_move);
  EXPECT_EQ(issued_by([&] { cn::max(a, a); }), compare_and_move);
}

class CnVec3 : public CnMath {
 protected:
  CnVec3() {
    std::mt19937_64 random(9);
    for (PerPe<double>* component : {&a.x, &a.y, &a.z, &b.x, &b.y, &b.z}) {
      *component = per_pe<double>();
      for (double& value : *component) value = test_support::random_value<double>(random);
    }
  }
  static vec3<poly<double>> load3(const vec3<PerPe<double>>& v) { return {load(v.x), load(v.y), load(v.z)}; }
  static vec3<double> at(const vec3<PerPe<double>>& v, std::size_t i) { return {v.x[i], v.y[i], v.z[i]}; }

  template <class Expected>
  void expect_each(const vec3<PerPe<double>>& found, Expected expected) {
    for (std::size_t i = 0; i < found.x.size(); ++i) {
      const vec3<double> e = expected(i);
      EXPECT_TRUE(same(found.x[i], e.x) && same(found.y[i], e.y) && same(found.z[i], e.z)) << i;
    }
  }

  template <class Function, class Expected>
  void expect_vector(const cn::IssueCounts& issued, Function function, Expected expected) {
    vec3<PerPe<double>> found = a;
    EXPECT_EQ(issued_by([&] {
                const vec3<poly<double>> result = function();
                store(found.x, result.x);
                store(found.y, result.y);
                store(found.z, result.z);
              }),
              issued);
    expect_each(found, expected);
  }

  vec3<PerPe<double>> a;
  vec3<PerPe<double>> b;
  const vec3<double> mono{0.5, -3.0, 7.25};
};

TEST_F(CnVec3, AddsAndScalesByComponent) {
  const auto three_adds = counts({{InstructionClass::fp64_add, 3}});
  const auto three_muls = counts({{InstructionClass::fp64_mul, 3}});
  expect_vector(
      three_adds, [&] { return load3(a) + mono; },
      [&](std::size_t i) {
        return vec3<double>{a.x[i] + 0.5, a.y[i] - 3.0, a.z[i] + 7.25};
      });
  expect_vector(
      three_adds, [&] { return mono - load3(a); },
      [&](std::size_t i) {
        return vec3<double>{0.5 - a.x[i], -3.0 - a.y[i], 7.25 - a.z[i]};
      });
  expect_vector(
      three_muls, [&] { return load3(a) * load3(b); },
      [&](std::size_t i) {
        return vec3<double>{a.x[i] * b.x[i], a.y[i] * b.y[i], a.z[i] * b.z[i]};
      });
  expect_vector(
      three_muls, [&] { return mono * load(b.y); },
      [&](std::size_t i) {
        return vec3<double>{0.5 * b.y[i], -3.0 * b.y[i], 7.25 * b.y[i]};
      });
  expect_vector(
      three_muls, [&] { return load3(a) * -2.0; },
      [&](std::size_t i) {
        return vec3<double>{a.x[i] * -2.0, a.y[i] * -2.0, a.z[i] * -2.0};
      });
}

TEST_F(CnVec3, CrossProductIsTheDeterminant) {
  const auto cross = [](const vec3<double>& u, const vec3<double>& v) {
    return vec3<double>{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  };
  const auto issued = counts({{InstructionClass::fp64_mul, 6}, {InstructionClass::fp64_add, 3}});
  expect_vector(
      issued, [&] { return cn::cross(load3(a), load3(b)); },
      [&](std::size_t i) { return cross(at(a, i), at(b, i)); });
  expect_vector(
      issued, [&] { return cn::cross(mono, load3(b)); },
      [&](std::size_t i) { return cross(mono, at(b, i)); });
  const vec3<double> z = cn::cross(vec3<double>{1, 0, 0}, vec3<double>{0, 1, 0});
  EXPECT_EQ(z.x, 0.0);
  EXPECT_EQ(z.y, 0.0);
  EXPECT_EQ(z.z, 1.0);
}

TEST_F(CnVec3, DotProduct) {
  PerPe<double> found = per_pe<double>();
  const auto issued = counts({{InstructionClass::fp64_mul, 3}, {InstructionClass::fp64_add, 2}});
  EXPECT_EQ(issued_by([&] { store(found, cn::dot(load3(a), mono)); }), issued);
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_TRUE(same(found[i], a.x[i] * 0.5 + a.y[i] * -3.0 + a.z[i] * 7.25));
  EXPECT_EQ(cn::dot(vec3<double>{1, 2, 3}, vec3<double>{4, -5, 6}), 12.0);
}

TEST_F(CnVec3, SelectsWholeVectors) {
  expect_vector(
      counts({{InstructionClass::move, 3}, {InstructionClass::sram, 1}, {InstructionClass::int32_alu, 1}}),
      [&] { return cn::select(cn::pe_num() < 100, load3(a), load3(b)); },
      [&](std::size_t i) { return at(i < 100 ? a : b, i); });
}

}  // namespace math_test
