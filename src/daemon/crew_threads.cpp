#include "daemon/crew_threads.h"

#include <chrono>

#include "daemon/worker.h"
#include "firmware_io/hotplug.h"

namespace packmerger {
namespace {

constexpr double kDevicesRescan_s = 5;

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

CrewThreads::CrewThreads(const std::vector<PrinterConfig>& printers, Crew& crew,
                         Queue<Event>& events)
    : crew_(crew), events_(events) {
  others_.push_back(started([&] { run_worker(crew.worker, events); }));
  others_.push_back(started([&] { run_worker(crew.checker, events); }));
  others_.push_back(started([&] { run_clerk(crew.clerk, events); }));
  others_.push_back(started([&] { tell_devices(stop_, events); }));
  for (const PrinterConfig& printer : printers) start_sender(printer);
}

CrewThreads::~CrewThreads() {
  finish([] {});
}

std::thread CrewThreads::started(std::function<void()> work) {
  ++running_;
  return std::thread([this, work = std::move(work)] {
    work();
    --running_;
  });
}

void CrewThreads::start_sender(const PrinterConfig& printer) {
  Queue<SendOrder>& orders = crew_.senders[printer.name];
  senders_[printer.name] =
      started([this, &orders, printer] { run_sender(orders, events_, printer); });
}

void CrewThreads::end_sender(const std::string& printer) {
  crew_.senders.at(printer).close();
  senders_.at(printer).join();
  senders_.erase(printer);
  crew_.senders.erase(printer);
}

void CrewThreads::finish(const std::function<void()>& meanwhile) {
  stop_ = true;
  crew_.worker.close();
  crew_.checker.close();
  crew_.clerk.close();
  for (auto& [name, orders] : crew_.senders) orders.close();
  while (running_ > 0) {
    meanwhile();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  for (std::thread& thread : others_)
    if (thread.joinable()) thread.join();
  for (auto& [name, thread] : senders_)
    if (thread.joinable()) thread.join();
}

}  // namespace packmerger
