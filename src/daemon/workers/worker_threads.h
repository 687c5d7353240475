// The threads that work for the loop: those of worker.h, a sender for each printer among them, a
// folder worker for each folder, and one that looks for devices. Only the loop's thread uses it.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "daemon/jobs/job_manager.h"

namespace packmerger {

class WorkerThreads {
 public:
  // queues and events must outlive it.
  WorkerThreads(const DaemonConfig& config, WorkQueues& queues, Queue<Event>& events);
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;
  ~WorkerThreads();

  // A printer's sender; it keeps the settings it was started with.
  void start_sender(const PrinterConfig& printer);
  // Waits for a sender that has nothing to send: it ends at once.
  void end_sender(const std::string& printer);

  // From now on at least so many workers prepare models; those that are there stay.
  void start_workers(int count);

  // Folders that got orders since the last call get their folder workers.
  void start_folder_workers();

  // Ends everybody's orders and waits; meanwhile is called again and again. Whoever works at a
  // folder is waited for some seconds only, because its disk may hang. Returns the folders of those
  // that have not ended: then the process must end without returning to what they use.
  std::vector<std::string> finish(const std::function<void()>& meanwhile);

 private:
  struct Member {
    std::string folder = {};  // where it works at one whose disk may hang
    std::atomic<bool> ended{false};
    std::thread thread = {};
  };

  void start(Member& member, std::function<void()> work);
  void wait(const std::function<bool(const Member&)>& for_whom, double until_s,
            const std::function<void()>& meanwhile);

  WorkQueues& queues_;
  Queue<Event>& events_;
  std::atomic<bool> stop_{false};  // of what has no orders
  std::list<Member> others_;
  int workers_ = 0;                                         // among those
  std::map<std::string, Member> senders_;                   // by printer
  std::map<std::filesystem::path, Member> folder_workers_;  // by folder
};

}  // namespace packmerger
