#include "daemon/workers/print_clock.h"

namespace packmerger {

void PrintClock::report(PrintState state, double now_s) {
  if (state == PrintState::kConnecting && !counted_s_) return;
  if (!counted_s_) counted_s_ = now_s;
  count(now_s);
  paused_ = state == PrintState::kPaused || state == PrintState::kWaiting;
}

void PrintClock::count(double now_s) {
  if (!counted_s_) return;
  (paused_ ? paused_s_ : printed_s_) += now_s - *counted_s_;
  counted_s_ = now_s;
}

}  // namespace packmerger
