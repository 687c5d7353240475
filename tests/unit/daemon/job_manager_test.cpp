#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "delivery/progress_file.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

TEST(JobManager, AModelOnASimulatedPrinterGoesAllTheWay) {
  Workshop shop;
  const fs::path file = shop.drop("sim", "bunny.stl");
  EXPECT_FALSE(fs::exists(file));
  const PrepareOrder prepare = shop.prepare_order().value();
  EXPECT_EQ(shop.job(1).state, JobState::kPreparing);
  EXPECT_THAT(prepare.argv, testing::Contains(prepare.input.string()));
  shop.tell(Hashed{1, "abc"});
  shop.prepare(prepare);
  const SendOrder send = shop.send_order("sim").value();
  EXPECT_EQ(send.folder, prepare.out);
  EXPECT_EQ(shop.job(1).state, JobState::kSending);
  shop.tell(progress_of(1, PrintState::kPrinting, "T 200"));
  EXPECT_EQ(shop.view(1).at("status"), "printing 50 %, T 200");
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  shop.run_the_folder_worker();
  EXPECT_EQ(shop.job(1).state, JobState::kDone);
  EXPECT_TRUE(fs::exists(file.parent_path() / "done/bunny.stl"));
  const json note =
      json::parse(read_file(file.parent_path() / "done/bunny.stl.result.json", 10000));
  EXPECT_EQ(note.at("job"), 1);
  EXPECT_EQ(note.at("folder"), prepare.out.string());
  EXPECT_TRUE(note.at("estimates").contains("packed"));
  EXPECT_TRUE(shop.store_->open_jobs().empty());
}

TEST(JobManager, ARealBedIsAskedForBeforeEveryTray) {
  Workshop shop;
  shop.drop("real", "a.stl");
  shop.prepare(*shop.prepare_order(), 2);
  EXPECT_FALSE(shop.send_order("real")) << "an unknown bed is not clear";
  EXPECT_EQ(shop.view(1).at("waits_for"), "clear_bed");
  shop.ask({{"verb", "printers.clear"}, {"name", "real"}});
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("real")->tray, 1);
  EXPECT_FALSE(shop.ask({{"verb", "printers.clear"}, {"name", "real"}}).at("ok")) << "it prints";
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  EXPECT_FALSE(shop.send_order("real"));
  EXPECT_EQ(shop.view(1).at("waits_for"), "clear_bed");
  shop.job_manager_->clear("real");
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("real")->tray, 2);
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  EXPECT_EQ(shop.job(1).state, JobState::kDone);
  EXPECT_FALSE(shop.store_->printer("real").bed_clear);
}

TEST(JobManager, WhatDoesNotPayAndWhereAskingIsWantedWaitsForApproval) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order(), 1, false);
  EXPECT_EQ(shop.view(1).at("waits_for"), "approval");
  EXPECT_FALSE(shop.send_order("sim"));
  shop.job_manager_->approve(1);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_TRUE(shop.send_order("sim"));
  shop.drop("hand", "b.stl");
  shop.prepare(*shop.prepare_order());
  EXPECT_EQ(shop.view(2).at("waits_for"), "approval") << "approve = ask";
  shop.job_manager_->approve(2);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("hand")->handoff_name, "b-2");
  shop.tell(SendEnded{2, SendOutcome::kDone, {}, "handed over in /x"});
  EXPECT_EQ(shop.job(2).state, JobState::kHandedOver);
}

TEST(JobManager, AHandOverFoldersNameCanBeHeldByEverySystem) {
  Workshop shop;
  const std::string longest = std::string(199, 'x') + "\u00FC.stl";
  std::int64_t id = 0;
  for (const std::string& model :
       {std::string("a:b?\u202Ec.stl"), std::string("CON.v2.stl"), longest}) {
    shop.drop("hand", model);
    shop.prepare(*shop.prepare_order());
    shop.job_manager_->approve(++id);
    shop.job_manager_->advance(shop.now_s_);
    const std::string name = shop.send_order("hand")->handoff_name;
    const std::string number = "-" + std::to_string(id);
    EXPECT_EQ(name, id == 1 ? "a_b__c-1" : id == 2 ? "_CON.v2-2" : std::string(148, 'x') + number);
    shop.tell(SendEnded{id, SendOutcome::kDone, {}, "handed over in /x"});
  }
}

TEST(JobManager, HeldPausedAndDisconnectedJobsWait) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.job_manager_->hold(1);
  shop.prepare(*shop.prepare_order());
  EXPECT_EQ(shop.view(1).at("waits_for"), "hold");
  shop.job_manager_->pause("sim", true);
  shop.job_manager_->approve(1);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.view(1).at("waits_for"), "paused");
  shop.config_.printers[2].port = "/nonexistent";
  shop.job_manager_->pause("sim", false);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.view(1).at("waits_for"), "not_connected");
  EXPECT_FALSE(shop.send_order("sim"));
}

TEST(JobManager, AFailureKeepsTheFileWithItsReason) {
  Workshop shop;
  const fs::path file = shop.drop("sim", "a.stl");
  shop.tell(PrepareFailed{1, {Fault::kBadInput, "The model is not closed", "Repair it."}});
  shop.run_the_folder_worker();
  const fs::path failed = file.parent_path() / "failed";
  EXPECT_TRUE(fs::exists(failed / "a.stl"));
  EXPECT_THAT(read_file(failed / "a.stl.reason.txt", 1000),
              testing::HasSubstr("The model is not closed\nRepair it."));
  shop.drop("sim", "a.stl");
  shop.tell(PrepareFailed{2, {Fault::kBadInput, "again", "x"}});
  shop.run_the_folder_worker();
  EXPECT_TRUE(fs::exists(failed / "a (2).stl.reason.txt")) << "the same name gets a number";
  EXPECT_TRUE(fs::exists(failed / "a (2).stl"));
}

TEST(JobManager, CancellingReachesWhoeverHasTheJob) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  const PrepareOrder order = shop.prepare_order().value();
  shop.job_manager_->cancel(1);
  EXPECT_TRUE(*order.cancel);
  EXPECT_EQ(shop.job(1).state, JobState::kCancelled);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_FALSE(shop.folder_order()) << "the child may still read the file";
  shop.prepare(order);  // it was too late for the child
  EXPECT_EQ(shop.job(1).state, JobState::kCancelled);
  shop.run_the_folder_worker();
  EXPECT_TRUE(shop.job(1).filing_done);

  shop.drop("sim", "b.stl");
  shop.prepare(*shop.prepare_order());
  const SendOrder send = shop.send_order("sim").value();
  shop.job_manager_->cancel(2);
  EXPECT_TRUE(send.control->cancelled());
  EXPECT_EQ(shop.job(2).state, JobState::kSending) << "until the printer has stopped";
  shop.tell(SendEnded{2, SendOutcome::kCancelled, {Fault::kInterrupted, "x", ""}, ""});
  EXPECT_EQ(shop.job(2).state, JobState::kCancelled);
}

TEST(JobManager, APrinterThatIsNotThereIsTriedAgainOnTheSameClearBed) {
  Workshop shop;
  shop.job_manager_->clear("real");
  shop.drop("real", "a.stl");
  shop.prepare(*shop.prepare_order());
  for (int attempt = 0; attempt < 3; ++attempt) {
    ASSERT_TRUE(shop.send_order("real")) << attempt;
    shop.tell(SendEnded{1, SendOutcome::kNotStarted, {Fault::kUnavailable, "silent", "x"}, ""});
    EXPECT_EQ(shop.job(1).state, JobState::kApproved);
    EXPECT_FALSE(shop.send_order("real"));
    shop.now_s_ += 200;
    shop.job_manager_->advance(shop.now_s_);
  }
}

// The printer had done the tray before it heard of the cancel.
TEST(JobManager, ACancelInATraysLastMomentPrintsNoFurtherTray) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order(), 2);
  ASSERT_TRUE(shop.send_order("sim"));
  shop.job_manager_->cancel(1);
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  EXPECT_EQ(shop.job(1).state, JobState::kCancelled);
  EXPECT_EQ(shop.job(1).reason, "cancelled: tray 1 is printed, and no further one");
  EXPECT_FALSE(shop.send_order("sim"));

  shop.drop("sim", "b.stl");
  shop.prepare(*shop.prepare_order());
  ASSERT_TRUE(shop.send_order("sim"));
  shop.job_manager_->cancel(2);
  shop.tell(SendEnded{2, SendOutcome::kDone, {}, ""});
  EXPECT_EQ(shop.job(2).state, JobState::kDone) << "all of it was printed";
}

TEST(JobManager, AgainUsesTheStoredProgramOrTheFiledModel) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  const PrepareOrder prepare = shop.prepare_order().value();
  shop.prepare(prepare);
  shop.send_order("sim");
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  EXPECT_FALSE(shop.ask({{"verb", "jobs.again"}, {"id", 99}}).at("ok"));
  const JobRecord again = shop.job_manager_->again(1);
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("sim")->folder, prepare.out);
  shop.tell(SendEnded{again.id, SendOutcome::kDone, {}, ""});
  shop.run_the_folder_worker();
  EXPECT_TRUE(shop.store_->open_jobs().empty());

  const fs::path file = shop.drop("sim", "b.stl");
  shop.prepare_order();
  shop.tell(PrepareFailed{3, {Fault::kBadInput, "bad", "x"}});
  shop.run_the_folder_worker();
  shop.job_manager_->again(3);
  shop.run_the_folder_worker();
  EXPECT_EQ(shop.prepare_order()->job, 4);
  EXPECT_TRUE(fs::exists(file.parent_path() / "failed/b.stl")) << "the filed one stays";
}

TEST(JobManager, RestartKnowsWhatWasUnderWay) {
  Workshop shop;
  shop.drop("sim", "prepared.stl");
  shop.prepare(*shop.prepare_order(), 1, false);
  shop.drop("sim", "preparing.stl");
  EXPECT_TRUE(shop.prepare_order());
  shop.drop("sim", "waiting.stl");
  shop.start();
  EXPECT_EQ(shop.job(1).state, JobState::kReady);
  const PrepareOrder order = shop.prepare_order().value();
  EXPECT_EQ(order.job, 2);
  EXPECT_EQ(order.out.filename(), "job-2") << "never into a folder that a dying child may write";
  EXPECT_EQ(shop.job(3).state, JobState::kReceived);

  shop.job_manager_->approve(1);
  shop.job_manager_->advance(shop.now_s_);
  ProgressFile(shop.send_order("sim").value().told_file).acknowledged(0, 0);
  shop.start();
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_EQ(shop.job(1).reason, "interrupted while printing");
  EXPECT_FALSE(shop.send_order("sim"));
}

TEST(JobManager, TheSameBytesAreRecognised) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.tell(Hashed{1, "abc"});
  shop.tell(PrepareFailed{1, {Fault::kBadInput, "bad", "x"}});
  shop.drop("sim", "b.stl");
  shop.tell(Hashed{2, "abc"});
  EXPECT_EQ(shop.store_->history(2).back().note, "the same bytes as job 1");
}

TEST(JobManager, StoppingEndsPrintsAndKeepsPreparing) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  const SendOrder send = shop.send_order("sim").value();
  shop.drop("sim", "b.stl");
  const PrepareOrder prepare = shop.prepare_order().value();
  shop.job_manager_->stop();
  EXPECT_TRUE(send.control->cancelled() && *prepare.cancel);
  shop.job_manager_->handle(PrepareFailed{2, {Fault::kInterrupted, "Interrupted", ""}});
  shop.job_manager_->handle(
      SendEnded{1, SendOutcome::kCancelled, {Fault::kInterrupted, "x", ""}, ""});
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_EQ(shop.job(1).reason, "the daemon was stopped while printing");
  EXPECT_EQ(shop.job(2).state, JobState::kReceived) << "for the next daemon";
}

TEST(Api, AnswersEveryKindOfNonsense) {
  Workshop shop;
  shop.drop("sim", "a\xFF.stl");
  for (const char* request :
       {"", "x", "[]", "1", "{}", R"({"verb": 1})", R"({"verb": "x"})", R"({"verb": "jobs.show"})",
        R"({"verb": "jobs.show", "id": "1"})", R"({"verb": "jobs.show", "id": -1})",
        R"({"verb": "jobs.show", "id": 1e300})", R"({"verb": "jobs.list", "limit": 0})",
        R"({"verb": "jobs.list", "before": 0})", R"({"verb": "jobs.list", "before": "2"})",
        R"({"verb": "jobs.approve", "id": 1})", R"({"verb": "printers.clear"})",
        R"({"verb": "printers.clear", "name": "../x"})", "\xFF\xFE", "{\"verb\": \"\xFF\"}"}) {
    const json reply = json::parse(answer(*shop.job_manager_, shop.keys_, request));
    EXPECT_FALSE(reply.at("ok").get<bool>()) << request;
    EXPECT_FALSE(reply.at("error").at("what").get<std::string>().empty()) << request;
  }
  EXPECT_TRUE(json::parse(answer(*shop.job_manager_, shop.keys_, std::string(60000, '[')))
                  .contains("error"));
  EXPECT_EQ(shop.ask({{"verb", "jobs.list"}}).at("result").size(), 1U);
  for (const int before : {1, 2})
    EXPECT_TRUE(shop.ask({{"verb", "jobs.list"}, {"before", before}}).at("result").empty())
        << "what has not ended stands on no later page";
}

// What the sender's thread would find at its control.
TEST(JobManager, ARunningPrintIsPausedAndGoesOn) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  const SendOrder send = shop.send_order("sim").value();
  EXPECT_TRUE(shop.ask({{"verb", "printers.pause"}, {"name", "sim"}}).at("ok"));
  EXPECT_EQ(send.control->take_pause_request(), true);
  shop.tell(progress_of(1, PrintState::kPaused));
  const json view = shop.ask({{"verb", "printers.list"}}).at("result").at(2);
  EXPECT_EQ(view.at("print").at("stage"), "paused");
  EXPECT_EQ(view.at("paused"), true);
  EXPECT_TRUE(shop.ask({{"verb", "printers.resume"}, {"name", "sim"}}).at("ok"));
  EXPECT_EQ(send.control->take_pause_request(), false);
  EXPECT_EQ(send.control->take_pause_request(), std::nullopt);
  EXPECT_FALSE(send.control->cancelled());
}

TEST(JobManager, OnlyAQuestionIsAnsweredAndOnlyByItsChoices) {
  Workshop shop;
  const auto answer = [&](int choice) {
    return shop.ask({{"verb", "printers.answer"}, {"name", "sim"}, {"choice", choice}});
  };
  EXPECT_EQ(answer(0).at("error").at("fault"), 2) << "nothing is printed there";
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  const SendOrder send = shop.send_order("sim").value();
  EXPECT_EQ(answer(0).at("error").at("fault"), 2) << "nothing is asked";
  shop.tell(progress_of(1, PrintState::kWaiting, "Purge more?", {"Yes", "No"}));
  const json view = shop.ask({{"verb", "printers.list"}}).at("result").at(2);
  EXPECT_EQ(view.at("print").at("choices"), (json{"Yes", "No"}));
  EXPECT_EQ(answer(2).at("error").at("fault"), 2);
  EXPECT_EQ(answer(-1).at("error").at("fault"), 2);
  EXPECT_EQ(send.control->take_answer(), -1);
  EXPECT_TRUE(answer(1).at("ok"));
  EXPECT_EQ(send.control->take_answer(), 1);
}

TEST(JobManager, APrintStoppedAtOnceFails) {
  Workshop shop;
  const json stop = {{"verb", "printers.stop"}, {"name", "sim"}};
  EXPECT_EQ(shop.ask(stop).at("error").at("fault"), 2) << "nothing is printed there";
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  const SendOrder send = shop.send_order("sim").value();
  EXPECT_TRUE(shop.ask(stop).at("ok"));
  EXPECT_TRUE(send.control->stopped());
  shop.tell(SendEnded{1, SendOutcome::kFailed, {Fault::kIo, "stopped", "Look."}, ""});
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_EQ(shop.ask(stop).at("error").at("fault"), 2);
}

// Its sender wrote down what the printer acknowledged.
TEST(JobManager, AfterAKillTheRecordSaysHowFarThePrinterWasTold) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  const SendOrder send = shop.send_order("sim").value();
  ProgressFile(send.told_file).acknowledged(120, 300);
  shop.start();
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_EQ(shop.job(1).reason, "interrupted while printing, told up to line 120 of 300 (40 %)");
  EXPECT_EQ(shop.view(1).at("told"), (json{{"done", 120}, {"total", 300}}));
  EXPECT_FALSE(shop.send_order("sim")) << "nothing is resumed by itself";
}

}  // namespace
}  // namespace packmerger
