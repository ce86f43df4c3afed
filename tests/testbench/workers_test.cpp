#include "testbench/system/workers.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

namespace workers_test {

using testbench::Workers;

constexpr int kForEver = 20'000;

/// A worker that counts its orders and crashes on request.
Workers::Answer counting() {
  return [orders = 0](const std::string& order) mutable {
    if (order == "crash") std::abort();
    return order + " " + std::to_string(++orders) + " of " + std::to_string(getpid());
  };
}

std::string answer(Workers& workers, int worker, const std::string& order) {
  workers.send(worker, order);
  const auto reply = workers.next(kForEver);
  EXPECT_TRUE(reply && reply->worker == worker);
  return reply ? reply->text.value_or("crashed") : "no reply";
}

TEST(Workers, KeepWhatTheyHaveBetweenOrders) {
  Workers workers(2, counting);
  EXPECT_EQ(answer(workers, 0, "a").rfind("a 1 of ", 0), 0u);
  EXPECT_EQ(answer(workers, 0, "b").rfind("b 2 of ", 0), 0u);
  EXPECT_EQ(answer(workers, 1, "c").rfind("c 1 of ", 0), 0u);
}

TEST(Workers, WorkAtTheSameTime) {
  Workers workers(3, [] {
    return [](const std::string& order) {
      std::this_thread::sleep_for(std::chrono::milliseconds(order == "slow" ? 300 : 0));
      return order;
    };
  });
  workers.send(0, "slow");
  workers.send(1, "fast");
  EXPECT_EQ(workers.next(kForEver)->worker, 1);
  EXPECT_EQ(workers.next(kForEver)->worker, 0);
  EXPECT_FALSE(workers.next(10));
}

TEST(Workers, OneThatCrashesIsReplaced) {
  Workers workers(2, counting);
  answer(workers, 0, "a");
  EXPECT_EQ(answer(workers, 0, "crash"), "crashed");
  EXPECT_EQ(answer(workers, 0, "b").rfind("b 1 of ", 0), 0u);
}

TEST(Workers, TakeLongOrdersAndAnswers) {
  Workers workers(1, [] { return [](const std::string& order) { return order + order; }; });
  const std::string order(3'000'000, 'x');
  EXPECT_EQ(answer(workers, 0, order).size(), 2 * order.size());
}

TEST(Workers, EndWithTheProcessThatStartedThem) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    Workers workers(1, counting);
    const std::string text = answer(workers, 0, "a");
    const pid_t worker = std::atoi(text.substr(text.rfind(' ') + 1).c_str());
    if (write(ends[1], &worker, sizeof(worker)) != sizeof(worker)) _exit(1);
    pause();
  }
  pid_t worker = 0;
  ASSERT_EQ(read(ends[0], &worker, sizeof(worker)), ssize_t(sizeof(worker)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  // A zombie accepts signal 0 until it is reaped, so the test reads the process's state.
  const auto runs = [&] {
    const std::string state = "/proc/" + std::to_string(worker) + "/stat";
    return std::system(("grep -q ') [RS] ' " + state + " 2> /dev/null").c_str()) == 0;
  };
  for (int tries = 0; runs() && tries < 200; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(runs());
}

}  // namespace workers_test
