#include "firmware_io/gcode/gcode_channel.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/names.h"
#include "firmware_io/conversation.h"
#include "firmware_io/gcode/ascii.h"

namespace packmerger {

namespace {

// Noise without line endings must not fill the memory.
constexpr std::size_t kMaxReply = 4096;
// After this much silence a printer has said what it had to say.
constexpr double kQuiet_s = 0.05;

// Boards that reset when the port is opened are silent for a while and then print "start" and their
// settings; the others say nothing at all.
void wait_for_boot(GcodeChannel& channel, double boot_wait_s, const PrintControl& control) {
  constexpr double kPause_s = 0.4;   // in what a booting printer prints
  constexpr double kLongest_s = 10;  // for a printer that reports without end
  const double end = channel.now_s() + boot_wait_s;
  double quiet_at = end;
  while (channel.now_s() < std::min(std::max(end, quiet_at), end + kLongest_s)) {
    check_not_ended(control);
    const double left = std::max(std::max(end, quiet_at) - channel.now_s(), 0.0);
    if (channel.receive(std::min(kSlice_s, left))) quiet_at = channel.now_s() + kPause_s;
  }
}

struct Answer {
  bool ok = false;
  bool firmware = false;
  bool prints_from_card = false;
  std::string machine;  // in its own words
  GcodeAbilities abilities;
};

void note(const GcodeReply& reply, Answer& answer) {
  switch (reply.kind) {
    case GcodeReplyKind::kOk:
      answer.ok = true;
      if (reply.has_firmware) answer.machine = reply.text;
      answer.firmware = answer.firmware || reply.has_firmware;
      break;
    case GcodeReplyKind::kFirmware:
      answer.machine = reply.text;
      answer.firmware = true;
      break;
    case GcodeReplyKind::kCapability:
      if (reply.text == "PROMPT_SUPPORT:1") answer.abilities.prompts = true;
      if (reply.text == "AUTOREPORT_TEMP:1") answer.abilities.autoreport = true;
      if (reply.text == "EMERGENCY_PARSER:1") answer.abilities.emergency_parser = true;
      break;
    case GcodeReplyKind::kCard:
      answer.prints_from_card = answer.prints_from_card || reply.waiting;
      break;
    case GcodeReplyKind::kStopped:
    case GcodeReplyKind::kRefused:
      throw_told_failure(reply);
    default:
      break;
  }
}

// Sends a line and collects what comes until done(answer), or until nothing came for wait_s. What
// a printer says unasked, maybe without end, is no sign that an answer is on its way.
template <typename Done>
Answer ask(GcodeChannel& channel, std::string_view line, double wait_s, const PrintControl& control,
           const Done& done) {
  Answer answer;
  channel.send(line);
  double heard_at = channel.now_s();
  constexpr double kLongest = 5;  // times wait_s
  const double end = heard_at + kLongest * wait_s;
  while (!done(answer) && channel.now_s() < std::min(heard_at + wait_s, end)) {
    check_not_ended(control);
    if (const auto reply = channel.receive(std::min(kSlice_s, wait_s))) {
      const bool unasked =
          reply->kind == GcodeReplyKind::kTemperature || reply->kind == GcodeReplyKind::kIdle;
      if (!unasked) heard_at = channel.now_s();
      note(*reply, answer);
    }
  }
  return answer;
}

void drain(GcodeChannel& channel) {
  const double end = channel.now_s() + 2;  // a printer may report temperatures without end
  while (channel.now_s() < end && channel.receive(kQuiet_s)) {
  }
}

// The value behind "KEY:" in M115's answer, which goes up to the next word in capitals with a
// colon.
std::string field(const std::string& answer, const std::string& key) {
  const std::size_t at = answer.find(key + ":");
  if (at == std::string::npos) return "unknown";
  const std::size_t begin = at + key.size() + 1;
  std::size_t end = begin;
  while ((end = answer.find(' ', end)) != std::string::npos) {
    const std::size_t word_end = answer.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_", ++end);
    if (word_end != std::string::npos && word_end > end && answer[word_end] == ':') break;
  }
  const std::string value = answer.substr(begin, end == std::string::npos ? end : end - begin);
  return std::string(ascii::trim(value));
}

// "Prusa-mini (Marlin 2.1.2)"
std::string short_name(const std::string& answer) {
  return field(answer, "MACHINE_TYPE") + " (" + field(answer, "FIRMWARE_NAME") + ")";
}

constexpr int kTries = 5;

Answer identify(GcodeChannel& channel, const StreamOptions& options, const PrintControl& control) {
  int answered = 0;
  for (int i = 0; i < kTries; ++i) {
    channel.send("");  // ends a half line that noise or an earlier program left in the printer
    Answer answer = ask(channel, "M115", options.timeout_s / kTries, control,
                        [](const Answer& a) { return a.ok && a.firmware; });
    if (answer.firmware) return answer;
    // A very old firmware knows no M115, yet says ok.
    if (answer.ok && ++answered == 2) return answer;
  }
  throw Error(Fault::kUnavailable, "Nothing that speaks G-code answers at " + channel.name(),
              "Check that the printer is on, and that the profile's dialect and link.baud fit it.");
}

void reset_line_count(GcodeChannel& channel, const StreamOptions& options,
                      const PrintControl& control) {
  const std::string line = numbered_line(0, "M110 N0");
  for (int i = 0; i < kTries; ++i) {
    if (ask(channel, line, options.timeout_s / kTries, control, [](const Answer& a) {
          return a.ok;
        }).ok)
      return drain(channel);
  }
  throw Error(Fault::kUnavailable,
              "The printer at " + channel.name() + " does not take line numbers",
              "Switch the printer off and on, then print the job again.");
}

}  // namespace

void throw_told_failure(const GcodeReply& reply) {
  if (reply.heater_failed)
    throw Error(Fault::kIo, "A heater of the printer failed: " + reply.text,
                "Switch the printer off, check its heater and temperature sensor, then print the "
                "job again.");
  if (reply.kind == GcodeReplyKind::kRefused)
    throw Error(Fault::kIo, "The printer refuses to go on: " + reply.text,
                "Put right what it complains of, then print the job again.");
  throw Error(Fault::kIo, "The printer has stopped: " + reply.text,
              "Find out why, switch the printer off and on, then print the job again.");
}

void GcodeChannel::send(std::string_view line) {
  std::string bytes(line);
  bytes += '\n';
  write_all(port_, bytes);
}

std::optional<GcodeReply> GcodeChannel::take_line() {
  while (true) {
    const std::size_t end = pending_.find('\n', scanned_);
    if (end == std::string::npos) {
      scanned_ = pending_.size();
      if (pending_.size() > kMaxReply) pending_.clear(), scanned_ = 0;
      return std::nullopt;
    }
    const std::string line = pending_.substr(0, end);
    pending_.erase(0, end + 1);
    scanned_ = 0;
    // What a printer says is shown to people: none of it is to steer their terminal.
    if (line.find_first_not_of(" \r\t") != std::string::npos)
      return read_gcode_reply(printable_lines(line));
  }
}

std::optional<GcodeReply> GcodeChannel::receive(double timeout_s) {
  const double end = port_.now_s() + timeout_s;
  while (true) {
    if (auto reply = take_line()) return reply;
    std::array<char, 1024> bytes;
    const double left = std::max(end - port_.now_s(), 0.0);
    const std::size_t count = port_.read(bytes.data(), bytes.size(), left);
    pending_.append(bytes.data(), count);
    if (count == 0 && port_.now_s() >= end) return std::nullopt;
  }
}

GcodeAbilities connect_gcode(GcodeChannel& channel, const StreamOptions& options,
                             const PrintControl& control) {
  wait_for_boot(channel, options.boot_wait_s, control);
  const Answer who = identify(channel, options, control);
  drain(channel);
  check_machine(channel.name(), short_name(who.machine), options.machine);
  const Answer card = ask(channel, "M27", options.timeout_s / kTries, control,
                          [](const Answer& a) { return a.ok; });
  if (card.prints_from_card)
    throw Error(Fault::kBusy, "The printer at " + channel.name() + " is printing from its own card",
                "Wait until that print is done, or stop it at the printer.");
  reset_line_count(channel, options, control);
  // Behind the drain, which waits until nothing more comes.
  if (who.abilities.autoreport)
    ask(channel, "M155 S2", options.timeout_s / kTries, control,
        [](const Answer& a) { return a.ok; });
  return who.abilities;
}

}  // namespace packmerger
