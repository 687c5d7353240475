// The simulated Replicator's side of the line: packets, queries, answers.
#include <algorithm>
#include <cmath>

#include "firmware_io/simulated/replicator.h"

namespace packmerger::simulated {

namespace {

constexpr std::uint16_t kVersion = 708;
constexpr std::size_t kBufferBytes = 512;
constexpr std::size_t kLongestPayload = 32;
constexpr double kAbort_s = 0.3;

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

bool is_known(std::uint8_t action) { return action >= 0x83 && action <= 0x9E && action != 0x8A; }

}  // namespace

void Replicator::receive(std::string_view bytes, double now_s) {
  advance(now_s);
  if (now_s < booted_at_s_) return;
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
  if (from_card_) return answer(0x8A);
  if (!traits_.unknown_accepted && !is_known(payload_[0])) return answer(0x85);
  if (queued_bytes_ + payload_.size() > kBufferBytes) return answer(0x82);
  queue_.push_back(payload_);
  queued_bytes_ += payload_.size();
  answer(0x81);
}

void Replicator::take_query(double now_s) {
  const bool hides_version = traits_.version_hidden && u16(payload_, 1) < 39;
  const auto free_bytes = static_cast<std::uint32_t>(kBufferBytes - queued_bytes_);
  switch (payload_[0]) {
    case 0x00:
      return answer(0x81, little_endian(hides_version ? 0 : kVersion, 2));
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
      press_pause();
      return answer(0x81);
    case 0x0A:
      return take_tool_query(now_s);
    case 0x0B:
      // The true firmware looks at its queue, and at its planner only where that is full.
      return answer(
          0x81, {queue_.empty() && now_s >= homing_until_s_ ? std::uint8_t{1} : std::uint8_t{0}});
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
      return answer(0x81, {static_cast<std::uint8_t>((waits_for_button_ ? 0x10 : 0) |
                                                     (from_card_ ? 0x08 : 0))});
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

Bytes Replicator::statistics() const {
  const bool building = state_ == kRunning || state_ == kPausedState;
  const auto minutes = static_cast<std::uint32_t>((now_s_ - build_since_s_) / 60);
  const Bytes time = {static_cast<std::uint8_t>(minutes / 60),
                      static_cast<std::uint8_t>(minutes % 60)};
  return Bytes(1, state_) + time + little_endian(building ? executed_count_ : last_count_, 4) +
         little_endian(0, 4);
}

// In the middle of a move, where its axes are on their way.
Bytes Replicator::position() const {
  const double took_s = move_.until_s - move_.since_s;
  const double share =
      now_s_ >= move_.until_s ? 1 : std::max(0.0, (now_s_ - move_.since_s) / took_s);
  Bytes bytes;
  for (std::size_t axis = 0; axis < move_.to.size(); ++axis) {
    const double way = static_cast<double>(move_.to[axis]) - move_.from[axis];
    const auto steps = static_cast<std::int32_t>(move_.from[axis] + way * share);
    bytes += little_endian(static_cast<std::uint32_t>(steps), 4);
  }
  return bytes + little_endian(0, 2);
}

}  // namespace packmerger::simulated
