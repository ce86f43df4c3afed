#include "firmware/cn/language/mask4.hpp"

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "tests/support/number_samples.hpp"
#include "tests/support/strip_fixture.hpp"

namespace poly4_test {

using cn::Indices4;
using cn::InstructionClass;
using cn::mono4;
using cn::poly;
using cn::poly4;
using cn::PolyArray;
using test_support::counts;
using test_support::load;
using test_support::PerPe;
using test_support::store;

template <class T>
class CnPoly4 : public test_support::StripFixture {
 protected:
  CnPoly4() {
    for (int e = 0; e < 4; ++e) {
      for (PerPe<T>* values : {&first[e], &second[e], &third[e]}) *values = per_pe<T>();
      for (int pe = 0; pe < num_pes(); ++pe) {
        first[e][std::size_t(pe)] = T(1) / T(3 + pe + 7 * e);
        second[e][std::size_t(pe)] = T(-2) / T(5 + 3 * pe + e);
        third[e][std::size_t(pe)] = T(0.7) * T(pe - 11 * e);
      }
    }
  }

  static poly4<T> vector(const PerPe<T> (&values)[4]) {
    return {load(values[0]), load(values[1]), load(values[2]), load(values[3])};
  }

  /// `expected` takes a PE and an element.
  void expect(const std::function<poly4<T>()>& operation,
              const std::function<T(std::size_t, std::size_t)>& expected) {
    PerPe<T> found[4] = {per_pe<T>(), per_pe<T>(), per_pe<T>(), per_pe<T>()};
    run([&] {
      const poly4<T> result = operation();
      for (int e = 0; e < 4; ++e) store(found[e], result[e]);
    });
    for (std::size_t e = 0; e < 4; ++e)
      for (std::size_t pe = 0; pe < std::size_t(num_pes()); ++pe)
        EXPECT_TRUE(test_support::same(found[e][pe], expected(pe, e))) << "PE " << pe << " element " << e;
  }

  PerPe<T> first[4];
  PerPe<T> second[4];
  PerPe<T> third[4];
  const T mono = T(1) / T(7);
  const mono4<T> monos = {T(0.1), T(-0.2), T(0.3), T(1e10)};
};

using Types = testing::Types<double, float>;
TYPED_TEST_SUITE(CnPoly4, Types);

TYPED_TEST(CnPoly4, ElementsAreComputedAsScalarsAre) {
  const auto a = [&] { return this->vector(this->first); };
  const auto b = [&] { return this->vector(this->second); };
  const auto& x = this->first;
  const auto& y = this->second;
  this->expect([&] { return a() + b(); }, [&](auto pe, auto e) { return x[e][pe] + y[e][pe]; });
  this->expect([&] { return a() - b(); }, [&](auto pe, auto e) { return x[e][pe] - y[e][pe]; });
  this->expect([&] { return a() * b(); }, [&](auto pe, auto e) { return x[e][pe] * y[e][pe]; });
}

TYPED_TEST(CnPoly4, MonoOperandIsOneValueOrOneForEachElement) {
  const auto a = [&] { return this->vector(this->first); };
  const auto& x = this->first;
  this->expect([&] { return a() * this->mono; }, [&](auto pe, auto e) { return x[e][pe] * this->mono; });
  this->expect([&] { return a() * this->monos; }, [&](auto pe, auto e) { return x[e][pe] * this->monos[e]; });
  this->expect([&] { return a() + this->monos; }, [&](auto pe, auto e) { return x[e][pe] + this->monos[e]; });
}

/// Kernels are also compiled for machines with fused multiply-add.
TYPED_TEST(CnPoly4, MultiplyAddRoundsTwice) {
  const auto& x = this->first;
  const auto& y = this->second;
  const auto& z = this->third;
  this->expect([&] { return multiply_add(this->vector(x), this->vector(y), this->vector(z)); },
               [&](auto pe, auto e) {
                 volatile TypeParam product = x[e][pe] * y[e][pe];
                 return product + z[e][pe];
               });
  this->expect([&] { return multiply_subtract(this->vector(x), this->mono, this->vector(z)); },
               [&](auto pe, auto e) {
                 volatile TypeParam product = x[e][pe] * this->mono;
                 return product - z[e][pe];
               });
}

TYPED_TEST(CnPoly4, IssuesOneVectorInstructionAndItsMonoOperands) {
  using Traits = cn::Vector4Traits<TypeParam>;
  const poly<TypeParam> one(TypeParam(1));
  const poly4<TypeParam> a(one, one, one, one);
  const auto issues = [&](const cn::IssueCounts& expected, const std::function<void()>& operation) {
    EXPECT_EQ(this->issued_by(operation), expected);
  };
  issues(counts({{Traits::kAdd, 1}}), [&] { a + a; });
  issues(counts({{Traits::kAdd, 1}, {InstructionClass::mono, 1}}), [&] { a - this->mono; });
  issues(counts({{Traits::kMul, 1}, {InstructionClass::mono, 4}}), [&] { a* this->monos; });
  issues(counts({{Traits::kMultiplyAdd, 1}}), [&] { multiply_add(a, a, a); });
  issues(counts({{Traits::kMultiplyAdd, 1}, {InstructionClass::mono, 1}}),
         [&] { multiply_subtract(a, this->mono, a); });
  issues(counts({{InstructionClass::move, 4}}), [&] { select(cn::mask{}, a, a); });
  issues(counts({}), [&] {
    poly4<TypeParam> copy = a;
    copy.assign_all_lanes(a);
  });
}

TYPED_TEST(CnPoly4, ComparesElementByElement) {
  using cn::mask4;
  const TypeParam middle = this->first[1][3];
  const auto expect = [&](const std::function<mask4()>& compare, const auto& expected) {
    PerPe<char> found[4];
    for (PerPe<char>& of_element : found) of_element = this->template per_pe<char>();
    const cn::IssueCounts issued = this->issued_by([&] {
      const mask4 flags = compare();
      for (std::size_t e = 0; e < 4; ++e) store(found[e], flags[e]);
    });
    for (std::size_t e = 0; e < 4; ++e)
      for (std::size_t pe = 0; pe < std::size_t(this->num_pes()); ++pe)
        EXPECT_EQ(bool(found[e][pe]), expected(this->first[e][pe])) << "PE " << pe << " element " << e;
    EXPECT_EQ(issued[cn::Vector4Traits<TypeParam>::kAdd], 1u);
    EXPECT_EQ(issued[InstructionClass::int16_alu], 4u);
  };
  const auto a = [&] { return this->vector(this->first); };
  const auto same = [&] {
    const poly<TypeParam> m(middle);
    return poly4<TypeParam>(m, m, m, m);
  };
  expect([&] { return a() < middle; }, [&](TypeParam x) { return x < middle; });
  expect([&] { return a() <= same(); }, [&](TypeParam x) { return x <= middle; });
  expect([&] { return a() >= middle; }, [&](TypeParam x) { return x >= middle; });
  expect([&] { return a() == same(); }, [&](TypeParam x) { return x == middle; });
}

using CnSigns4 = CnPoly4<double>;
TEST_F(CnSigns4, AreThoseOfEachElement) {
  expect([&] { return abs(vector(third)); }, [&](auto pe, auto e) { return std::abs(third[e][pe]); });
  expect([&] { return flip_sign(vector(first), vector(third)); },
         [&](auto pe, auto e) { return std::signbit(third[e][pe]) ? -first[e][pe] : first[e][pe]; });
}

TEST(CnPoly4Classes, BelongToTheType) {
  EXPECT_EQ(cn::Vector4Traits<double>::kAdd, InstructionClass::fp64_add_vector4);
  EXPECT_EQ(cn::Vector4Traits<double>::kMul, InstructionClass::fp64_mul_vector4);
  EXPECT_EQ(cn::Vector4Traits<double>::kMultiplyAdd, InstructionClass::fp64_multiply_add_vector4);
  EXPECT_EQ(cn::Vector4Traits<float>::kAdd, InstructionClass::fp32_add_vector4);
  EXPECT_EQ(cn::Vector4Traits<float>::kMul, InstructionClass::fp32_mul_vector4);
  EXPECT_EQ(cn::Vector4Traits<float>::kMultiplyAdd, InstructionClass::fp32_multiply_add_vector4);
}

class CnPolyArray : public test_support::StripFixture {
 protected:
  static constexpr int kElements = 16;
  static constexpr Indices4 kScattered = {3, 0, 15, 8};

  CnPolyArray() {
    memory.allocate("before", 24);
    span = memory.allocate("array", 8 * kElements);
    for (int e = 0; e < kElements; ++e)
      for (int pe = 0; pe < num_pes(); ++pe) word(e, pe) = value(e, pe);
  }

  std::uint64_t& word(int element, int pe) { return memory.word(pe, span.offset_bytes + 8 * element); }
  static std::uint64_t value(int element, int pe) { return std::uint64_t(1000 * element + pe); }

  cn::PolySpan span;
};

TEST_F(CnPolyArray, FourPlacesAreLoadedInTheOrderAskedFor) {
  const PolyArray<std::uint64_t> array(span);
  PerPe<std::uint64_t> found[4] = {per_pe<std::uint64_t>(), per_pe<std::uint64_t>(), per_pe<std::uint64_t>(),
                                   per_pe<std::uint64_t>()};
  run([&] {
    const auto loaded = array.load(kScattered);
    for (int e = 0; e < 4; ++e) store(found[e], loaded[e]);
  });
  for (std::size_t e = 0; e < 4; ++e)
    for (int pe = 0; pe < num_pes(); ++pe) EXPECT_EQ(found[e][std::size_t(pe)], value(kScattered[e], pe));
}

TEST_F(CnPolyArray, StoreReachesEnabledPesOnly) {
  const PolyArray<std::uint64_t> array(span);
  cn::LaneMask enabled;
  for (int pe = 0; pe < num_pes(); ++pe) enabled.set(pe, pe % 3 == 1);
  run(enabled, [&] {
    const poly<std::uint64_t> new_value(std::uint64_t{77});
    array.store(kScattered, {new_value, new_value, new_value, new_value});
  });
  for (int e = 0; e < kElements; ++e)
    for (int pe = 0; pe < num_pes(); ++pe) {
      const bool stored = (e == 3 || e == 0 || e == 15 || e == 8) && pe % 3 == 1;
      EXPECT_EQ(word(e, pe), stored ? 77u : value(e, pe)) << e << " of PE " << pe;
    }
}

/// Values travel from strip to strip, too.
TEST_F(CnPolyArray, SwazzleBringsWhatThePeSoManyStepsAwayHas) {
  const PolyArray<std::uint64_t> array(span);
  for (const int steps : {1, -1, 5, -8, 16, -23, 24}) {
    PerPe<std::uint64_t> found = per_pe<std::uint64_t>();
    run([&] { store(found, array.swazzle(kScattered, steps)[2]); });
    for (int pe = 0; pe < num_pes(); ++pe) {
      const bool beyond = pe - steps < 0 || pe - steps >= num_pes();
      EXPECT_EQ(found[std::size_t(pe)], value(15, beyond ? pe : pe - steps)) << steps << " PE " << pe;
    }
  }
}

TEST_F(CnPolyArray, AccessesCountWordsAndSteps) {
  const PolyArray<std::uint64_t> array(span);
  const poly<std::uint64_t> zero(std::uint64_t{0});
  EXPECT_EQ(issued_by([&] { array.load(kScattered); }), counts({{InstructionClass::sram_vector_load, 8}}));
  EXPECT_EQ(issued_by([&] {
              array.store(kScattered, {zero, zero, zero, zero});
            }),
            counts({{InstructionClass::sram, 8}}));
  EXPECT_EQ(issued_by([&] { array.swazzle(kScattered, -5); }),
            counts({{InstructionClass::swazzle_vector4, 5}}));
  EXPECT_EQ(issued_by([&] { array.load_and_swazzle(kScattered, 2); }),
            counts({{InstructionClass::sram_vector_load, 8}, {InstructionClass::swazzle_vector4, 2}}));
}

/// Walks along the path, register by register: each step brings the right neighbour's vector. Before each
/// `feeders` steps the last PEs take another vector of their own.
class Walk {
 public:
  Walk(int num_pes, int feeders) : at_(std::size_t(num_pes)), feeders_(feeders) {
    for (int pe = 0; pe < num_pes; ++pe) at_[std::size_t(pe)] = {0, pe};
    feed(0);
  }
  void step(int number) {
    for (std::size_t pe = 0; pe + 1 < at_.size(); ++pe) at_[pe] = at_[pe + 1];
    if (number % feeders_ == 0) feed(number / feeders_);
  }
  /// Returns the place and the PE from which PE `pe`'s value was loaded.
  std::pair<int, int> source(int pe) const { return at_[std::size_t(pe)]; }

 private:
  void feed(int turn) {
    for (std::size_t pe = at_.size() - std::size_t(feeders_); pe < at_.size(); ++pe)
      at_[pe] = {4 + 4 * turn, int(pe)};
  }

  std::vector<std::pair<int, int>> at_;
  int feeders_;
};

TEST_F(CnPolyArray, StreamBringsWhatAWalkAlongThePathDoes) {
  const PolyArray<std::uint64_t> array(span);
  for (const int feeders : {1, 5, 8, 11}) {
    const cn::VectorStream<std::uint64_t> stream(array, 0, array, 4, feeders);
    Walk walk(num_pes(), feeders);
    for (int steps = 0; steps < 3 * feeders; ++steps) {
      if (steps > 0) walk.step(steps);
      PerPe<std::uint64_t> found[4] = {per_pe<std::uint64_t>(), per_pe<std::uint64_t>(),
                                       per_pe<std::uint64_t>(), per_pe<std::uint64_t>()};
      run([&] {
        const auto brought = stream.after(steps);
        for (int e = 0; e < 4; ++e) store(found[e], brought[e]);
      });
      for (int pe = 0; pe < num_pes() - feeders; ++pe)
        for (int e = 0; e < 4; ++e)
          EXPECT_EQ(found[e][std::size_t(pe)], value(walk.source(pe).first + e, walk.source(pe).second))
              << feeders << " feeders, step " << steps << ", PE " << pe;
    }
  }
}

/// Strips are executed one after the other. PEs before the feeders end with the value of 8 PEs to the right.
TEST_F(CnPolyArray, StreamMayLeaveItsVectorsWhereTheyStarted) {
  const PolyArray<std::uint64_t> array(span);
  const cn::VectorStream<std::uint64_t> stream(array, 0, array, 4, 8);
  run([&] { array.store(cn::four_from(0), stream.after(8)); });
  for (int pe = 0; pe < num_pes() - 8; ++pe)
    EXPECT_EQ(word(1, pe), value(pe + 8 < num_pes() - 8 ? 1 : 5, pe + 8)) << pe;
}

TEST_F(CnPolyArray, StreamCostsAStepForEachVectorAndAnEnabledLoadForEachFeeding) {
  const PolyArray<std::uint64_t> array(span);
  const cn::VectorStream<std::uint64_t> stream(array, 0, array, 4, 8);
  EXPECT_EQ(issued_by([&] { stream.after(0); }), counts({{InstructionClass::sram_vector_load, 8}}));
  EXPECT_EQ(issued_by([&] { stream.after(7); }), counts({{InstructionClass::swazzle_vector4, 1}}));
  EXPECT_EQ(issued_by([&] { stream.feed(); }),
            counts({{InstructionClass::enable, 2}, {InstructionClass::sram_vector_load, 8}}));
}

}  // namespace poly4_test
