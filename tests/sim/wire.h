// Talks to a simulated firmware byte by byte, without a link.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "firmware_io/simulated/firmware.h"

namespace packmerger::test {

class Wire {
 public:
  explicit Wire(simulated::Firmware& firmware) : firmware_(firmware) {}

  // What the firmware answers to `bytes` within so many seconds.
  std::string says(std::string_view bytes, double seconds = 0.01) {
    firmware_.receive(bytes, now_s_);
    const double end_s = now_s_ + seconds;
    while (firmware_.next_event_s() <= end_s) {
      now_s_ = std::max(now_s_, firmware_.next_event_s());
      firmware_.advance(now_s_);
    }
    now_s_ = end_s;
    firmware_.advance(now_s_);
    return firmware_.take_output();
  }

 private:
  simulated::Firmware& firmware_;
  double now_s_ = 0;
};

}  // namespace packmerger::test
