// The buffer of a search unit: queries in, answers out, without time.

#include "firmware/cn/chip/search_buffer.hpp"

#include <gtest/gtest.h>

#include "tests/network/search_chain.hpp"

namespace search_buffer_test {

using search_chain::ChainSearch;

class SearchBufferTest : public ::testing::Test {
 protected:
  SearchBufferTest() : mono(1024) {
    for (std::uint64_t i = 0; i < 16; ++i) {
      const ChainSearch::Node node{i * 64 + 128, 100 + i, i % 2 == 0 ? 0u : 32u};
      std::memcpy(mono.data() + i * 64, &node, sizeof(node));
    }
    buffer.program(search);
  }
  void ask(int entry, std::uint64_t first, std::uint64_t nodes) {
    const ChainSearch::Query query{first, nodes};
    buffer.write(std::uint64_t(entry) * 16, reinterpret_cast<const std::uint8_t*>(&query), 16);
  }
  std::uint64_t word(std::uint64_t address) {
    std::uint64_t value = 0;
    buffer.read(address - range.first, reinterpret_cast<std::uint8_t*>(&value), 8, read);
    return value;
  }
  std::uint64_t sum_of(int entry) { return word(places.answers[0] + std::uint64_t(entry) * 8); }
  std::uint64_t end_of(int entry) { return word(places.answers[1] + std::uint64_t(entry) * 8); }

  std::vector<std::uint8_t> mono;
  cn::MonoRange range{4096, 1024};
  std::shared_ptr<ChainSearch> search = std::make_shared<ChainSearch>();
  cn::SearchPlaces places = cn::search_places(range, 16, {8, 8});
  cn::SearchBuffer buffer{range};
  cn::SearchFunction::Read read = [this](cn::MonoAddress from, void* to, std::size_t bytes) {
    std::memcpy(to, mono.data() + from, bytes);
  };
};

TEST_F(SearchBufferTest, ArraysLieBehindEachOther) {
  EXPECT_EQ(places.entries, 28) << "1024 bytes less 2 x 64 for gaps, 32 an entry";
  EXPECT_EQ(places.queries, 4096u);
  EXPECT_EQ(places.answers, (std::vector<cn::MonoAddress>{4096 + 448, 4096 + 448 + 256}));
  EXPECT_EQ(cn::search_places({0, 64}, 16, {8, 8}).entries, 0);
  EXPECT_EQ(buffer.entries(), 28);
}

TEST_F(SearchBufferTest, AnswersAreFoundWhenTheyAreRead) {
  ask(3, 64, 2);
  EXPECT_EQ(search->answered, 0);
  EXPECT_EQ(sum_of(3), 101u + 103u);
  EXPECT_EQ(end_of(3), 320u);
  EXPECT_EQ(search->answered, 1) << "once";
  EXPECT_EQ(sum_of(4), 0u) << "nobody asked";
  ask(3, 0, 1);
  EXPECT_EQ(end_of(3), 128u) << "of the new query";
  EXPECT_EQ(sum_of(3), 100u);
}

TEST_F(SearchBufferTest, StepsAreThoseOfTheAnswer) {
  ask(0, 64, 2);
  const std::vector<cn::SearchStep>& steps = buffer.steps(0, read);
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_EQ(steps[0].from, 64u);
  EXPECT_EQ(steps[1].kind, cn::SearchStep::Kind::leaf);
  EXPECT_EQ(steps[1].from, 128u);
  EXPECT_EQ(steps[2].from, 192u);
  EXPECT_TRUE(buffer.steps(1, read).empty());
}

TEST_F(SearchBufferTest, AQueryInPiecesIsAskedWithItsLastByte) {
  const ChainSearch::Query query{0, 1};
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&query);
  buffer.write(0, bytes, 8);
  EXPECT_EQ(buffer.queries_ended_in(0, 8).last, 0);
  buffer.write(8, bytes + 8, 8);
  EXPECT_EQ(buffer.queries_ended_in(8, 8).last, 1);
  EXPECT_EQ(sum_of(0), 100u);
  ask(0, 0, 1);
  EXPECT_EQ(sum_of(0), 100u);
  EXPECT_EQ(search->answered, 1) << "the same query has the same answer";
}

TEST_F(SearchBufferTest, KnowsWhichEntriesBytesBelongTo) {
  EXPECT_EQ(buffer.queries_ended_in(8, 32).first, 0);
  EXPECT_EQ(buffer.queries_ended_in(8, 32).last, 2);
  EXPECT_EQ(buffer.answers_in(448 + 12, 8).first, 1);
  EXPECT_EQ(buffer.answers_in(448 + 12, 8).last, 3);
  EXPECT_EQ(buffer.answers_in(0, 448).last, 0) << "queries are no answers";
  EXPECT_EQ(buffer.answers_in(448 + 256, 8).last, 1) << "the second part";
}

TEST_F(SearchBufferTest, AnotherFunctionForgetsTheQueries) {
  ask(0, 0, 1);
  buffer.program(search);
  EXPECT_EQ(sum_of(0), 0u);
}

}  // namespace search_buffer_test
