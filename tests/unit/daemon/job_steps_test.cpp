// The job manager makes the steps of the table, all of them, and no other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "delivery/progress_file.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

// What is released was not approved by it: a later one like it would start without being asked for.
TEST(JobSteps, ReleaseApprovesNothing) {
  JobRecord job;
  job.id = 1;
  job.state = JobState::kApproved;
  job.held = job.at_once = true;
  job.reason = "the order to print it at once is an old one";
  JobSteps().apply(job, JobEventKind::kRelease);
  EXPECT_FALSE(job.held || job.at_once || job.approved);
  EXPECT_EQ(job.reason, "");
}

using Rows = std::set<const JobTransition*>;

// A shop in which everything happens, at random: files of all kinds come and go, people ask for
// anything, preparing and printing end in every way, the daemon is stopped and dies.
class AnyLife {
 public:
  explicit AnyLife(std::uint64_t seed) : random_(seed) {
    PrinterConfig any = printer(shop_.folder_.path(), "any", Dialect::kHandoff);
    any.profile = "auto";
    any.prefer = Prefer::kCheapest;
    shop_.config_.printers.push_back(any);
    shop_.on_step_ = [this](std::optional<JobState> from, JobEventKind event) {
      const JobTransition* row = transition_of(from, event);
      RC_ASSERT(row != nullptr);
      rows_.insert(row);
      steps_.insert({from, row->to ? row->to : from});
    };
    start();
  }

  void run(int events) {
    for (int i = 0; i < events; ++i) {
      happen();
      shop_.now_s_ += 20;
      shop_.turn();
      take_orders();
      no_job_is_lost();
    }
  }

  // Everybody does now what is to be done: every job comes to an end, and its file is filed.
  void bring_to_an_end() {
    for (int round = 0; round < 300 && !shop_.store_->open_jobs().empty(); ++round) {
      shop_.run_the_folder_worker();
      while (!preparing_.empty()) prepare(false);
      while (!sending_.empty()) end_print(SendOutcome::kDone);
      for (const PrinterConfig& each : shop_.config_.printers) {
        shop_.job_manager_->pause(each.name, false);
        asked([&] { shop_.job_manager_->clear(each.name); });
      }
      std::vector<std::int64_t> ids;
      for (const auto& item : shop_.store_->open_jobs()) ids.push_back(item.first);
      for (const std::int64_t id : ids) asked([&] { shop_.job_manager_->approve(id); });
      shop_.now_s_ += 4000;
      shop_.turn();
      take_orders();
    }
    RC_ASSERT(shop_.store_->open_jobs().empty());
    no_job_is_lost();
  }

  const Rows& rows() const { return rows_; }

 private:
  void start() {
    preparing_.clear();
    sending_.clear();
    shop_.start();
    shop_.store_->listen([this](const JobRecord& job, std::string_view) { written(job); });
    for (const auto& item : shop_.store_->open_jobs()) known_[item.first] = item.second.state;
  }

  // What came into the database is a step that was made.
  void written(const JobRecord& job) {
    const auto before = known_.find(job.id);
    const std::optional<JobState> from =
        before == known_.end() ? std::nullopt : std::optional(before->second);
    RC_ASSERT(from == job.state || steps_.contains({from, job.state}) ||
              was_silent(from, job.state));
    known_[job.id] = job.state;
  }

  // Begun and given up again without a line in between: what is tried again and again.
  static bool was_silent(std::optional<JobState> from, JobState to) {
    return from == JobState::kApproved && (has_ended(to) || to == JobState::kReceived);
  }

  void no_job_is_lost() {
    for (const auto& item : known_) {
      const std::optional<JobRecord> job = shop_.store_->find(item.first);
      RC_ASSERT(job || rows_.contains(transition_of(JobState::kClaiming, JobEventKind::kNotTaken)));
      if (!job) continue;
      RC_ASSERT(shop_.store_->open_jobs().contains(job->id) ==
                (!has_ended(job->state) || !job->filing_done));
    }
  }

  template <typename Ask>
  static void asked(const Ask& ask) {
    try {
      ask();
    } catch (const Error& error) {
      RC_ASSERT(error.fault() == Fault::kUsage || error.fault() == Fault::kBusy ||
                error.fault() == Fault::kNoInput || error.fault() == Fault::kBadInput);
    }
  }

  bool one_in(std::size_t n) { return random_.below(n) == 0; }
  std::string any_printer() { return shop_.config_.printers[random_.below(4)].name; }

  void happen() {
    switch (random_.below(12)) {
      case 0:
      case 1:
        return come();
      case 2:
      case 3:
        return prepare(one_in(3));
      case 4:
      case 5:
        return print();
      case 6:
      case 7:
        return work_in_folders();
      case 8:
        return asked([&] { ask_for_a_job(); });
      case 9:
        return asked([&] { ask_for_a_job(); });
      case 10:
        shop_.job_manager_->pause(any_printer(), one_in(5));
        return asked([&] { shop_.job_manager_->clear(any_printer()); });
      default:
        if (one_in(3)) leave();
    }
  }

  void come() {
    const std::string name = "m" + std::to_string(shop_.drops_) + ".stl";
    if (one_in(3)) {
      const fs::path file = shop_.config_.state / ("upload-" + name);
      std::ofstream(file) << "model " << shop_.drops_++;
      UploadedJob upload{any_printer(), name, file};
      (one_in(2) ? upload.at_once : upload.held) = true;
      return asked([&] { shop_.job_manager_->uploaded(upload); });
    }
    const std::string printer = any_printer();
    const fs::path file = shop_.config_.printer(printer)->folder / name;
    std::ofstream(file) << "model " << shop_.drops_++;
    if (one_in(5)) std::ofstream(settings_beside(file)) << "this says = nothing\n";
    shop_.job_manager_->handle(Arrived{printer, file, has_settings_beside(file)});
  }

  void work_in_folders() {
    const std::optional<FolderOrder> order = shop_.folder_order();
    if (!order) return;
    const bool fails = one_in(4);
    const Failure failure{one_in(2) ? Fault::kBusy : Fault::kIo, "it cannot be", "look"};
    if (const auto* arrived = std::get_if<ClaimOrder>(&*order)) {
      if (fails && one_in(2)) fs::remove(arrived->from);
      if (fails && !fs::exists(arrived->to) && one_in(2))
        shop_.tell(Claimed{arrived->job, ClaimOutcome::kOtherFileSystem, {}});
      else
        shop_.tell(claim(*arrived));
    } else if (const auto* distant = std::get_if<FetchOrder>(&*order)) {
      shop_.tell(fails ? Fetched{distant->job, failure} : fetch(*distant));
    } else if (const auto* ended = std::get_if<PlaceOrder>(&*order)) {
      shop_.tell(fails ? Placed{ended->job, {}, failure} : place(*ended));
    } else if (const auto* placed = std::get_if<FileOrder>(&*order)) {
      shop_.tell(fails ? Filed{placed->job, failure} : file(*placed));
    } else if (const auto* old = std::get_if<DeleteOrder>(&*order)) {
      shop_.tell(clear_away(*old));
    }
  }

  void take_orders() {
    while (auto order = shop_.prepare_order()) preparing_.push_back(std::move(*order));
    for (const PrinterConfig& each : shop_.config_.printers)
      while (auto order = shop_.send_order(each.name)) sending_.push_back(std::move(*order));
  }

  void prepare(bool fails) {
    if (preparing_.empty()) return;
    const PrepareOrder order = preparing_.back();
    preparing_.pop_back();
    const Failure failure{*order.cancel ? Fault::kInterrupted : Fault::kBadInput, "it is bad", "x"};
    if (*order.cancel) return shop_.tell(PrepareFailed{order.job, failure});
    if (order.compare.empty() && one_in(2))
      shop_.tell(Hashed{order.job, std::to_string(random_.below(9))});
    if (!order.compare.empty()) return compare(order, fails);
    if (fails) return shop_.tell(PrepareFailed{order.job, failure});
    shop_.prepare(order, 1 + static_cast<int>(random_.below(3)), one_in(2));
  }

  void compare(const PrepareOrder& order, bool fails) {
    Compared compared{order.job, {}};
    for (const CompareOrder& each : order.compare)
      compared.printers.push_back({each.printer, each.variant,
                                   R"({"packed":{"fits":true,"time_s":60,"cost":1}})",
                                   fails ? "it is too large" : ""});
    shop_.tell(compared);
  }

  void print() {
    if (sending_.empty()) return;
    constexpr SendOutcome kOutcomes[] = {SendOutcome::kDone, SendOutcome::kDone,
                                         SendOutcome::kFailed, SendOutcome::kNotStarted};
    const SendOrder& order = sending_.back();
    if (one_in(2)) shop_.tell(progress_of(order.job, PrintState::kPrinting));
    end_print(kOutcomes[random_.below(4)]);
  }

  void end_print(SendOutcome outcome) {
    const SendOrder order = sending_.back();
    sending_.pop_back();
    if (order.control->cancelled() && outcome != SendOutcome::kDone)
      outcome = SendOutcome::kCancelled;
    SendEnded ended{order.job, outcome, {Fault::kUnavailable, "it was so", "look"}, ""};
    if (outcome == SendOutcome::kDone) ended.failure = {};
    ended.untouched = outcome != SendOutcome::kDone && one_in(3);
    shop_.tell(ended);
  }

  void ask_for_a_job() {
    JobManager& job_manager = *shop_.job_manager_;
    const auto id = static_cast<std::int64_t>(random_.below(known_.size() + 1) + 1);
    switch (random_.below(8)) {
      case 0:
        return job_manager.hold(id), void();
      case 1:
        return job_manager.put_first(id), void();
      case 2:
        return job_manager.cancel(id), void();
      case 3:
        return job_manager.again(id), void();
      case 4:
        return job_manager.prepare(id, "packed"), void();
      case 5:
        return job_manager.remove(id), void();
      case 6:  // held and released: by chance it seldom meets a job that is approved
        job_manager.hold(id);
        return job_manager.approve(id), void();
      default:
        return job_manager.approve(id), void();
    }
  }

  // The daemon ends in order, or dies once or again and again.
  void leave() {
    if (one_in(2)) {
      shop_.job_manager_->stop();
      while (!preparing_.empty()) prepare(false);
      while (!sending_.empty()) end_print(SendOutcome::kCancelled);
      return start();
    }
    for (int deaths = one_in(2) ? 6 : 1; deaths > 0; --deaths) {
      for (const SendOrder& order : sending_)
        if (one_in(2)) ProgressFile(order.told_file).acknowledged(0, 10);
      start();
      take_orders();
    }
  }

  Random random_;
  Rows rows_;
  std::set<std::pair<std::optional<JobState>, std::optional<JobState>>> steps_;
  std::map<std::int64_t, JobState> known_;
  std::vector<PrepareOrder> preparing_;
  std::vector<SendOrder> sending_;
  Workshop shop_;
};

TEST(JobSteps, AreThoseOfTheTableAndNoJobIsLost) {
  EXPECT_TRUE(rc::check("random lives", [](std::uint32_t seed) {
    AnyLife life(seed);
    life.run(15);
    life.bring_to_an_end();
  }));
}

// Those that no such life needs to reach have tests of their own:
// ChildJson.WhateverIsThrownFailsTheJobAndNotTheDaemon, those of Cleaning, and
// Variant.WhatIsHeldStaysHeldInTheNewJob.
constexpr JobEventKind kElsewhere[] = {JobEventKind::kBroken, JobEventKind::kDeleted,
                                       JobEventKind::kReplace};

TEST(JobSteps, EveryRowOfTheTableIsReached) {
  std::set<std::string_view> left;
  Rows reached;
  for (std::uint64_t seed = 0; seed == 0 || (seed < 500 && !left.empty()); ++seed) {
    AnyLife life(seed);
    life.run(60);
    reached.insert(life.rows().begin(), life.rows().end());
    left.clear();
    for (const JobTransition& row : kJobTransitions)
      if (!reached.contains(&row) && std::find(std::begin(kElsewhere), std::end(kElsewhere),
                                               row.event) == std::end(kElsewhere))
        left.insert(event_name(row.event));
  }
  EXPECT_THAT(left, testing::IsEmpty());
}

}  // namespace
}  // namespace packmerger
