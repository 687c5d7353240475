// The threads that work for the loop: those of worker.h, a sender for each printer among them, and
// one that looks for devices. Only the loop's thread uses it.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "daemon/foreman.h"

namespace packmerger {

class CrewThreads {
 public:
  // crew and events must outlive it.
  CrewThreads(const std::vector<PrinterConfig>& printers, Crew& crew, Queue<Event>& events);
  CrewThreads(const CrewThreads&) = delete;
  CrewThreads& operator=(const CrewThreads&) = delete;
  ~CrewThreads();

  // A printer's sender; it keeps the settings it was started with.
  void start_sender(const PrinterConfig& printer);
  // Waits for a sender that has nothing to send: it ends at once.
  void end_sender(const std::string& printer);

  // Ends everybody's orders and waits. meanwhile is called again and again until the last has
  // ended.
  void finish(const std::function<void()>& meanwhile);

 private:
  std::thread started(std::function<void()> work);

  Crew& crew_;
  Queue<Event>& events_;
  std::atomic<int> running_{0};
  std::atomic<bool> stop_{false};  // of what has no orders
  std::vector<std::thread> others_;
  std::map<std::string, std::thread> senders_;  // by printer
};

}  // namespace packmerger
