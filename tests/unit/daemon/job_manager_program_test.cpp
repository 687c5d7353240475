// Programs that somebody else made: G-code and x3g on their way through the daemon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/fault_of.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

using fixtures::fault_of;

// What the worker tells of a program.
Prepared checked(std::int64_t job, const std::string& doubt = {}) {
  return {job,   1, R"({"as_is":{"fits":true,"time_s":60}})", "marlin", 0, "program", 60, "program",
          doubt, ""};
}

fs::path upload_of(const Workshop& shop, const std::string& bytes) {
  const fs::path file = shop.config_.state / "uploads" / "1";
  fs::create_directories(file.parent_path());
  std::ofstream(file) << bytes;
  return file;
}

TEST(Programs, AreCheckedBesideAModelThatIsPrepared) {
  Workshop shop;
  shop.drop("sim", "big.stl");
  EXPECT_TRUE(shop.prepare_order());
  shop.drop("sim", "a.gcode");
  shop.drop("sim", "b.gcode");
  const PrepareOrder order = shop.check_order().value();
  EXPECT_EQ(order.job, 2) << "it does not wait for the model";
  EXPECT_FALSE(shop.check_order()) << "one at a time";
  shop.tell(checked(2));
  EXPECT_EQ(shop.check_order()->job, 3);
  EXPECT_EQ(shop.send_order("sim")->job, 2);
  EXPECT_EQ(shop.job(1).state, JobState::kPreparing);
  EXPECT_EQ(shop.view(2).at("kind"), "program");
  EXPECT_EQ(shop.view(2).at("variant"), "program");
  EXPECT_EQ(shop.view(1).at("kind"), "model");
}

TEST(Programs, AreGivenNoOptionsOfModels) {
  Workshop shop;
  ModelOptions& options = shop.config_.printers[2].options;
  options.scale = 2;
  options.split = false;
  options.set = {"gap_mm=2"};
  shop.config_.prepare.budget_s = 5;
  shop.drop("sim", "a.gcode");
  const std::vector<std::string> argv = shop.check_order()->argv;
  for (const char* option : {"--scale", "--no-split", "--seed", "--budget"})
    EXPECT_THAT(argv, testing::Not(testing::Contains(option)));
  EXPECT_THAT(argv, testing::Contains("gap_mm=2"));
}

TEST(Programs, WaitForApprovalAndAClearBedAsAllJobsDo) {
  Workshop shop;
  shop.config_.printers[1].approve = Approve::kAsk;
  shop.drop("real", "a.gcode");
  shop.tell(checked(1));
  EXPECT_EQ(shop.view(1).at("waits_for"), "approval");
  shop.job_manager_->approve(1);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.view(1).at("waits_for"), "clear_bed");
  shop.job_manager_->clear("real");
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_TRUE(shop.send_order("real"));
}

TEST(Programs, WithADoubtAskEvenWherePrintersDoNot) {
  Workshop shop;
  shop.drop("sim", "a.gcode");
  shop.tell(checked(1, "Line 3 goes to X 500"));
  EXPECT_EQ(shop.view(1).at("waits_for"), "approval");
  EXPECT_THAT(shop.view(1).at("status").get<std::string>(), testing::HasSubstr("goes to X 500"));
  shop.job_manager_->approve(1);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_TRUE(shop.send_order("sim"));
}

TEST(Programs, SentToBePrintedAtOnceNeedNoFurtherApproval) {
  Workshop shop;
  shop.config_.printers[2].approve = Approve::kAsk;
  const JobRecord job =
      shop.job_manager_->uploaded({"sim", "../a.gcode", upload_of(shop, "G28\n"), true});
  EXPECT_EQ(job.name, "a.gcode");
  shop.job_manager_->advance(shop.now_s_);
  shop.start();  // the wish survives a restart
  shop.check_order();
  shop.tell(checked(job.id));
  EXPECT_TRUE(shop.send_order("sim"));

  const JobRecord doubtful =
      shop.job_manager_->uploaded({"sim", "b.gcode", upload_of(shop, "G29\n"), true});
  shop.job_manager_->advance(shop.now_s_);
  shop.tell(checked(doubtful.id, "a doubt"));
  EXPECT_EQ(shop.view(doubtful.id).at("waits_for"), "approval");
}

TEST(Programs, AreRefusedAtTheDoorWhereThePrinterTakesNone) {
  Workshop shop;
  const fs::path file = upload_of(shop, "G28\n");
  const auto fault = [&](const std::string& printer, const std::string& name) {
    return fault_of([&] { shop.job_manager_->uploaded({printer, name, file}); });
  };
  EXPECT_EQ(fault("hand", "a.gcode"), Fault::kBadInput);
  EXPECT_EQ(fault("sim", "a.x3g"), Fault::kBadInput);
  EXPECT_EQ(fault("sim", "a.exe"), Fault::kBadInput);
  EXPECT_EQ(fault("nobody", "a.gcode"), Fault::kNoInput);
  EXPECT_TRUE(fs::exists(file)) << "nothing was taken";
  EXPECT_FALSE(shop.store_->find(1));
}

TEST(Programs, TheSameBytesAgainAreRecognised) {
  Workshop shop;
  shop.drop("sim", "a.gcode");
  shop.tell(Hashed{1, "abc"});
  shop.tell(checked(1));
  shop.drop("sim", "other name.gcode");
  shop.tell(Hashed{2, "abc"});
  EXPECT_EQ(shop.view(2).at("same_as"), 1);
  EXPECT_EQ(shop.view(1).at("same_as"), nullptr) << "the first is the same as none before it";
  EXPECT_EQ(shop.store_->history(2).back().note, "the same bytes as job 1");
}

TEST(Programs, AgainSendsTheStoredProgram) {
  Workshop shop;
  shop.drop("sim", "a.gcode");
  const PrepareOrder order = shop.check_order().value();
  fs::create_directories(order.out);
  std::ofstream(order.out / "job.json") << "{}";
  shop.tell(checked(1));
  shop.send_order("sim");
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  shop.run_the_folder_worker();
  const JobRecord again = shop.job_manager_->again(1);
  EXPECT_EQ(again.variant, "program");
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("sim")->folder, order.out);
}

}  // namespace
}  // namespace packmerger
