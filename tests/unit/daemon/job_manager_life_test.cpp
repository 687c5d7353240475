#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "delivery/progress_file.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

// A long random life, with kills: what must hold at every moment.
class RandomLife {
 public:
  explicit RandomLife(std::uint64_t seed) : random_(seed) {}

  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      step();
      check_files();
      shop_.now_s_ += 20;
      shop_.job_manager_->advance(shop_.now_s_);
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
        return shop_.run_the_folder_worker();
      case 5:
        return shop_.job_manager_->pause(any_printer(), random_.below(3) == 0), void();
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
    const std::string number = std::to_string(shop_.drops_);
    const std::string name = "m" + std::to_string(random_.below(3)) + ".stl";
    const std::string printer = any_printer();
    dropped_.insert(number);
    if (random_.below(3) == 0) {
      settings_.insert(number);
      std::ofstream(shop_.config_.printer(printer)->folder / (name + ".toml"))
          << "# seed " << number;
    }
    shop_.drop(printer, name);
  }

  void clear() {
    const std::string name = any_printer();
    if (shop_.ask({{"verb", "printers.clear"}, {"name", name}}).at("ok")) clear_.insert(name);
  }

  void ask() {
    static const char* const kVerbs[] = {"jobs.approve", "jobs.hold",    "jobs.cancel",
                                         "jobs.again",   "jobs.approve", "jobs.first"};
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
      const bool untouched = random_.below(2) == 0;
      if (untouched) clear_.insert(name);
      const Fault fault = untouched ? Fault::kUnavailable : Fault::kBusy;
      shop_.tell(SendEnded{order.job, SendOutcome::kNotStarted, {fault, "x", "y"}, ""});
    } else if (random_.below(4) == 0) {
      clear_.insert(name);
      shop_.tell(
          SendEnded{order.job, SendOutcome::kFailed, {Fault::kBadInput, "x", "y"}, "", 0, 0, true});
    } else if (random_.below(4) == 0) {
      printed_.insert({order.job, order.tray});
      shop_.tell(SendEnded{order.job, SendOutcome::kFailed, {Fault::kIo, "x", "y"}, ""});
    } else {
      printed_.insert({order.job, order.tray});
      shop_.tell(SendEnded{order.job, SendOutcome::kDone, {}, ""});
    }
  }

  void kill() {
    for (const auto& [name, order] : sending_) {
      if (name == "hand") continue;
      const bool is_begun = random_.below(2) == 0;
      if (is_begun) {
        ProgressFile(order.told_file).acknowledged(0, 10);  // before the first byte
        printed_.insert({order.job, order.tray});
      } else {
        clear_.insert(name);
      }
    }
    preparing_.reset();
    sending_.clear();
    shop_.start();
  }

  // Every model that was ever dropped, and its settings beside it, is there once or, printed again
  // from its file, oftener.
  void check_files() {
    std::set<std::string> found;
    std::set<std::string> found_settings;
    for (const fs::path& root : {shop_.folder_.path() / "drop", shop_.config_.state / "jobs"}) {
      if (!fs::exists(root)) continue;
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root))
        if (entry.path().extension() == ".stl")
          found.insert(read_file(entry.path(), 100).substr(6));
        else if (entry.path().extension() == ".toml")
          check_settings(entry.path(), found_settings);
    }
    RC_ASSERT(found == dropped_);
    RC_ASSERT(found_settings == settings_);
  }

  static void check_settings(const fs::path& file, std::set<std::string>& found) {
    const std::string number = read_file(file, 100).substr(7);
    found.insert(number);
    const fs::path model = file.parent_path() / file.stem();
    RC_ASSERT(fs::exists(model));
    RC_ASSERT(read_file(model, 100) == "model " + number);
  }

  Random random_;
  Workshop shop_;
  std::set<std::string> dropped_;
  std::set<std::string> settings_;  // numbers of the models that were dropped with some
  std::set<std::string> clear_;
  std::optional<PrepareOrder> preparing_;
  std::map<std::string, SendOrder> sending_;
  std::set<std::pair<std::int64_t, int>> printed_;
};

TEST(JobManager, HoldsItsPromisesThroughRandomLives) {
  EXPECT_TRUE(rc::check("no file lost, no tray twice, no print on an unclear bed",
                        [](std::uint32_t seed) { RandomLife(seed).run(35); }));
}

}  // namespace
}  // namespace packmerger
