#include "firmware_io/simulated/replicator.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace packmerger::simulated {

namespace {

constexpr std::uint16_t kVersion = 708;
constexpr std::size_t kBufferBytes = 512;
constexpr std::size_t kLongestPayload = 32;
constexpr double kPacketTimeout_s = 0.2;
constexpr double kNoiseInterval_s = 0.0005;
constexpr double kAbort_s = 0.3;
constexpr double kHoming_s = 5;
constexpr double kButton_s = 5;  // someone presses the button after this

enum State : std::uint8_t { kNone, kRunning, kFinished, kPausedState, kCancelled };

using Bytes = std::basic_string<std::uint8_t>;

// The iButton checksum, bit by bit as its register shifts.
std::uint8_t checksum(const Bytes& bytes) {
  unsigned shift = 0;
  for (std::uint8_t byte : bytes)
    for (unsigned bit = 0; bit < 8; ++bit) {
      const bool feedback = ((shift ^ (static_cast<unsigned>(byte) >> bit)) & 1U) != 0;
      shift = (shift >> 1U) ^ (feedback ? 0x8CU : 0U);
    }
  return static_cast<std::uint8_t>(shift);
}

Bytes little_endian(std::uint32_t value, int bytes) {
  Bytes result;
  for (int i = 0; i < bytes; ++i) result += static_cast<std::uint8_t>(value >> (8 * i));
  return result;
}

std::uint32_t u32(const Bytes& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (at + i < bytes.size()) value |= static_cast<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

std::uint16_t u16(const Bytes& bytes, std::size_t at) {
  return static_cast<std::uint16_t>(u32(bytes, at) & 0xFFFFU);
}

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

void Replicator::receive(std::string_view bytes, double now_s) {
  advance(now_s);
  for (char c : bytes) {
    take_byte(static_cast<std::uint8_t>(c), now_s);
    advance(now_s);
  }
}

void Replicator::take_byte(std::uint8_t byte, double now_s) {
  switch (expect_) {
    case Expect::kHeader:
      if (byte != 0xD5) {
        noise_since_s_ = std::min(noise_since_s_, now_s);
        return;
      }
      noise_since_s_ = kNever;
      packet_since_s_ = now_s;
      payload_.clear();
      expect_ = Expect::kLength;
      return;
    case Expect::kLength:
      length_ = byte;
      expect_ = length_ == 0 ? Expect::kChecksum : Expect::kPayload;
      if (length_ > kLongestPayload) {
        expect_ = Expect::kHeader;
        answer(0x84);
      }
      return;
    case Expect::kPayload:
      payload_ += byte;
      if (payload_.size() == length_) expect_ = Expect::kChecksum;
      return;
    case Expect::kChecksum:
      expect_ = Expect::kHeader;
      if (byte == checksum(payload_))
        take_packet(now_s);
      else
        answer(0x83);
      return;
  }
}

void Replicator::take_packet(double now_s) {
  if (tell_cancelled_ || overheated_) {
    answer(tell_cancelled_ ? 0x89 : 0x8B);
    tell_cancelled_ = false;
  } else if (payload_.empty()) {
    answer(0x85);
  } else if (payload_[0] >= 0x80) {
    take_action();
  } else {
    take_query(now_s);
  }
}

void Replicator::take_action() {
  if (queued_bytes_ + payload_.size() > kBufferBytes) return answer(0x82);
  queue_.push_back(payload_);
  queued_bytes_ += payload_.size();
  answer(0x81);
}

void Replicator::take_query(double now_s) {
  const auto free_bytes = static_cast<std::uint32_t>(kBufferBytes - queued_bytes_);
  switch (payload_[0]) {
    case 0x00:
      return answer(0x81, little_endian(u16(payload_, 1) < 39 ? 0 : kVersion, 2));
    case 0x01:
      return answer(0x81);
    case 0x02:
      return answer(0x81, little_endian(free_bytes, 4));
    case 0x03:
    case 0x07:
    case 0x11:
      stop_at_s_ = now_s + pace_.line_s(pace_.machine_s(kAbort_s));
      return answer(0x81);
    case 0x08:
      if (state_ == kRunning || state_ == kPausedState) {
        paused_ = !paused_;
        state_ = paused_ ? kPausedState : kRunning;
        busy_until_s_ = std::max(busy_until_s_, now_s);
      }
      return answer(0x81);
    case 0x0A:
      return take_tool_query(now_s);
    case 0x0B:
      return answer(0x81,
                    {queue_.empty() && now_s >= busy_until_s_ ? std::uint8_t{1} : std::uint8_t{0}});
    case 0x0C:
      return answer(0x81,
                    Bytes(payload_.size() > 3 ? std::min<std::size_t>(payload_[3], 31) : 0, 0));
    case 0x14:
      return answer(0x81, Bytes(build_name_.begin(), build_name_.end()) + Bytes(1, 0));
    case 0x15:
      return answer(0x81, position());
    case 0x16:
      if (payload_.size() > 1 && (payload_[1] & 2U) != 0) clear();
      return answer(0x81, {0});
    case 0x17:
      return answer(0x81, {static_cast<std::uint8_t>(waits_for_button_ ? 0x10 : 0)});
    case 0x18:
      return answer(0x81, statistics());
    case 0x1B:
      return answer(0x81, little_endian(kVersion, 2) + Bytes{0, 0, 0x80, 0, 0, 0});
    default:
      return answer(0x85);
  }
}

void Replicator::take_tool_query(double now_s) {
  if (payload_.size() < 3) return answer(0x85);
  const Heater& heater = tool(payload_[1]);
  const auto rounded = [](double degrees) {
    return little_endian(static_cast<std::uint32_t>(std::lround(degrees)), 2);
  };
  switch (payload_[2]) {
    case 0x00:
      return answer(0x81, little_endian(kVersion, 2));
    case 0x02:
      return answer(0x81, rounded(heater.temperature(now_s, pace_)));
    case 0x1E:
      return answer(0x81, rounded(platform_.temperature(now_s, pace_)));
    case 0x20:
      return answer(0x81, rounded(heater.target()));
    case 0x21:
      return answer(0x81, rounded(platform_.target()));
    case 0x16:
    case 0x24:
      return answer(0x81,
                    {heater.ready_s(now_s, pace_) <= now_s ? std::uint8_t{1} : std::uint8_t{0}});
    case 0x23:
      return answer(0x81,
                    {platform_.ready_s(now_s, pace_) <= now_s ? std::uint8_t{1} : std::uint8_t{0}});
    default:
      return answer(0x85);
  }
}

void Replicator::answer(std::uint8_t code, const Bytes& rest) {
  const Bytes payload = Bytes(1, code) + rest;
  output_ += static_cast<char>(0xD5);
  output_ += static_cast<char>(payload.size());
  output_.append(payload.begin(), payload.end());
  output_ += static_cast<char>(checksum(payload));
}

Replicator::Bytes Replicator::statistics() const {
  const bool building = state_ == kRunning || state_ == kPausedState;
  const auto minutes = static_cast<std::uint32_t>((now_s_ - build_since_s_) / 60);
  const Bytes time = {static_cast<std::uint8_t>(minutes / 60),
                      static_cast<std::uint8_t>(minutes % 60)};
  return Bytes(1, state_) + time + little_endian(building ? executed_count_ : last_count_, 4) +
         little_endian(0, 4);
}

Replicator::Bytes Replicator::position() const {
  Bytes bytes;
  for (std::int32_t steps : position_) bytes += little_endian(static_cast<std::uint32_t>(steps), 4);
  return bytes + little_endian(0, 2);
}

double Replicator::next_event_s() const {
  double next = std::min(stop_at_s_, noise_since_s_);
  if (expect_ != Expect::kHeader)
    next = std::min(next, packet_since_s_ + pace_.line_s(kPacketTimeout_s));
  if (!queue_.empty() && !paused_) next = std::min(next, busy_until_s_);
  return next;
}

void Replicator::advance(double now_s) {
  now_s_ = now_s;
  if (now_s >= stop_at_s_) stop(now_s);
  if (expect_ != Expect::kHeader && now_s >= packet_since_s_ + pace_.line_s(kPacketTimeout_s)) {
    expect_ = Expect::kHeader;
    answer(0x8C);
  }
  // Nobody may be listening: what cannot be sent is not piled up.
  constexpr std::size_t kEnough = 1024;
  while (noise_since_s_ <= now_s) {
    if (output_.size() < kEnough) answer(0x80);
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
  busy_until_s_ = 0;
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

void Replicator::overheat() {
  clear();
  overheated_ = true;
}

void Replicator::power_cycle() {
  clear();
  state_ = kNone;
  executed_count_ = last_count_ = 0;
  build_name_.clear();
  expect_ = Expect::kHeader;
  noise_since_s_ = kNever;
  tell_cancelled_ = overheated_ = false;
  output_.clear();
}

void Replicator::wait(double seconds, double now_s) {
  busy_until_s_ = now_s + pace_.machine_s(seconds);
}

void Replicator::execute(const Bytes& sent, double now_s) {
  executed_.push_back(hex(sent));
  ++executed_count_;
  Bytes action = sent;  // the firmware reads what it expects, however little was sent
  action.resize(std::max<std::size_t>(action.size(), kLongestPayload));
  switch (action[0]) {
    case 0x83:
    case 0x84:
      return wait(kHoming_s, now_s);
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

// Moves, and the setting of the position. Durations are those that the action itself states.
void Replicator::execute_move(const Bytes& action, double now_s) {
  const unsigned relative = action[0] == 0x9B || action[0] == 0x8E ? action[25] : 0;
  double longest = 0;
  for (std::size_t axis = 0; axis < position_.size(); ++axis) {
    const auto steps = static_cast<std::int32_t>(u32(action, 1 + 4 * axis));
    const bool is_relative = (relative >> axis & 1U) != 0;
    const double way = is_relative ? steps : static_cast<double>(steps) - position_[axis];
    longest = std::max(longest, std::abs(way));
    position_[axis] = static_cast<std::int32_t>(is_relative ? position_[axis] + way : steps);
  }
  if (action[0] == 0x8E) wait(u32(action, 21) / 1e6, now_s);
  if (action[0] == 0x8B) wait(longest * u32(action, 21) / 1e6, now_s);
  if (action[0] != 0x9B) return;
  float distance_mm = 0;
  const std::uint32_t bits = u32(action, 26);
  std::memcpy(&distance_mm, &bits, sizeof bits);
  const double speed_mm_s = u16(action, 30) / 64.0;
  const double rate = u32(action, 21);
  if (speed_mm_s > 0)
    wait(std::abs(distance_mm) / speed_mm_s, now_s);
  else if (rate > 0)
    wait(longest / rate, now_s);
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
