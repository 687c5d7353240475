#include "daemon/workers/worker_threads.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>

#include "base/time/clock.h"
#include "daemon/settings/workers.h"
#include "daemon/workers/worker.h"
#include "firmware_io/ports/hotplug.h"

namespace packmerger {
namespace {

constexpr double kDevicesRescan_s = 5;
constexpr double kPatience_s = 3;  // at the end, with whoever works at a folder

void tell_devices(const std::atomic<bool>& stop, Queue<Event>& events) {
  watch_devices(stop, kDevicesRescan_s,
                {[&](const Devices& devices) {
                   events.push(DevicesSeen{devices, {}});
                 },
                 [&](const Error& error) {
                   events.push(DevicesSeen{{}, Failure{error.fault(), error.what(), error.hint()}});
                 }});
}

}  // namespace

WorkerThreads::WorkerThreads(const DaemonConfig& config, WorkQueues& queues, Queue<Event>& events)
    : queues_(queues), events_(events) {
  start_workers(workers_of(config.prepare));
  start(others_.emplace_back(), [&] { run_worker(queues.checker, events); });
  start(others_.emplace_back(), [&] { tell_devices(stop_, events); });
  for (const PrinterConfig& printer : config.printers) start_sender(printer);
  start_folder_workers();
}

// Where the start or the loop failed while a disk hangs, nothing else ends.
WorkerThreads::~WorkerThreads() {
  if (!finish([] {}).empty()) std::_Exit(static_cast<int>(Fault::kInternal));
}

void WorkerThreads::start(Member& member, std::function<void()> work) {
  member.thread = std::thread([&member, work = std::move(work)] {
    work();
    member.ended = true;
  });
}

void WorkerThreads::start_sender(const PrinterConfig& printer) {
  Queue<SendOrder>& orders = queues_.senders[printer.name];
  Member& sender = senders_[printer.name];
  if (printer.hands_over()) sender.folder = printer.handoff_folder.string();
  Pulse& pulse = queues_.handing_over[printer.name];
  start(sender, [this, &orders, &pulse, printer] { run_sender(orders, events_, printer, pulse); });
}

void WorkerThreads::end_sender(const std::string& printer) {
  queues_.senders.at(printer).close();
  senders_.at(printer).thread.join();
  senders_.erase(printer);
  queues_.senders.erase(printer);
  queues_.handing_over.erase(printer);
}

void WorkerThreads::start_workers(int count) {
  for (; workers_ < count; ++workers_)
    start(others_.emplace_back(), [this] { run_worker(queues_.workers, events_); });
}

void WorkerThreads::start_folder_workers() {
  for (auto& item : queues_.folders) {
    const std::filesystem::path& folder = item.first;
    FolderQueue& queue = item.second;
    const auto [found, is_new] = folder_workers_.try_emplace(folder);
    if (!is_new) continue;
    found->second.folder = folder.string();
    start(found->second, [this, folder, &queue] { FolderWorker(folder, queue, events_).run(); });
  }
}

void WorkerThreads::wait(const std::function<bool(const Member&)>& for_whom, double until_s,
                         const std::function<void()>& meanwhile) {
  const auto works = [&](const Member& member) { return for_whom(member) && !member.ended; };
  const auto any_works = [&] {
    return std::any_of(others_.begin(), others_.end(), works) ||
           std::any_of(senders_.begin(), senders_.end(),
                       [&](const auto& item) { return works(item.second); }) ||
           std::any_of(folder_workers_.begin(), folder_workers_.end(),
                       [&](const auto& item) { return works(item.second); });
  };
  while (any_works() && steady_now_s() < until_s) {
    meanwhile();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::vector<std::string> WorkerThreads::finish(const std::function<void()>& meanwhile) {
  stop_ = true;
  queues_.workers.close();
  queues_.checker.close();
  for (auto& [name, orders] : queues_.senders) orders.close();
  for (auto& [folder, queue] : queues_.folders) queue.orders.close();
  wait([](const Member& member) { return member.folder.empty(); },
       std::numeric_limits<double>::infinity(), meanwhile);
  wait([](const Member&) { return true; }, steady_now_s() + kPatience_s, meanwhile);
  std::vector<std::string> left;
  const auto let_go = [&](Member& member) {
    if (!member.ended)
      left.push_back(member.folder);
    else if (member.thread.joinable())
      member.thread.join();
  };
  for (Member& member : others_) let_go(member);
  for (auto& [name, sender] : senders_) let_go(sender);
  for (auto& [folder, folder_worker] : folder_workers_) let_go(folder_worker);
  return left;
}

}  // namespace packmerger
