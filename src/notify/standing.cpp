#include "notify/standing.h"

#include "base/time/wall_clock.h"

namespace packmerger {

void Standing::failed(const std::string& what, double pause_s) {
  const double now_s = unix_now_s();
  const std::lock_guard lock(mutex_);
  if (!trouble_) trouble_ = Trouble{{}, now_s, 0, 0};
  trouble_->what = what;
  ++trouble_->tries;
  trouble_->next_s = pause_s > 0 ? now_s + pause_s : 0;
}

void Standing::lasts() {
  const std::lock_guard lock(mutex_);
  if (trouble_) trouble_->next_s = 0;
}

void Standing::works() {
  const std::lock_guard lock(mutex_);
  trouble_.reset();
}

std::optional<Trouble> Standing::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

}  // namespace packmerger
