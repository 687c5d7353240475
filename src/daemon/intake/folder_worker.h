// The worker of one folder: looks for files that arrive there, and takes, copies and files those of
// the jobs that came from it; that of the job folders deletes old ones. It alone touches the
// folder, so that where its disk hangs nobody waits but who wants something of it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "daemon/intake/watch_folder.h"
#include "daemon/orders/messages.h"
#include "daemon/orders/pulse.h"

namespace packmerger {

// Where a folder worker gets its orders, and others see whether it is stuck.
struct FolderQueue {
  Queue<FolderOrder> orders;
  Pulse pulse;
};

// Used by one thread, and lives as long as it.
class FolderWorker {
 public:
  FolderWorker(std::filesystem::path folder, FolderQueue& queue, Queue<Event>& events)
      : folder_(std::move(folder)), queue_(queue), events_(events) {}

  // Until the orders are closed and done.
  void run();

 private:
  void carry_out(const FolderOrder& order);
  void watch(const WatchOrder& order);
  Claimed claim_found(const ClaimOrder& order);
  Fetched fetch_found(const FetchOrder& order);
  void refuse(const std::filesystem::path& file, const Failure& failure);
  void let_go(const std::filesystem::path& file);
  void look();
  void cannot_look(const std::string& why);
  void offer(const WatchFolder::Found& found);
  void leave_note(const WatchFolder::Ignored& ignored) const;
  void tell_trouble();
  void wait() const;

  std::filesystem::path folder_;
  FolderQueue& queue_;
  Queue<Event>& events_;
  WatchOrder order_;  // no printer: nothing is watched
  std::unique_ptr<WatchFolder> watch_;
  std::set<std::filesystem::path> offered_;  // told of, and neither claimed nor refused so far
  std::optional<Trouble> trouble_;           // of the folder
  std::map<std::filesystem::path, Trouble> file_troubles_;
  std::optional<FolderTold> told_;  // what was told last; nothing: nothing of this watch
  double retry_s_ = 0;
};

}  // namespace packmerger
