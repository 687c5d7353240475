#include "firmware_io/s3g/s3g_channel.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/error.h"
#include "firmware_io/conversation.h"

namespace packmerger::s3g {

namespace {

constexpr int kTries = 5;
constexpr double kQuiet_s = 0.02;
// The stream of errors that a stray byte sets off ends with the next packet; where it goes on for
// this long, our packet was not seen as one.
constexpr double kNoise_s = 0.3;

std::string hex(std::uint8_t value) {
  char text[5];
  std::snprintf(text, sizeof text, "0x%02X", value);
  return text;
}

bool worth_repeating(std::uint8_t code) {
  return code == kChecksumMismatch || code == kPacketTimeout || code == kGenericError ||
         code == kTooLong;
}

}  // namespace

Channel::Channel(Port& port, double timeout_s, const PrintControl& control)
    : port_(port), control_(control), reply_wait_s_(std::clamp(timeout_s / kTries, 0.05, 1.0)) {}

bool Channel::listen(double timeout_s) {
  std::array<char, 512> bytes;
  const std::size_t count = port_.read(bytes.data(), bytes.size(), timeout_s);
  reader_.push({bytes.data(), count});
  return count > 0;
}

void Channel::notice_unexpected() {
  while (const auto reply = reader_.next())
    if (reply->intact) note_surplus(*reply);
}

// Refusals too many are harmless.
void Channel::note_surplus(const Reply& reply) {
  if (reply.payload.size() == 1 && reply.code() == kOk) ++surplus_;
}

void Channel::hear_strays() {
  do {
    notice_unexpected();
  } while (listen(0));
}

Channel::Outcome Channel::exchange(std::string_view payload, const Expected& expected,
                                   std::string& reply_payload) {
  hear_strays();
  write_all(port_, packet(payload));
  const double sent_at = now_s();
  while (true) {
    while (auto reply = reader_.next()) {
      if (!reply->intact) return Outcome::kGarbled;
      if (reply->code() == kGenericError) {
        if (now_s() - sent_at > kNoise_s) return Outcome::kNoise;
      } else if (expected(*reply)) {
        reply_payload = std::move(reply->payload);
        return Outcome::kReply;
      } else {
        note_surplus(*reply);
      }
    }
    const double left = sent_at + reply_wait_s_ - now_s();
    if (left <= 0) return Outcome::kSilence;
    listen(left);
  }
}

void Channel::throw_if_over(std::uint8_t code) {
  const std::string next_step = "Clear the bed and print the job again.";
  switch (code) {
    case kCancelled:
      may_abort_ = false;
      throw Error(Fault::kIo, "The build was cancelled at the printer", next_step);
    case kBuildingFromCard:
      may_abort_ = false;
      throw Error(Fault::kIo, "The printer has begun to build from its own card or menu",
                  "Wait until it is done, then print the job again.");
    case kOverheated:
      may_abort_ = false;
      throw Error(Fault::kIo, "The printer shut its heaters down because one was too hot or failed",
                  "Switch the printer off, check heaters and sensors, then print the job again.");
    default:
      throw Error(Fault::kIo, "The printer answered " + hex(code) + " to what it was sent",
                  "Check that the profile fits the machine and that its firmware is up to date.");
  }
}

std::string Channel::query(std::string_view payload, std::size_t reply_size) {
  const Expected expected = [&](const Reply& reply) {
    if (reply.code() == kOk) return reply.payload.size() == 1 + reply_size;
    return reply.payload.size() == 1 && reply.code() != kBufferFull;
  };
  for (int i = 0; i < kTries && !(i > 0 && control_.left()); ++i) {
    std::string reply;
    if (exchange(payload, expected, reply) != Outcome::kReply) {
      missed_ = true;
      resynchronize();
      continue;
    }
    const auto code = static_cast<std::uint8_t>(reply[0]);
    if (code == kOk) return reply.substr(1);
    const bool tolerated = code == kCancelled && tolerate_cancelled_;
    if (!worth_repeating(code) && !tolerated) throw_if_over(code);
  }
  throw Error(Fault::kIo, "The printer at " + name() + " no longer answers",
              "Check the cable, switch the printer off and on, then print the job again.");
}

void Channel::try_query(Query code) {
  std::string reply;
  const Expected expected = [](const Reply& candidate) { return candidate.payload.size() == 1; };
  if (exchange(std::string(1, code), expected, reply) != Outcome::kReply) resynchronize();
}

void Channel::tell(Query code) { write_all(port_, packet(std::string(1, code))); }

// Old firmware does not know the advanced version; then only the number is told.
std::string Channel::firmware_name(std::uint32_t version) {
  const std::string number = std::to_string(version / 100) + "." + std::to_string(version % 100);
  std::string reply;
  const Expected expected = [](const Reply& candidate) {
    return candidate.payload.size() == 9 || candidate.code() == kUnknownQuery;
  };
  for (int i = 0; i < kTries; ++i) {
    if (exchange(std::string(1, kAdvancedVersion), expected, reply) == Outcome::kReply) break;
    resynchronize();
    reply.clear();
  }
  if (reply.size() != 9) return "firmware " + number;
  const auto variant = static_cast<std::uint8_t>(reply[5]);
  if (variant == 0x80) return "Sailfish " + number;
  return (variant == 0x01 ? "MakerBot " : "variant " + hex(variant) + " ") + number;
}

std::uint32_t Channel::free_buffer() { return read_integer(query(std::string(1, kFreeBuffer), 4)); }

bool Channel::is_finished() { return query(std::string(1, kIsFinished), 1)[0] != 0; }

// Five axes' steps, and the end stops.
Steps Channel::position() {
  const std::string reply = query(std::string(1, kPosition), 4 * kAxes + 2);
  Steps steps{};
  for (std::size_t i = 0; i < kAxes; ++i)
    steps[i] = static_cast<std::int32_t>(read_integer(std::string_view(reply).substr(4 * i, 4)));
  return steps;
}

std::uint8_t Channel::board_status() {
  return static_cast<std::uint8_t>(query(std::string(1, kBoardStatus), 1)[0]);
}

// State, hours, minutes, actions, and a field that is reserved.
Statistics Channel::statistics() {
  const std::string reply = query(std::string(1, kBuildStatistics), 11);
  return {static_cast<BuildState>(reply[0]), read_integer(std::string_view(reply).substr(3, 4))};
}

int Channel::temperature(std::uint8_t tool, std::uint8_t query_code) {
  const std::string payload = {static_cast<char>(kToolQuery), static_cast<char>(tool),
                               static_cast<char>(query_code)};
  return static_cast<int>(read_integer(query(payload, 2)));
}

Verdict Channel::try_action(std::string_view payload) {
  std::string reply;
  const Expected expected = [](const Reply& candidate) { return candidate.payload.size() == 1; };
  switch (exchange(payload, expected, reply)) {
    case Outcome::kNoise:
      resynchronize();
      return Verdict::kRejected;
    case Outcome::kSilence:
    case Outcome::kGarbled:
      resynchronize();
      return Verdict::kUnclear;
    case Outcome::kReply:
      break;
  }
  const auto code = static_cast<std::uint8_t>(reply[0]);
  if (code == kOk) return Verdict::kAccepted;
  if (code == kBufferFull) return Verdict::kFull;
  if (!worth_repeating(code)) throw_if_over(code);
  return Verdict::kRejected;
}

void Channel::pause(double seconds) {
  const double end = now_s() + seconds;
  while (now_s() < end)
    if (listen(end - now_s())) notice_unexpected();
}

void Channel::resynchronize() {
  const double end = now_s() + kNoise_s;
  while (now_s() < end && listen(kQuiet_s)) {
  }
  reader_.clear();
}

}  // namespace packmerger::s3g
