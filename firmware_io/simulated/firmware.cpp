#include "firmware_io/simulated/firmware.h"

#include <algorithm>
#include <cmath>

namespace packmerger::simulated {

void Heater::set_target(double target, double now_s) {
  from_ = temperature(now_s, Pace{});
  since_s_ = now_s;
  target_ = target;
}

double Heater::temperature(double now_s, const Pace& pace) const {
  const double aim = std::max(target_, kRoom);
  if (pace.instant) return aim;
  const double moved = degrees_per_s_ * (now_s - since_s_);
  return aim > from_ ? std::min(aim, from_ + moved) : std::max(aim, from_ - moved);
}

double Heater::ready_s(double now_s, const Pace& pace) const {
  if (pace.instant || target_ <= kRoom) return now_s;
  return std::max(now_s, since_s_ + std::abs(target_ - from_) / degrees_per_s_);
}

}  // namespace packmerger::simulated
