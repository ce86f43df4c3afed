#include "firmware/examples/monte_carlo_kernels.hpp"

#include <set>

#include "tests/support/strip_fixture.hpp"

namespace taus88_test {

using cn::InstructionClass;
using examples::Taus88;
using test_support::PerPe;
using test_support::store;

class Taus88Test : public test_support::StripFixture {
 protected:
  Taus88Test() {
    const int offset = memory.allocate("state", 12).offset_bytes;
    for (int i = 0; i < 3; ++i) state[i] = {offset + 4 * i};
  }

  void set_state(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    run([&] {
      state[0].write(cn::poly<std::uint32_t>(a));
      state[1].write(cn::poly<std::uint32_t>(b));
      state[2].write(cn::poly<std::uint32_t>(c));
    });
  }

  cn::PolyField<std::uint32_t> state[3];
};

/// The GNU Scientific Library tests its generator `taus` by the 10000th number after gsl_rng_set(1), which
/// seeds by three steps of a congruential generator and drops six numbers.
TEST_F(Taus88Test, GivesTheNumberThatGslTestsFor) {
  const std::uint32_t a = 69069u;
  const std::uint32_t b = 69069u * a;
  set_state(a, b, 69069u * b);
  PerPe<std::uint32_t> found = per_pe<std::uint32_t>();
  run([&] {
    Taus88 random(state);
    for (int i = 0; i < 6 + 9999; ++i) random.next();
    store(found, random.next());
  });
  for (const std::uint32_t number : found) EXPECT_EQ(number, 2733957125u);
}

TEST_F(Taus88Test, GoesOnFromItsSavedState) {
  set_state(1000, 2000, 3000);
  PerPe<std::uint32_t> third = per_pe<std::uint32_t>();
  PerPe<std::uint32_t> resumed = per_pe<std::uint32_t>();
  run([&] {
    Taus88 random(state);
    random.next();
    random.next();
    random.save(state);
    store(third, random.next());
  });
  run([&] { store(resumed, Taus88(state).next()); });
  EXPECT_EQ(resumed, third);
}

/// Cost of a generator (docs/csx600.md, section 6.3): 40 cycles, at 2 a 32-bit operation.
TEST_F(Taus88Test, TakesTwentyOperations) {
  EXPECT_EQ(issued_by([&] {
              Taus88 random(state);
              random.next();
            }),
            test_support::counts({{InstructionClass::int32_alu, 20}, {InstructionClass::sram, 3}}));
}

TEST_F(Taus88Test, EveryPeHasItsOwnStream) {
  examples::SeedRandomArguments arguments;
  for (int i = 0; i < 3; ++i) arguments.word[i] = state[i];
  std::set<std::uint32_t> first_numbers;
  for (const std::uint32_t seed : {0u, 1u, 2u, 0xffffffffu}) {
    arguments.seed = seed;
    run([&] { examples::seed_random(arguments); });
    PerPe<std::uint32_t> words[3] = {per_pe<std::uint32_t>(), per_pe<std::uint32_t>(),
                                     per_pe<std::uint32_t>()};
    PerPe<std::uint32_t> first = per_pe<std::uint32_t>();
    run([&] {
      for (int i = 0; i < 3; ++i) store(words[i], state[i].read());
      store(first, Taus88(state).next());
    });
    for (const PerPe<std::uint32_t>& word : words)
      for (const std::uint32_t bits : word) EXPECT_GE(bits, 16u);
    first_numbers.insert(first.begin(), first.end());
  }
  EXPECT_EQ(first_numbers.size(), std::size_t(4 * num_pes()));
}

}  // namespace taus88_test
