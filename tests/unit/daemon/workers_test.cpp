// Several models are prepared at the same time.
#include "daemon/settings/workers.h"

#include "unit/daemon/running_daemon.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

TEST(Workers, AreAsManyAsTheMachineBears) {
  EXPECT_EQ(workers_for(8, 64 * kGiB, 8 * kGiB), 4) << "one for every two cores";
  EXPECT_EQ(workers_for(32, 17 * kGiB, 8 * kGiB), 2) << "and for what one may need of the memory";
  EXPECT_EQ(workers_for(1, kGiB, 8 * kGiB), 1);
  EXPECT_EQ(workers_for(0, 0, 8 * kGiB), 1) << "where the system does not tell";
  PrepareConfig prepare;
  EXPECT_GE(workers_of(prepare), 1);
  prepare.workers = 7;
  EXPECT_EQ(workers_of(prepare), 7);
}

TEST(Workers, AreGivenNoMoreThanTheyBeginAtOnce) {
  Workshop shop;
  shop.config_.prepare.workers = 2;
  for (const char* name : {"a.stl", "b.stl", "c.stl", "d.stl"}) shop.drop("sim", name);
  const auto first = shop.prepare_order();
  const auto second = shop.prepare_order();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(std::pair(first->job, second->job), std::pair(std::int64_t{1}, std::int64_t{2}));
  EXPECT_FALSE(shop.prepare_order());
  EXPECT_NE(first->out.parent_path(), second->out.parent_path()) << "a folder for each child";
  shop.job_manager_->cancel(1);
  EXPECT_TRUE(*first->cancel);
  EXPECT_FALSE(*second->cancel);
  EXPECT_FALSE(shop.prepare_order()) << "its worker still ends it";
  shop.tell(PrepareFailed{1, {Fault::kInterrupted, "cancelled", ""}});
  EXPECT_EQ(shop.prepare_order().value().job, 3);
  shop.config_.prepare.workers = 1;  // read again
  shop.prepare(*second);
  EXPECT_FALSE(shop.prepare_order()) << "job 3 is still with one";
  shop.tell(PrepareFailed{3, {Fault::kBadInput, "no", ""}});
  EXPECT_EQ(shop.prepare_order().value().job, 4);
}

TEST(Workers, BeginWithWhatWasPutFirst) {
  Workshop shop;
  shop.config_.prepare.workers = 1;
  for (const char* name : {"a.stl", "b.stl", "c.stl", "d.stl"}) shop.drop("sim", name);
  shop.prepare(*shop.prepare_order());  // job 1 was begun as it came
  for (const int id : {3, 4, 3})
    EXPECT_TRUE(shop.ask({{"verb", "jobs.first"}, {"id", id}}).at("ok"));
  EXPECT_EQ(shop.view(3).at("turn"), 3);
  const auto order = shop.prepare_order();
  EXPECT_EQ(order.value().job, 2) << "that was begun already";
  shop.prepare(*order);
  shop.start();  // it outlives the daemon
  EXPECT_EQ(shop.prepare_order().value().job, 3);
  EXPECT_EQ(shop.ask({{"verb", "jobs.first"}, {"id", 9}}).at("error").at("fault"), 66);
  shop.job_manager_->cancel(4);
  EXPECT_EQ(shop.ask({{"verb", "jobs.first"}, {"id", 4}}).at("error").at("fault"), 2) << "it ended";
}

// One after the other: one of them may be why.
TEST(Workers, AfterAKillAllThatWereBeingPreparedAreBegunAgain) {
  Workshop shop;
  shop.config_.prepare.workers = 2;
  for (const char* name : {"a.stl", "b.stl", "c.stl"}) shop.drop("sim", name);
  shop.start();
  const PrepareOrder first = shop.prepare_order().value();
  EXPECT_EQ(first.job, 1);
  EXPECT_EQ(shop.prepare_order().value().job, 3) << "which was not begun before";
  EXPECT_FALSE(shop.prepare_order());
  shop.prepare(first);
  EXPECT_EQ(shop.prepare_order().value().job, 2);
  EXPECT_EQ(shop.job(2).attempt, 2);
}

using RunningWorkers = RunningDaemon;

TEST_F(RunningWorkers, AllWorkWhileAPrinterPrints) {
  SimulatedMarlin marlin(0, path("record"));
  configure(marlin.port(), true, 2);
  start();
  const auto is = [&](int id, const char* state) { return job(id).at("state") == state; };
  drop("m", "bunny.stl");
  ASSERT_TRUE(reaches(1, "done"));
  drop("m", "hang-1.stl");
  drop("m", "hang-2.stl");
  ASSERT_TRUE(reaches(2, "preparing"));
  ASSERT_TRUE(reaches(3, "preparing"));
  ask({{"verb", "jobs.again"}, {"id", 1}});
  ASSERT_TRUE(reaches(4, "done")) << "printed";
  EXPECT_TRUE(is(2, "preparing") && is(3, "preparing")) << "while both worked";
  drop("m", "hang-3.stl");
  ASSERT_TRUE(reaches(5, "received"));
  ask({{"verb", "jobs.cancel"}, {"id", 2}});
  ASSERT_TRUE(reaches(5, "preparing"));
  EXPECT_TRUE(is(3, "preparing"));
  EXPECT_EQ(end(SIGTERM).code, 0);
  start();
  ASSERT_TRUE(reaches(3, "preparing"));
  ASSERT_TRUE(reaches(5, "preparing"));
  configure(marlin.port(), true, 3);
  drop("m", "slow-4.stl");
  ASSERT_TRUE(reaches(6, "received"));
  ::kill(daemon_->pid(), SIGHUP);
  ASSERT_TRUE(reaches(6, "done")) << "a third one from now on";
  EXPECT_EQ(end(SIGTERM).code, 0);
}

}  // namespace
}  // namespace packmerger
