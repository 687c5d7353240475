// A serial line of a given rate with a simulated firmware at its end, on a pseudo-terminal: every
// byte takes its ten bits' time, both ways.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <thread>

#include "base/descriptor.h"
#include "firmware_io/simulated/firmware.h"

namespace packmerger::bench {

// An answer begins to leave latency_s after the byte that caused it has come in whole. Runs on a
// thread of its own, which spins where a sleep would be too coarse.
class PacedLine {
 public:
  PacedLine(simulated::Firmware& firmware, double baud, double latency_s);
  PacedLine(const PacedLine&) = delete;
  PacedLine& operator=(const PacedLine&) = delete;
  ~PacedLine();

  const std::string& path() const { return path_; }

 private:
  struct Burst {
    double due_s = 0;  // when all of it has passed
    std::string bytes;
  };

  void run();
  double now_s() const;
  void wait(double until_s) const;
  void take_in();
  void deliver(double now_s);
  void collect(double since_s);

  simulated::Firmware& firmware_;
  double byte_s_;
  double latency_s_;
  std::optional<Descriptor> master_;
  std::optional<Descriptor> slave_;  // so that the line lives before it is opened and after
  std::string path_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  double in_free_s_ = 0;   // when the line to the firmware is free again
  double out_free_s_ = 0;  // and the one back
  std::deque<Burst> coming_;
  std::deque<Burst> leaving_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace packmerger::bench
