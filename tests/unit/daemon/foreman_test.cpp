#include "daemon/foreman.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "base/files.h"
#include "base/random.h"
#include "daemon/api.h"
#include "daemon/worker.h"

namespace packmerger {
namespace {

using nlohmann::json;

PrinterConfig printer(const fs::path& folder, const std::string& name, Dialect dialect) {
  PrinterConfig printer;
  printer.name = name;
  printer.profile = "marlin";
  printer.abilities.dialect = dialect;
  printer.folder = folder / "drop" / name;
  printer.port = "/dev/null";
  printer.handoff_folder = folder / "share";
  fs::create_directories(printer.folder);
  return printer;
}

// A workshop whose worker, clerk and printers are played by the test, one order after the other.
class Workshop {
 public:
  Workshop() {
    config_.state = folder_.path() / "state";
    config_.prepare.program = "packmerger";
    config_.retry_s = 10;
    config_.printers = {printer(folder_.path(), "hand", Dialect::kHandoff),
                        printer(folder_.path(), "real", Dialect::kGcode),
                        printer(folder_.path(), "sim", Dialect::kGcode)};
    config_.printers[2].simulated = true;
    config_.printers[2].approve = Approve::kAuto;
    config_.printers[1].approve = Approve::kAuto;
    fs::create_directories(config_.state);
    start();
  }

  // As after a kill: orders and events that were under way are gone.
  void start() {
    foreman_.reset();
    store_ = std::make_unique<JobStore>(config_.state / "jobs.sqlite");
    crew_ = std::make_unique<Crew>(config_);
    foreman_ = std::make_unique<Foreman>(config_, *store_, *crew_, [](const std::string&) {});
    foreman_->recover();
    foreman_->advance(now_s_);
  }

  fs::path drop(const std::string& name, const std::string& model) {
    const fs::path file = config_.printer(name)->folder / model;
    std::ofstream(file) << "model " << drops_++;
    EXPECT_TRUE(foreman_->arrived(*config_.printer(name), file));
    foreman_->advance(now_s_);
    return file;
  }

  void tell(const Event& event) {
    foreman_->handle(event);
    foreman_->advance(now_s_);
  }

  std::optional<PrepareOrder> prepare_order() { return crew_->worker.try_pop(); }
  std::optional<SendOrder> send_order(const std::string& name) {
    return crew_->senders.at(name).try_pop();
  }

  void prepare(const PrepareOrder& order, int trays = 1, bool pays = true) {
    fs::create_directories(order.out);
    std::ofstream(order.out / "job.json") << "{}";
    tell(Prepared{order.job, trays, R"({"packed":{"fits":true,"cost":1}})", pays});
  }

  // The clerk's work, really done.
  void run_the_clerk() {
    Queue<ClerkOrder> orders;
    Queue<Event> events;
    while (auto order = crew_->clerk.try_pop()) orders.push(std::move(*order));
    orders.close();
    run_clerk(orders, events);
    while (auto event = events.try_pop()) tell(*event);
  }

  JobRecord job(std::int64_t id) { return store_->find(id).value(); }
  json ask(const json& request) { return json::parse(answer(*foreman_, request.dump())); }
  json view(std::int64_t id) { return ask({{"verb", "jobs.show"}, {"id", id}}).at("result"); }

  TemporaryFolder folder_;
  DaemonConfig config_;
  std::unique_ptr<JobStore> store_;
  std::unique_ptr<Crew> crew_;
  std::unique_ptr<Foreman> foreman_;
  double now_s_ = 1000;
  int drops_ = 0;
};

TEST(Foreman, AModelOnASimulatedPrinterGoesAllTheWay) {
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
  shop.tell(SendProgress{1, {PrintState::kPrinting, 5, 10, "T 200"}});
  EXPECT_EQ(shop.view(1).at("status"), "printing 50 %, T 200");
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  shop.run_the_clerk();
  EXPECT_EQ(shop.job(1).state, JobState::kDone);
  EXPECT_TRUE(fs::exists(file.parent_path() / "done/bunny.stl"));
  const json note =
      json::parse(read_file(file.parent_path() / "done/bunny.stl.result.json", 10000));
  EXPECT_EQ(note.at("job"), 1);
  EXPECT_EQ(note.at("folder"), prepare.out.string());
  EXPECT_TRUE(note.at("estimates").contains("packed"));
  EXPECT_TRUE(shop.store_->open_jobs().empty());
}

TEST(Foreman, ARealBedIsAskedForBeforeEveryTray) {
  Workshop shop;
  shop.drop("real", "a.stl");
  shop.prepare(*shop.prepare_order(), 2);
  EXPECT_FALSE(shop.send_order("real")) << "an unknown bed is not clear";
  EXPECT_EQ(shop.view(1).at("waits_for"), "clear_bed");
  shop.ask({{"verb", "printers.clear"}, {"name", "real"}});
  shop.foreman_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("real")->tray, 1);
  EXPECT_FALSE(shop.ask({{"verb", "printers.clear"}, {"name", "real"}}).at("ok")) << "it prints";
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  EXPECT_FALSE(shop.send_order("real"));
  EXPECT_EQ(shop.view(1).at("waits_for"), "clear_bed");
  shop.foreman_->clear("real");
  shop.foreman_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("real")->tray, 2);
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  EXPECT_EQ(shop.job(1).state, JobState::kDone);
  EXPECT_FALSE(shop.store_->printer("real").bed_clear);
}

TEST(Foreman, WhatDoesNotPayAndWhereAskingIsWantedWaitsForApproval) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order(), 1, false);
  EXPECT_EQ(shop.view(1).at("waits_for"), "approval");
  EXPECT_FALSE(shop.send_order("sim"));
  shop.foreman_->approve(1);
  shop.foreman_->advance(shop.now_s_);
  EXPECT_TRUE(shop.send_order("sim"));
  shop.drop("hand", "b.stl");
  shop.prepare(*shop.prepare_order());
  EXPECT_EQ(shop.view(2).at("waits_for"), "approval") << "approve = ask";
  shop.foreman_->approve(2);
  shop.foreman_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("hand")->handoff_name, "b-2");
  shop.tell(SendEnded{2, SendOutcome::kDone, {}, "handed over in /x"});
  EXPECT_EQ(shop.job(2).state, JobState::kHandedOver);
}

TEST(Foreman, HeldPausedAndDisconnectedJobsWait) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.foreman_->hold(1);
  shop.prepare(*shop.prepare_order());
  EXPECT_EQ(shop.view(1).at("waits_for"), "hold");
  shop.foreman_->pause("sim", true);
  shop.foreman_->approve(1);
  shop.foreman_->advance(shop.now_s_);
  EXPECT_EQ(shop.view(1).at("waits_for"), "paused");
  shop.config_.printers[2].port = "/nonexistent";
  shop.foreman_->pause("sim", false);
  shop.foreman_->advance(shop.now_s_);
  EXPECT_EQ(shop.view(1).at("waits_for"), "not_connected");
  EXPECT_FALSE(shop.send_order("sim"));
}

TEST(Foreman, AFailureKeepsTheFileWithItsReason) {
  Workshop shop;
  const fs::path file = shop.drop("sim", "a.stl");
  shop.tell(PrepareFailed{1, {Fault::kBadInput, "The model is not closed", "Repair it."}});
  shop.run_the_clerk();
  const fs::path failed = file.parent_path() / "failed";
  EXPECT_TRUE(fs::exists(failed / "a.stl"));
  EXPECT_THAT(read_file(failed / "a.stl.reason.txt", 1000),
              testing::HasSubstr("The model is not closed\nRepair it."));
  shop.drop("sim", "a.stl");
  shop.tell(PrepareFailed{2, {Fault::kBadInput, "again", "x"}});
  shop.run_the_clerk();
  EXPECT_TRUE(fs::exists(failed / "a (2).stl.reason.txt")) << "the same name gets a number";
  EXPECT_TRUE(fs::exists(failed / "a (2).stl"));
}

TEST(Foreman, CancellingReachesWhoeverHasTheJob) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  const PrepareOrder order = shop.prepare_order().value();
  shop.foreman_->cancel(1);
  EXPECT_TRUE(*order.cancel);
  EXPECT_EQ(shop.job(1).state, JobState::kCancelled);
  shop.foreman_->advance(shop.now_s_);
  EXPECT_FALSE(shop.crew_->clerk.try_pop()) << "the child may still read the file";
  shop.prepare(order);  // it was too late for the child
  EXPECT_EQ(shop.job(1).state, JobState::kCancelled);
  shop.run_the_clerk();
  EXPECT_TRUE(shop.job(1).filing_done);

  shop.drop("sim", "b.stl");
  shop.prepare(*shop.prepare_order());
  const SendOrder send = shop.send_order("sim").value();
  shop.foreman_->cancel(2);
  EXPECT_TRUE(send.control->cancelled());
  EXPECT_EQ(shop.job(2).state, JobState::kSending) << "until the printer has stopped";
  shop.tell(SendEnded{2, SendOutcome::kCancelled, {Fault::kInterrupted, "x", ""}, ""});
  EXPECT_EQ(shop.job(2).state, JobState::kCancelled);
}

TEST(Foreman, APrinterThatIsNotThereIsTriedAgainOnTheSameClearBed) {
  Workshop shop;
  shop.foreman_->clear("real");
  shop.drop("real", "a.stl");
  shop.prepare(*shop.prepare_order());
  for (int attempt = 0; attempt < 3; ++attempt) {
    ASSERT_TRUE(shop.send_order("real")) << attempt;
    shop.tell(SendEnded{1, SendOutcome::kNotStarted, {Fault::kUnavailable, "silent", "x"}, ""});
    EXPECT_EQ(shop.job(1).state, JobState::kApproved);
    EXPECT_FALSE(shop.send_order("real"));
    shop.now_s_ += 200;
    shop.foreman_->advance(shop.now_s_);
  }
}

TEST(Foreman, AgainUsesTheStoredProgramOrTheFiledModel) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  const PrepareOrder prepare = shop.prepare_order().value();
  shop.prepare(prepare);
  shop.send_order("sim");
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  EXPECT_FALSE(shop.ask({{"verb", "jobs.again"}, {"id", 99}}).at("ok"));
  const JobRecord again = shop.foreman_->again(1);
  shop.foreman_->advance(shop.now_s_);
  EXPECT_EQ(shop.send_order("sim")->folder, prepare.out);
  shop.tell(SendEnded{again.id, SendOutcome::kDone, {}, ""});
  shop.run_the_clerk();
  EXPECT_TRUE(shop.store_->open_jobs().empty());

  const fs::path file = shop.drop("sim", "b.stl");
  shop.prepare_order();
  shop.tell(PrepareFailed{3, {Fault::kBadInput, "bad", "x"}});
  shop.run_the_clerk();
  shop.foreman_->again(3);
  shop.run_the_clerk();
  EXPECT_EQ(shop.prepare_order()->job, 4);
  EXPECT_TRUE(fs::exists(file.parent_path() / "failed/b.stl")) << "the filed one stays";
}

TEST(Foreman, RestartKnowsWhatWasUnderWay) {
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

  shop.foreman_->approve(1);
  shop.foreman_->advance(shop.now_s_);
  ASSERT_TRUE(shop.send_order("sim"));
  shop.start();
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_EQ(shop.job(1).reason, "interrupted while printing");
  EXPECT_FALSE(shop.send_order("sim"));
}

TEST(Foreman, TheSameBytesAreRecognised) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.tell(Hashed{1, "abc"});
  shop.tell(PrepareFailed{1, {Fault::kBadInput, "bad", "x"}});
  shop.drop("sim", "b.stl");
  shop.tell(Hashed{2, "abc"});
  EXPECT_EQ(shop.store_->history(2).back().note, "the same bytes as job 1");
}

TEST(Foreman, StoppingEndsPrintsAndKeepsPreparing) {
  Workshop shop;
  shop.drop("sim", "a.stl");
  shop.prepare(*shop.prepare_order());
  const SendOrder send = shop.send_order("sim").value();
  shop.drop("sim", "b.stl");
  const PrepareOrder prepare = shop.prepare_order().value();
  shop.foreman_->stop();
  EXPECT_TRUE(send.control->cancelled() && *prepare.cancel);
  shop.foreman_->handle(PrepareFailed{2, {Fault::kInterrupted, "Interrupted", ""}});
  shop.foreman_->handle(SendEnded{1, SendOutcome::kCancelled, {Fault::kInterrupted, "x", ""}, ""});
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_EQ(shop.job(1).reason, "the daemon was stopped while printing");
  EXPECT_EQ(shop.job(2).state, JobState::kPreparing);
}

TEST(Api, AnswersEveryKindOfNonsense) {
  Workshop shop;
  shop.drop("sim", "a\xFF.stl");
  for (const char* request :
       {"", "x", "[]", "1", "{}", R"({"verb": 1})", R"({"verb": "x"})", R"({"verb": "jobs.show"})",
        R"({"verb": "jobs.show", "id": "1"})", R"({"verb": "jobs.show", "id": -1})",
        R"({"verb": "jobs.show", "id": 1e300})", R"({"verb": "jobs.list", "limit": 0})",
        R"({"verb": "jobs.approve", "id": 1})", R"({"verb": "printers.clear"})",
        R"({"verb": "printers.clear", "name": "../x"})", "\xFF\xFE", "{\"verb\": \"\xFF\"}"}) {
    const json reply = json::parse(answer(*shop.foreman_, request));
    EXPECT_FALSE(reply.at("ok").get<bool>()) << request;
    EXPECT_FALSE(reply.at("error").at("what").get<std::string>().empty()) << request;
  }
  EXPECT_TRUE(json::parse(answer(*shop.foreman_, std::string(60000, '['))).contains("error"));
  EXPECT_EQ(shop.ask({{"verb", "jobs.list"}}).at("result").size(), 1U);
}

// A long random life, with kills: what must hold at every moment.
class RandomLife {
 public:
  explicit RandomLife(std::uint64_t seed) : random_(seed) {}

  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      step();
      check_files();
      shop_.now_s_ += 20;
      shop_.foreman_->advance(shop_.now_s_);
      take_orders();
    }
  }

 private:
  void step() {
    switch (random_.below(9)) {
      case 0:
        return drop();
      case 1:
        return end_preparing();
      case 2:
      case 3:
        return end_sending();
      case 4:
        return shop_.run_the_clerk();
      case 5:
        return shop_.foreman_->pause(any_printer(), random_.below(3) == 0), void();
      case 6:
        return clear();
      case 7:
        return ask();
      default:
        if (random_.below(4) == 0) kill();
    }
  }

  std::string any_printer() { return shop_.config_.printers[random_.below(3)].name; }

  void drop() {
    dropped_.insert(std::to_string(shop_.drops_));
    shop_.drop(any_printer(), "m" + std::to_string(random_.below(3)) + ".stl");
  }

  void clear() {
    const std::string name = any_printer();
    if (shop_.ask({{"verb", "printers.clear"}, {"name", name}}).at("ok")) clear_.insert(name);
  }

  void ask() {
    static const char* const kVerbs[] = {"jobs.approve", "jobs.hold",    "jobs.cancel",
                                         "jobs.again",   "jobs.approve", "jobs.approve"};
    const auto id = static_cast<std::int64_t>(random_.below(8) + 1);
    shop_.ask({{"verb", kVerbs[random_.below(6)]}, {"id", id}});
  }

  void take_orders() {
    while (auto order = shop_.prepare_order()) {
      RC_ASSERT(!preparing_);
      RC_ASSERT(shop_.job(order->job).state == JobState::kPreparing);
      RC_ASSERT(fs::exists(order->input));
      RC_ASSERT(!fs::exists(order->out));
      preparing_ = *order;
    }
    for (const PrinterConfig& printer : shop_.config_.printers)
      while (auto order = shop_.send_order(printer.name)) start_print(printer, *order);
  }

  void start_print(const PrinterConfig& printer, const SendOrder& order) {
    JobStore second(shop_.config_.state / "jobs.sqlite");  // what is really on the disk
    const JobRecord job = second.find(order.job).value();
    RC_ASSERT(job.state == JobState::kSending);
    RC_ASSERT(!job.held);
    RC_ASSERT(!sending_.contains(printer.name));
    if (printer.has_bed()) {
      RC_ASSERT(clear_.erase(printer.name) == 1U);
      RC_ASSERT(!second.printer(printer.name).bed_clear);
    }
    RC_ASSERT(!printed_.contains({order.job, order.tray}));
    sending_[printer.name] = order;
  }

  void end_preparing() {
    if (!preparing_) return;
    const PrepareOrder order = *preparing_;
    preparing_.reset();
    if (*order.cancel)
      shop_.tell(PrepareFailed{order.job, {Fault::kInterrupted, "Interrupted", ""}});
    else if (random_.below(4) == 0)
      shop_.tell(PrepareFailed{order.job, {Fault::kBadInput, "bad", "x"}});
    else
      shop_.prepare(order, 1 + static_cast<int>(random_.below(3)), random_.below(2) == 0);
  }

  void end_sending() {
    if (sending_.empty()) return;
    const auto [name, order] =
        *std::next(sending_.begin(), static_cast<std::ptrdiff_t>(random_.below(sending_.size())));
    sending_.erase(name);
    if (order.control->cancelled()) {
      shop_.tell(SendEnded{order.job, SendOutcome::kCancelled, {Fault::kInterrupted, "x", ""}, ""});
    } else if (random_.below(4) == 0) {
      clear_.insert(name);
      shop_.tell(SendEnded{order.job, SendOutcome::kNotStarted, {Fault::kBusy, "x", "y"}, ""});
    } else if (random_.below(4) == 0) {
      printed_.insert({order.job, order.tray});
      shop_.tell(SendEnded{order.job, SendOutcome::kFailed, {Fault::kIo, "x", "y"}, ""});
    } else {
      printed_.insert({order.job, order.tray});
      shop_.tell(SendEnded{order.job, SendOutcome::kDone, {}, ""});
    }
  }

  void kill() {
    for (const auto& [name, order] : sending_)
      if (name != "hand") printed_.insert({order.job, order.tray});
    preparing_.reset();
    sending_.clear();
    shop_.start();
  }

  // Every model that was ever dropped is there once or, printed again from its file, oftener.
  void check_files() {
    std::set<std::string> found;
    for (const fs::path& root : {shop_.folder_.path() / "drop", shop_.config_.state / "jobs"}) {
      if (!fs::exists(root)) continue;
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root))
        if (entry.path().extension() == ".stl")
          found.insert(read_file(entry.path(), 100).substr(6));
    }
    RC_ASSERT(found == dropped_);
  }

  Random random_;
  Workshop shop_;
  std::set<std::string> dropped_;
  std::set<std::string> clear_;
  std::optional<PrepareOrder> preparing_;
  std::map<std::string, SendOrder> sending_;
  std::set<std::pair<std::int64_t, int>> printed_;
};

TEST(Foreman, HoldsItsPromisesThroughRandomLives) {
  EXPECT_TRUE(rc::check("no file lost, no tray twice, no print on an unclear bed",
                        [](std::uint32_t seed) { RandomLife(seed).run(35); }));
}

}  // namespace
}  // namespace packmerger
