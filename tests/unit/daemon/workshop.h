// A workshop for tests of the job manager: its store, folders and printers, without any thread or
// clock.
#pragma once

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "base/files.h"
#include "base/random.h"
#include "daemon/intake/beside.h"
#include "daemon/intake/folder_actions.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/local/api.h"
#include "daemon/settings/model_options.h"

namespace packmerger {

using nlohmann::json;

inline PrinterConfig printer(const fs::path& folder, const std::string& name, Dialect dialect) {
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

inline SendProgress progress_of(std::int64_t job, PrintState state, const std::string& text = {},
                                std::vector<std::string> choices = {}) {
  SendProgress progress;
  progress.job = job;
  progress.report.state = state;
  progress.report.done = 5;
  progress.report.total = 10;
  progress.report.text = text;
  progress.report.choices = std::move(choices);
  return progress;
}

// A workshop whose worker, folder worker and printers are played by the test, one order after the
// other.
class Workshop {
 public:
  Workshop() {
    config_.state = folder_.path() / "state";
    config_.prepare.program = "packmerger";
    config_.prepare.workers = 1;
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
    job_manager_.reset();
    store_ = std::make_unique<JobStore>(config_.state / "jobs.sqlite");
    queues_ = std::make_unique<WorkQueues>(config_);
    job_manager_ = std::make_unique<JobManager>(
        config_, *store_, *queues_, [this](const std::string& line) { log_ += line + "\n"; });
    job_manager_->steps().listen(on_step_);
    job_manager_->recover();
    run_claims();
    turn();
  }

  // What the loop does again and again.
  void turn() {
    job_manager_->clean(now_s_);
    job_manager_->advance(now_s_);
  }

  fs::path drop(const std::string& name, const std::string& model) {
    const fs::path file = config_.printer(name)->folder / model;
    std::ofstream(file) << "model " << drops_++;
    job_manager_->handle(Arrived{name, file, has_settings_beside(file)});
    run_claims();
    turn();
    return file;
  }

  void tell(const Event& event) {
    job_manager_->handle(event);
    turn();
  }

  std::optional<PrepareOrder> prepare_order() { return queues_->workers.try_pop(); }
  std::optional<PrepareOrder> check_order() { return queues_->checker.try_pop(); }
  std::optional<SendOrder> send_order(const std::string& name) {
    return queues_->senders.at(name).try_pop();
  }

  void prepare(const PrepareOrder& order, int trays = 1, bool pays = true) {
    fs::create_directories(order.out);
    std::ofstream(order.out / "job.json") << "{}";
    tell(Prepared{order.job, trays, R"({"packed":{"fits":true,"cost":1}})", "marlin", 1, "packed",
                  60, "slicer", pays ? "" : "packing does not pay", ""});
  }

  // The folder workers' work, really done.
  void run_the_folder_worker() {
    while (const std::optional<FolderOrder> order = folder_order()) {
      if (const auto* arrived = std::get_if<ClaimOrder>(&*order)) tell(claim(*arrived));
      if (const auto* distant = std::get_if<FetchOrder>(&*order)) tell(fetch(*distant));
      if (const auto* ended = std::get_if<PlaceOrder>(&*order)) tell(place(*ended));
      if (const auto* placed = std::get_if<FileOrder>(&*order)) tell(file(*placed));
      if (const auto* old = std::get_if<DeleteOrder>(&*order)) tell(clear_away(*old));
    }
  }

  // Of that work only the taking of files that arrived.
  void run_claims() {
    for (auto& item : queues_->folders) {
      std::vector<FolderOrder> others;
      while (std::optional<FolderOrder> order = item.second.orders.try_pop())
        if (const auto* arrived = std::get_if<ClaimOrder>(&*order))
          job_manager_->handle(claim(*arrived));
        else
          others.push_back(std::move(*order));
      for (FolderOrder& other : others) item.second.orders.push(std::move(other));
    }
  }

  std::optional<FolderOrder> folder_order() {
    for (auto& item : queues_->folders)
      if (std::optional<FolderOrder> order = item.second.orders.try_pop()) return order;
    return std::nullopt;
  }

  JobRecord job(std::int64_t id) { return store_->find(id).value(); }
  json ask(const json& request) {
    return json::parse(answer(*job_manager_, keys_, request.dump()));
  }
  json view(std::int64_t id) { return ask({{"verb", "jobs.show"}, {"id", id}}).at("result"); }

  TemporaryFolder folder_;
  DaemonConfig config_;
  std::unique_ptr<JobStore> store_;
  std::unique_ptr<WorkQueues> queues_;
  std::unique_ptr<JobManager> job_manager_;
  KeyRing keys_{folder_.path() / "keys.json"};
  JobSteps::Listener on_step_;
  double now_s_ = 1000;
  int drops_ = 0;
  std::string log_;
};

}  // namespace packmerger
