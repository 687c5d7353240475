// The simulated Replicator's machine: its queue, its clock, what its actions do.
#include "firmware_io/simulated/replicator.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace packmerger::simulated {

namespace {

constexpr std::size_t kLongestPayload = 32;
constexpr double kPacketTimeout_s = 0.2;
constexpr double kNoiseInterval_s = 0.0005;
constexpr double kHoming_s = 5;
constexpr double kBoot_s = 2;
constexpr double kButton_s = 5;  // someone presses the button after this

std::string hex(const Bytes& bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

}  // namespace

double Replicator::next_event_s() const {
  double next = std::min(stop_at_s_, noise_since_s_);
  if (expect_ != Expect::kHeader && traits_.packet_timeout)
    next = std::min(next, packet_since_s_ + pace_.line_s(kPacketTimeout_s));
  if (!queue_.empty() && !paused_) next = std::min(next, busy_until_s_);
  return next;
}

void Replicator::advance(double now_s) {
  now_s_ = now_s;
  if (now_s >= stop_at_s_) stop(now_s);
  if (traits_.packet_timeout && expect_ != Expect::kHeader &&
      now_s >= packet_since_s_ + pace_.line_s(kPacketTimeout_s)) {
    expect_ = Expect::kHeader;
    answer(0x8C);
  }
  // Nobody may be listening: what cannot be sent is not piled up.
  constexpr std::size_t kEnough = 1024;
  while (noise_since_s_ <= now_s) {
    if (output_.size() < kEnough) answer(0x80);
    if (!traits_.noise_endless) {
      noise_since_s_ = kNever;
      break;
    }
    noise_since_s_ += pace_.line_s(kNoiseInterval_s);
    if (output_.size() >= kEnough) noise_since_s_ = std::max(noise_since_s_, now_s);
    if (noise_since_s_ == now_s) break;
  }
  while (!queue_.empty() && !paused_ && now_s >= busy_until_s_) {
    waits_for_button_ = false;
    const Bytes action = queue_.front();
    queue_.pop_front();
    queued_bytes_ -= action.size();
    // Time runs on from where the action before ended, not from when we happened to look.
    execute(action, pace_.instant ? now_s : std::max(busy_until_s_, packet_since_s_));
  }
}

void Replicator::clear() {
  queue_.clear();
  queued_bytes_ = 0;
  busy_until_s_ = homing_until_s_ = 0;
  paused_ = waits_for_button_ = false;
}

void Replicator::stop(double now_s) {
  stop_at_s_ = kNever;
  const bool building = state_ == kRunning || state_ == kPausedState;
  if (building || !queue_.empty() || now_s < busy_until_s_) executed_.emplace_back("abort");
  clear();
  for (Heater& heater : tools_) heater.set_target(0, now_s);
  platform_.set_target(0, now_s);
  if (building) {
    state_ = kCancelled;
    last_count_ = executed_count_;
  }
}

void Replicator::cancel_at_panel() {
  clear();
  state_ = kCancelled;
  last_count_ = executed_count_;
  tell_cancelled_ = true;
}

void Replicator::press_pause() {
  if (state_ != kRunning && state_ != kPausedState) return;
  paused_ = !paused_;
  state_ = paused_ ? kPausedState : kRunning;
  busy_until_s_ = std::max(busy_until_s_, now_s_);
}

void Replicator::overheat() {
  clear();
  overheated_ = true;
}

// Someone chose a file at the panel: what the host sends is refused from now on.
void Replicator::build_from_card() {
  clear();
  from_card_ = true;
}

void Replicator::power_cycle() {
  clear();
  state_ = kNone;
  executed_count_ = last_count_ = 0;
  build_name_.clear();
  expect_ = Expect::kHeader;
  noise_since_s_ = kNever;
  tell_cancelled_ = overheated_ = from_card_ = false;
  booted_at_s_ = now_s_ + pace_.line_s(kBoot_s);
  output_.clear();
}

void Replicator::wait(double seconds, double now_s) {
  busy_until_s_ = now_s + pace_.machine_s(seconds);
}

void Replicator::execute(const Bytes& sent, double now_s) {
  executed_.push_back(hex(sent));
  if (traits_.counts_actions) ++executed_count_;
  Bytes action = sent;  // the firmware reads what it expects, however little was sent
  action.resize(std::max<std::size_t>(action.size(), kLongestPayload));
  switch (action[0]) {
    case 0x83:
    case 0x84:
      wait(kHoming_s, now_s);
      homing_until_s_ = busy_until_s_;
      return;
    case 0x85:
      return wait(u32(action, 1) / 1000.0, now_s);
    case 0x87:
      return wait(tool(action[1]).ready_s(now_s, pace_) - now_s, now_s);
    case 0x8D:
      return wait(platform_.ready_s(now_s, pace_) - now_s, now_s);
    case 0x88:
      return execute_tool_action(action, now_s);
    case 0x8B:
    case 0x8C:
    case 0x8E:
    case 0x9B:
      return execute_move(action, now_s);
    case 0x94:
      waits_for_button_ = true;
      return wait(kButton_s, now_s);
    case 0x95:
      if ((action[1] & 4U) == 0) return;
      waits_for_button_ = true;
      return wait(kButton_s, now_s);
    case 0x99:
      return begin_build(action);
    case 0x9A:
      return end_build(now_s);
    case 0x86:
    case 0x89:
    case 0x8F:
    case 0x90:
    case 0x91:
    case 0x92:
    case 0x93:
    case 0x96:
    case 0x97:
    case 0x9C:
    case 0x9D:
    case 0x9E:
      return;
    default:
      // The true firmware takes an unknown action without complaint and loses its build.
      state_ = kNone;
  }
}

void Replicator::execute_tool_action(const Bytes& action, double now_s) {
  if (action[2] == 0x03) tool(action[1]).set_target(u16(action, 4), now_s);
  if (action[2] == 0x1F) platform_.set_target(u16(action, 4), now_s);
}

// Moves, and the setting of the position, which the position query shows with the next move.
// Durations are those that the action itself states.
void Replicator::execute_move(const Bytes& action, double now_s) {
  const unsigned relative = action[0] == 0x9B || action[0] == 0x8E ? action[25] : 0;
  float distance_mm = 0;
  const std::uint32_t bits = u32(action, 26);
  std::memcpy(&distance_mm, &bits, sizeof bits);
  if (action[0] == 0x9B && distance_mm == 0) return;  // passed over
  const std::array<std::int32_t, 5> from = position_;
  double longest = 0;
  for (std::size_t axis = 0; axis < position_.size(); ++axis) {
    const auto steps = static_cast<std::int32_t>(u32(action, 1 + 4 * axis));
    const bool is_relative = (relative >> axis & 1U) != 0;
    const double way = is_relative ? steps : static_cast<double>(steps) - position_[axis];
    longest = std::max(longest, std::abs(way));
    position_[axis] = static_cast<std::int32_t>(is_relative ? position_[axis] + way : steps);
  }
  if (action[0] == 0x8C) return;
  const double speed_mm_s = u16(action, 30) / 64.0;
  const double rate = u32(action, 21);
  if (action[0] == 0x8E)
    wait(rate / 1e6, now_s);
  else if (action[0] == 0x8B)
    wait(longest * rate / 1e6, now_s);
  else if (speed_mm_s > 0)
    wait(std::abs(distance_mm) / speed_mm_s, now_s);
  else if (rate > 0)
    wait(longest / rate, now_s);
  if (longest > 0) move_ = {from, position_, now_s, busy_until_s_};
}

void Replicator::begin_build(const Bytes& action) {
  build_name_.assign(action.begin() + 5, action.end());
  build_name_ = build_name_.c_str();
  state_ = kRunning;
  executed_count_ = 0;
  build_since_s_ = now_s_;
}

void Replicator::end_build(double now_s) {
  state_ = kFinished;
  last_count_ = executed_count_;
  for (Heater& heater : tools_) heater.set_target(0, now_s);
  platform_.set_target(0, now_s);
}

}  // namespace packmerger::simulated
