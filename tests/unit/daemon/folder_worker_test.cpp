#include "daemon/intake/folder_worker.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <fstream>
#include <thread>

#include "base/files.h"

namespace packmerger {
namespace {

constexpr double kNever_s = 1e6;
constexpr int kPatience_ms = 60000;

class FolderWorkerTest : public testing::Test {
 protected:
  ~FolderWorkerTest() override {
    queue_.orders.close();
    thread_.join();
  }

  // What he tells of the folder next.
  FolderTold told() {
    for (;;) {
      pollfd waiting{events_.fd(), POLLIN, 0};
      if (::poll(&waiting, 1, kPatience_ms) != 1) {
        ADD_FAILURE() << "he tells nothing";
        return {};
      }
      const std::optional<Event> event = events_.try_pop();
      if (event && std::holds_alternative<FolderTold>(*event)) return std::get<FolderTold>(*event);
    }
  }

  TemporaryFolder folder_;
  const fs::path watched_ = folder_.path() / "drop";
  FolderQueue queue_;
  Queue<Event> events_;
  std::thread thread_{[this] { FolderWorker(watched_, queue_, events_).run(); }};
};

TEST_F(FolderWorkerTest, TellsAnewOfEachWatch) {
  std::ofstream(watched_) << "no folder";
  queue_.orders.push(WatchOrder{"lab", {}, kNever_s});
  const FolderTold first = told();
  EXPECT_EQ(first.printer, "lab");
  EXPECT_EQ(first.folder, watched_);
  ASSERT_TRUE(first.trouble);
  queue_.orders.push(WatchOrder{"lab", {}, kNever_s});  // as a reload does
  EXPECT_TRUE(told().trouble) << "it lasts";
  fs::remove(watched_);
  queue_.orders.push(WatchOrder{"lab", {}, kNever_s});
  EXPECT_FALSE(told().trouble) << "the trouble of the watch before is over";
  queue_.orders.push(WatchOrder{});
  queue_.orders.push(WatchOrder{"cellar", {}, kNever_s});
  EXPECT_EQ(told().printer, "cellar") << "and he tells nobody of a folder that nobody watches";
}

}  // namespace
}  // namespace packmerger
