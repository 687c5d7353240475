// How long a print really takes: from the moment its printer answers to the end, pauses left out.
#pragma once

#include <optional>

#include "firmware_io/print_state.h"

namespace packmerger {

// Fed with the link's reports and a clock that never goes back.
class PrintClock {
 public:
  void report(PrintState state, double now_s);
  void end(double now_s) { count(now_s); }

  double printed_s() const { return printed_s_; }  // heating included
  double paused_s() const { return paused_s_; }    // paused, or waiting for somebody

 private:
  void count(double now_s);

  std::optional<double> counted_s_;
  bool paused_ = false;
  double printed_s_ = 0;
  double paused_s_ = 0;
};

}  // namespace packmerger
