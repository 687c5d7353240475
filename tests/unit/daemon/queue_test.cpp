#include "base/queue.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

namespace packmerger {
namespace {

bool readable(int fd) {
  pollfd waiting{fd, POLLIN, 0};
  return ::poll(&waiting, 1, 0) == 1;
}

TEST(Queue, KeepsTheOrderAndTellsByItsDescriptor) {
  Queue<std::unique_ptr<int>> queue;
  EXPECT_FALSE(readable(queue.fd()));
  EXPECT_FALSE(queue.try_pop());
  queue.push(std::make_unique<int>(1));
  queue.push(std::make_unique<int>(2));
  EXPECT_TRUE(readable(queue.fd()));
  EXPECT_EQ(**queue.try_pop(), 1);
  EXPECT_TRUE(readable(queue.fd()));
  EXPECT_EQ(**queue.try_pop(), 2);
  EXPECT_FALSE(readable(queue.fd()));
}

TEST(Queue, ClosingWakesWaitersAndKeepsWhatWasPushed) {
  Queue<int> queue;
  queue.push(7);
  queue.close();
  queue.push(8);
  EXPECT_EQ(queue.pop(), 7);
  EXPECT_EQ(queue.pop(), std::nullopt);
  EXPECT_TRUE(readable(queue.fd()));
  Queue<int> empty;
  std::thread waiter([&] { EXPECT_EQ(empty.pop(), std::nullopt); });
  empty.close();
  waiter.join();
}

TEST(Queue, ManyThreadsLoseNothing) {
  Queue<int> queue;
  constexpr int kThreads = 4;
  constexpr int kEach = 2000;
  std::vector<std::thread> pushers;
  for (int t = 0; t < kThreads; ++t)
    pushers.emplace_back([&queue, t] {
      for (int i = 0; i < kEach; ++i) queue.push(t * kEach + i);
    });
  std::vector<std::vector<int>> taken(2);
  std::vector<std::thread> poppers;
  for (auto& mine : taken)
    poppers.emplace_back([&queue, &mine] {
      while (const auto value = queue.pop()) mine.push_back(*value);
    });
  for (std::thread& thread : pushers) thread.join();
  queue.close();
  for (std::thread& thread : poppers) thread.join();
  std::vector<int> seen(kThreads * kEach);
  for (const auto& mine : taken) {
    std::vector<int> last(kThreads, -1);
    for (const int value : mine) {
      ++seen[static_cast<std::size_t>(value)];
      EXPECT_GT(value % kEach, last[static_cast<std::size_t>(value / kEach)]);
      last[static_cast<std::size_t>(value / kEach)] = value % kEach;
    }
  }
  EXPECT_EQ(seen, std::vector<int>(kThreads * kEach, 1));
}

}  // namespace
}  // namespace packmerger
