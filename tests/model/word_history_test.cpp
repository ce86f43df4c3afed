#include "model/pio/word_history.hpp"

#include <gtest/gtest.h>

namespace word_history_test {

TEST(WordHistory, InterpolatesWithinARequest) {
  model::WordHistory history(4);
  EXPECT_EQ(history.before(1000), 0u);
  history.add(100, 200, 50);
  EXPECT_EQ(history.before(50), 0u);
  EXPECT_EQ(history.before(100), 0u);
  EXPECT_EQ(history.before(101), 0u);
  EXPECT_EQ(history.before(102), 1u);
  EXPECT_EQ(history.before(150), 25u);
  EXPECT_EQ(history.before(199), 49u);
  EXPECT_EQ(history.before(200), 50u);
  EXPECT_EQ(history.before(5000), 50u);
}

TEST(WordHistory, LooksBackOverSeveralRequests) {
  model::WordHistory history(4);
  history.add(100, 200, 10);
  history.add(300, 400, 20);
  history.add(400, 500, 100);
  EXPECT_EQ(history.before(150), 5u);
  EXPECT_EQ(history.before(250), 10u);
  EXPECT_EQ(history.before(350), 20u);
  EXPECT_EQ(history.before(400), 30u);
  EXPECT_EQ(history.before(450), 80u);
}

TEST(WordHistory, ForgottenRequestsCountAsMoved) {
  model::WordHistory history(2);
  for (model::Cycles i = 0; i < 5; ++i) history.add(100 * i, 100 * i + 100, 10);
  EXPECT_EQ(history.before(350), 35u);
  EXPECT_EQ(history.before(50), 30u);
}

}  // namespace word_history_test
