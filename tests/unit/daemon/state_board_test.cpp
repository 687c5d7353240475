// What pages are told of: a state, and changes that lead from one to the next.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sqlite3.h>

#include "daemon/views/state_board.h"
#include "workshop.h"

namespace packmerger {
namespace {

// A page, as docs/API.md tells it to take changes.
class Page {
 public:
  void take(const std::string& text) {
    if (text.empty()) return;
    const json change = json::parse(text);
    for (const json& job : change.value("jobs", json::array()))
      jobs_[job.at("id").get<std::int64_t>()].update(job);
    for (const json& one : change.value("printers", json::array()))
      printers_[one.at("name").get<std::string>()].update(one);
    storage_.update(change.value("storage", json::object()));
    troubles_ = change.value("troubles", troubles_);
    const json gone = change.value("gone", json::object());
    for (const json& id : gone.value("jobs", json::array())) jobs_.erase(id.get<std::int64_t>());
    for (const json& name : gone.value("printers", json::array()))
      printers_.erase(name.get<std::string>());
  }

  json state() const {
    json jobs = json::array();
    for (const auto& [id, job] : jobs_) jobs.push_back(job);
    std::sort(jobs.begin(), jobs.end(),
              [](const json& a, const json& b) { return turn(a) > turn(b); });
    json printers = json::array();
    for (const auto& [name, one] : printers_) printers.push_back(one);
    return {{"jobs", jobs}, {"printers", printers}, {"storage", storage_}, {"troubles", troubles_}};
  }

 private:
  static std::tuple<bool, double, std::int64_t> turn(const json& job) {
    const json& ended_s = job.at("ended_s");
    return {ended_s.is_null(), ended_s.is_null() ? 0.0 : ended_s.get<double>(),
            job.at("id").get<std::int64_t>()};
  }

  std::map<std::int64_t, json> jobs_;
  std::map<std::string, json> printers_;
  json storage_ = json::object();
  json troubles_ = json::array();
};

// One of the many things that happen, to jobs chosen at random.
void happen(Workshop& shop, int what, std::int64_t job) {
  const auto ask = [&](const char* verb) { shop.ask({{"verb", verb}, {"id", job}}); };
  const auto at_printer = [&](const char* verb) {
    shop.ask({{"verb", verb}, {"name", job % 2 == 0 ? "sim" : "real"}});
  };
  const Trouble trouble{"its folder is not there", 5, static_cast<int>(job), 9};
  switch (what) {
    case 0:
      shop.drop(job % 2 == 0 ? "sim" : "real", "m.stl");
      break;
    case 1:
      if (const auto order = shop.prepare_order()) {
        shop.tell(PrepareProgress{order->job, "packing", 0.5});
        shop.tell(Hashed{order->job, std::string(64, job % 2 == 0 ? 'a' : 'b')});
        job % 3 == 0 ? shop.tell(PrepareFailed{order->job, {Fault::kBadInput, "no", "mend it"}})
                     : shop.prepare(*order, 2, job % 2 == 0);
      }
      break;
    case 2:
      ask("jobs.approve");
      break;
    case 3:
      ask("jobs.hold");
      break;
    case 4:
      ask("jobs.cancel");
      break;
    case 5:
      ask("jobs.again");
      break;
    case 6:
      for (const char* name : {"sim", "real"})
        if (const auto order = shop.send_order(name)) {
          shop.tell(progress_of(order->job, PrintState::kPrinting, "Layer 1"));
          if (job % 2 == 0) shop.tell(SendEnded{order->job, SendOutcome::kDone, {}, "", 10, 0});
        }
      break;
    case 7:
      at_printer("printers.clear");
      break;
    case 8:
      at_printer("printers.pause");
      break;
    case 9:
      at_printer("printers.resume");
      break;
    case 10:
      shop.run_the_folder_worker();
      break;
    case 11:
      shop.tell(FolderTold{"real", shop.config_.printer("real")->folder,
                           job % 2 == 0 ? std::optional(trouble) : std::nullopt, 1});
      break;
    case 13:
      shop.job_manager_->note_troubles("test",
                                       job % 2 == 0 ? Troubles{{"all", trouble}} : Troubles{});
      break;
    case 12:
      ask("jobs.delete");
      break;
    default:
      if (shop.config_.printers.size() == 3)
        shop.config_.printers.erase(shop.config_.printers.begin());
      else
        shop.config_.printers.insert(shop.config_.printers.begin(),
                                     printer(shop.folder_.path(), "hand", Dialect::kHandoff));
  }
}

RC_GTEST_PROP(StateBoard, ChangesLeadToTheWholeState, ()) {
  Workshop shop;
  StateBoard board(*shop.job_manager_);
  Page page;
  const auto steps =
      *rc::gen::scale(0.2, rc::gen::container<std::vector<std::pair<int, int>>>(
                               rc::gen::pair(rc::gen::inRange(0, 15), rc::gen::inRange(1, 12))));
  for (const auto& [what, job] : steps) {
    happen(shop, what, job);
    page.take(board.look());
    const std::string told = answer(*shop.job_manager_, shop.keys_, R"({"verb": "state"})");
    RC_ASSERT(board.state() == told);
    RC_ASSERT(page.state() == json::parse(told).at("result"));
    RC_ASSERT(board.look().empty());
  }
}

TEST(StateBoard, AJobThatDidNotChangeIsNotToldAgain) {
  Workshop shop;
  StateBoard board(*shop.job_manager_);
  for (int i = 0; i < 20; ++i) shop.drop("sim", "m" + std::to_string(i) + ".stl");
  board.look();
  shop.tell(PrepareProgress{1, "packing", 0.25});
  EXPECT_EQ(json::parse(board.look()), json::parse(R"({"jobs": [{"id": 1, "status": "packing 25 %",
                            "progress": {"stage": "packing", "fraction": 0.25}}]})"));
}

TEST(StateBoard, NothingIsAskedOfTheDatabaseWhereNothingChanged) {
  Workshop shop;
  StateBoard board(*shop.job_manager_);
  for (int i = 0; i < 3; ++i) shop.drop("real", "m" + std::to_string(i) + ".stl");
  shop.job_manager_->cancel(3);
  board.look();
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open((shop.config_.state / "jobs.sqlite").c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "DROP TABLE event; DROP TABLE job", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(other);
  EXPECT_THROW(shop.store_->find(1), Error);
  shop.job_manager_->handle(PrepareProgress{1, "packing", 0.25});
  EXPECT_NE(board.look(), "");
  EXPECT_NE(board.state(), "");
}

TEST(StateBoard, WhatLeavesTheListIsGone) {
  Workshop shop;
  StateBoard board(*shop.job_manager_);
  for (std::size_t i = 0; i <= kLastEnded; ++i) shop.drop("real", "m" + std::to_string(i) + ".stl");
  board.look();
  for (std::size_t i = 0; i <= kLastEnded; ++i)
    shop.job_manager_->cancel(static_cast<std::int64_t>(i + 1));
  EXPECT_EQ(json::parse(board.look()).at("gone"), json::parse(R"({"jobs": [1]})"));
}

}  // namespace
}  // namespace packmerger
