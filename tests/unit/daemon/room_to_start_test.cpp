// A disk that is full to the last byte when the daemon starts.
#include "daemon/room_to_start.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

using testing::ElementsAre;

constexpr double kDay_s = 86400;

class RoomToStart : public testing::Test {
 protected:
  // A job that failed so many days ago, and left a folder.
  void failed(double days_ago) {
    shop_.drop("sim", "a.stl");
    const PrepareOrder order = shop_.prepare_order().value();
    shop_.prepare(order, 1, false);
    shop_.job_manager_->cancel(order.job);
    shop_.run_the_folder_worker();
    JobRecord job = shop_.job(order.job);
    job.ended_s -= days_ago * kDay_s;
    shop_.store_->save(job);
  }
  fs::path folder(int id) { return shop_.config_.state / "jobs" / std::to_string(id); }
  void end() {
    shop_.job_manager_.reset();
    shop_.store_.reset();
  }
  Deleted make_room(const std::function<bool()>& has_room) {
    return make_room_to_start(
        shop_.config_.state, [&](const std::string& line) { log_ += line; }, has_room);
  }

  Workshop shop_;
  std::string log_;
};

TEST_F(RoomToStart, IsMadeOfTheOldestJobsAndOfNoMoreThanItTakes) {
  for (const double days : {3.0, 9.0, 5.0, 0.5}) failed(days);
  end();
  const Deleted deleted = make_room([&] { return !fs::exists(folder(3)); });
  EXPECT_THAT(deleted.jobs, ElementsAre(2, 3));
  EXPECT_TRUE(fs::exists(folder(1)));
  EXPECT_THAT(log_, testing::HasSubstr("is full: the folders of the oldest jobs are deleted"));
  shop_.start();
  shop_.tell(deleted);
  EXPECT_GT(shop_.job(2).deleted_s, 0) << "recorded once it can be";
  EXPECT_GT(shop_.job(3).deleted_s, 0);
  EXPECT_EQ(shop_.job(1).deleted_s, 0);
}

TEST_F(RoomToStart, TakesNothingOfTheLastDay) {
  failed(2);
  failed(0.5);
  end();
  EXPECT_THAT(make_room([] { return false; }).jobs, ElementsAre(1));
  EXPECT_TRUE(fs::exists(folder(2)));
}

TEST_F(RoomToStart, NothingIsDeletedWhereThereIsRoom) {
  failed(100);
  end();
  EXPECT_TRUE(has_room_to_start(shop_.config_.state));
  EXPECT_TRUE(make_room_to_start(shop_.config_.state, [](const std::string&) {}).jobs.empty());
  EXPECT_TRUE(fs::exists(folder(1)));
}

TEST_F(RoomToStart, AFolderThatCannotBeWrittenToIsNoFullDisk) {
  EXPECT_TRUE(has_room_to_start(shop_.folder_.path() / "not there"));
}

}  // namespace
}  // namespace packmerger
