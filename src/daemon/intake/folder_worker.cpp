#include "daemon/intake/folder_worker.h"

#include <poll.h>

#include <algorithm>
#include <vector>

#include "base/files.h"
#include "base/names.h"
#include "base/storage/move_file.h"
#include "base/time/backoff.h"
#include "daemon/intake/beside.h"
#include "daemon/intake/folder_actions.h"

namespace packmerger {
namespace {

constexpr double kLongestWait_s = 60;

std::string sentences(const Failure& failure) {
  return printable(failure.what + (failure.hint.empty() ? "" : ". " + failure.hint));
}

}  // namespace

void FolderWorker::run() {
  for (;;) {
    while (const std::optional<FolderOrder> order = queue_.orders.try_pop()) carry_out(*order);
    if (queue_.orders.closed()) return;
    look();
    tell_trouble();
    wait();
  }
}

void FolderWorker::carry_out(const FolderOrder& order) {
  const Pulse::Stroke stroke(queue_.pulse);
  if (const auto* watched = std::get_if<WatchOrder>(&order)) watch(*watched);
  if (const auto* arrived = std::get_if<ClaimOrder>(&order)) events_.push(claim_found(*arrived));
  if (const auto* distant = std::get_if<FetchOrder>(&order)) events_.push(fetch_found(*distant));
  if (const auto* ended = std::get_if<PlaceOrder>(&order)) events_.push(place(*ended));
  if (const auto* placed = std::get_if<FileOrder>(&order)) events_.push(file(*placed));
  if (const auto* old = std::get_if<DeleteOrder>(&order)) events_.push(clear_away(*old));
}

void FolderWorker::watch(const WatchOrder& order) {
  order_ = order;
  watch_.reset();
  offered_.clear();
  file_troubles_.clear();
  trouble_.reset();
  told_.reset();
  retry_s_ = 0;
}

// What was moved already is only finished; of the rest, it may have been changed since it was told
// of.
Claimed FolderWorker::claim_found(const ClaimOrder& order) {
  const bool is_fresh = !is_taken(order.to);
  if (is_fresh && !(watch_ && watch_->is_still_whole(order.from, steady_now_s()))) {
    let_go(order.from);
    return {order.job, ClaimOutcome::kGone, {}};
  }
  const Claimed claimed = claim(order);
  if (claimed.outcome == ClaimOutcome::kFailed && !is_taken(order.to))
    refuse(order.from, claimed.failure);
  else if (claimed.outcome != ClaimOutcome::kOtherFileSystem)
    let_go(order.from);
  return claimed;
}

Fetched FolderWorker::fetch_found(const FetchOrder& order) {
  const Fetched fetched = fetch(order);
  if (order.keep) return fetched;
  if (fetched.failure)
    refuse(order.from, *fetched.failure);
  else
    let_go(order.from);
  return fetched;
}

void FolderWorker::refuse(const fs::path& file, const Failure& failure) {
  offered_.erase(file);
  if (!watch_) return;
  const double pause_s = watch_->refuse(file, steady_now_s(), order_.retry_s);
  const double now_s = unix_now_s();
  Trouble& trouble = file_troubles_.try_emplace(file, Trouble{{}, now_s, 0, 0}).first->second;
  trouble.what = sentences(failure);
  ++trouble.tries;
  trouble.next_s = now_s + pause_s;
}

void FolderWorker::let_go(const fs::path& file) {
  offered_.erase(file);
  file_troubles_.erase(file);
}

// While files that were found are still to be claimed, it is not looked for others.
void FolderWorker::look() {
  const double now = steady_now_s();
  if (order_.printer.empty() || !offered_.empty() || now < retry_s_) return;
  const Pulse::Stroke stroke(queue_.pulse);
  try {
    if (!watch_) watch_ = std::make_unique<WatchFolder>(folder_, order_.rules);
    offer(watch_->look(now));
    std::erase_if(file_troubles_, [](const auto& item) { return !is_taken(item.first); });
    trouble_.reset();
  } catch (const Error& error) {
    cannot_look(sentences({error.fault(), error.what(), error.hint()}));
  } catch (const std::exception& error) {
    cannot_look(printable(error.what()));
  }
}

void FolderWorker::cannot_look(const std::string& why) {
  const double now_s = unix_now_s();
  if (!trouble_) trouble_ = Trouble{{}, now_s, 0, 0};
  const double pause_s = backoff_s(order_.retry_s, trouble_->tries++);
  trouble_->what = why;
  trouble_->next_s = now_s + pause_s;
  retry_s_ = steady_now_s() + pause_s;
}

void FolderWorker::offer(const WatchFolder::Found& found) {
  for (const WatchFolder::Ignored& ignored : found.ignored) {
    events_.push(FileIgnored{ignored.path, ignored.reason});
    try {
      leave_note(ignored);
    } catch (const std::exception& error) {
      file_troubles_[ignored.path] = {printable(error.what()), unix_now_s(), 1, 0};
    }
  }
  for (const fs::path& whole : found.whole) {
    offered_.insert(whole);
    events_.push(Arrived{order_.printer, whole, has_settings_beside(whole)});
  }
}

// Whoever put it there looks here, and not into the daemon's messages.
void FolderWorker::leave_note(const WatchFolder::Ignored& ignored) const {
  const fs::path failed = ignored.path.parent_path() / "failed";
  const std::string name = ignored.path.filename().string();
  fs::create_directories(failed);
  write_file_whole(note_beside(failed / name, kReasonNote),
                   printable(name) + ": not taken, " + ignored.reason + "\n");
}

void FolderWorker::tell_trouble() {
  if (order_.printer.empty()) return;
  FolderTold now{order_.printer, folder_, trouble_, 0};
  if (!trouble_ && !file_troubles_.empty()) {
    const auto first = std::min_element(
        file_troubles_.begin(), file_troubles_.end(),
        [](const auto& a, const auto& b) { return a.second.since_s < b.second.since_s; });
    now.trouble = first->second;
    now.others = file_troubles_.size() - 1;
  }
  if (told_ && now.trouble == told_->trouble && now.others == told_->others) return;
  told_ = now;
  events_.push(std::move(now));
}

void FolderWorker::wait() const {
  std::vector<pollfd> waiting = {{queue_.orders.fd(), POLLIN, 0}};
  double until_s = steady_now_s() + kLongestWait_s;
  const bool may_look = !order_.printer.empty() && offered_.empty();
  if (may_look) until_s = std::min(until_s, std::max(retry_s_, watch_ ? watch_->next_look_s() : 0));
  if (may_look && watch_ && retry_s_ <= steady_now_s())
    waiting.push_back({watch_->fd(), POLLIN, 0});
  const int timeout_ms = std::max(0, static_cast<int>(1000 * (until_s - steady_now_s()))) + 1;
  ::poll(waiting.data(), waiting.size(), timeout_ms);
}

}  // namespace packmerger
