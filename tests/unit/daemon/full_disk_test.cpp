// What goes on where the disk with the state folder takes no more.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include "base/time/wall_clock.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

// While it lives, nothing can be written to a file.
class FullDisk {
 public:
  FullDisk() : handler_(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit none{0, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &none);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST(FullDiskTest, IsClearedBeforeAnythingIsRecorded) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  const PrepareOrder order = shop.prepare_order().value();
  shop.prepare(order);
  shop.send_order("sim");
  shop.tell(SendEnded{order.job, SendOutcome::kDone, {}, ""});
  shop.run_the_folder_worker();
  JobRecord job = shop.job(order.job);
  job.ended_s -= 100 * 86400.0;
  shop.store_->save(job);
  shop.store_->remember("cleaning_looked_s", unix_now_s() - 2 * 86400.0);  // due to be written
  const fs::path folder = shop.config_.state / "jobs" / std::to_string(job.id);
  ASSERT_TRUE(fs::exists(folder));
  {
    const FullDisk full;
    const Arrived pending{"sim", shop.config_.printer("sim")->folder / "b.stl", false};
    EXPECT_THROW(shop.job_manager_->handle(pending), Error);
    shop.job_manager_->clean(shop.now_s_ += 60);
    const std::optional<FolderOrder> wanted = shop.folder_order();
    ASSERT_TRUE(wanted && std::holds_alternative<DeleteOrder>(*wanted));
    shop.job_manager_->handle(clear_away(std::get<DeleteOrder>(*wanted)));
    EXPECT_FALSE(fs::exists(folder));
    EXPECT_EQ(shop.job(job.id).deleted_s, 0) << "there is no room to record it";
    EXPECT_EQ(shop.view(job.id).at("folder"), "") << "but nobody is sent there";
    shop.job_manager_->clean(shop.now_s_ += 60);
    EXPECT_FALSE(shop.folder_order()) << "it is not deleted again and again";
  }
  shop.job_manager_->clean(shop.now_s_ += 60);
  EXPECT_GT(shop.job(job.id).deleted_s, 0);
  EXPECT_NEAR(shop.store_->remembered("cleaning_looked_s").value(), unix_now_s(), 3600);
}

TEST(FullDiskTest, APauseReachesThePrinterAndAResumeOnlyWhereItIsKept) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(shop.prepare_order().value());
  const SendOrder send = shop.send_order("sim").value();
  {
    const FullDisk full;
    EXPECT_THROW(shop.job_manager_->pause("sim", true), Error);
    EXPECT_EQ(send.control->take_pause_request(), true);
    EXPECT_THROW(shop.job_manager_->pause("sim", false), Error);
    EXPECT_EQ(send.control->take_pause_request(), std::nullopt);
  }
  shop.job_manager_->pause("sim", false);
  EXPECT_EQ(send.control->take_pause_request(), false);
}

TEST(FullDiskTest, AWishIsRecordedOnceThereIsRoom) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.tell(PrepareFailed{1, {Fault::kBadInput, "bad", "x"}});
  shop.run_the_folder_worker();
  {
    const FullDisk full;
    EXPECT_NO_THROW(shop.job_manager_->remove(1)) << "to delete is what helps";
    EXPECT_FALSE(shop.job(1).to_delete);
  }
  shop.job_manager_->clean(shop.now_s_ += 60);
  EXPECT_FALSE(shop.job(1).to_delete) << "the folder_worker is at it";
  shop.run_the_folder_worker();
  EXPECT_GT(shop.job(1).deleted_s, 0);
}

}  // namespace
}  // namespace packmerger
