#include "firmware_io/gcode_stream.h"

#include <algorithm>

#include "base/error.h"

namespace packmerger {

namespace {

constexpr int kMaxSameResend = 10;
constexpr int kMaxAttempts = 10;
constexpr int kMaxUnproven = 5;
constexpr int kTriesPerTimeout = 5;
constexpr std::size_t kMaxPositionTries = 10;
// A request for a line further back than this is noise, or the printer was reset.
constexpr std::size_t kSlack = 10;
// The ok that belongs to a Resend follows at once; some firmwares send none.
constexpr double kResendWait_s = 0.5;
// Further answers on their way settle whether a request for a line is still true.
constexpr double kSettle_s = 0.05;
// Marlin says "busy" every two seconds.
constexpr double kBusyPatience_s = 6;
// A command that blocks longer than usual without a word is given this many time-outs.
constexpr double kLongFactor = 5;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (const GcodeCommand& command : gcode_commands(text)) lines.emplace_back(command.text);
  return lines;
}

}  // namespace

GcodeStream::GcodeStream(GcodeChannel& channel, std::vector<std::string> commands,
                         const StreamOptions& options, const GcodeAbilities& abilities,
                         Reporter& reporter, PrintControl& control)
    : channel_(channel),
      commands_(std::move(commands)),
      options_(options),
      abilities_(abilities),
      reporter_(reporter),
      control_(control) {}

void GcodeStream::run() {
  std::size_t number = 1;
  while (number <= commands_.size() + 1 || !position_seen_) {
    if (number > commands_.size() + 1 + kMaxPositionTries)
      fail("The printer does not say where it is (M114), so the end of the print is unproven",
           "Look at the print, and switch the printer off and on before the next job.");
    number = exchange(number);
    if (!cancelling_) reporter_.done(std::min(number - 1, commands_.size()));
  }
}

std::string GcodeStream::command(std::size_t number) const {
  if (number <= commands_.size()) return commands_[number - 1];
  return number == commands_.size() + 1 ? "M400" : "M114";
}

// Sends one line until the printer has answered it; returns the number of the line to send next.
std::size_t GcodeStream::exchange(std::size_t number) {
  std::string line = numbered_gcode(number, command(number));
  line.pop_back();
  channel_.send(line);
  sent_at_s_ = alive_at_s_ = attempt_at_s_ = channel_.now_s();
  owed_oks_ = 1;
  resend_.reset();
  recovering_ = taken_for_granted_ = false;
  attempts_ = 0;
  show_state(number);
  while (true) {
    if (owed_oks_ == 0 && !resend_) break;
    if (resend_ && channel_.now_s() >= resend_->due_s) {
      owed_oks_ = 0;
      return resend_->number;
    }
    obey_requests(number);
    if (const auto reply = channel_.receive(resend_ ? kSettle_s : kSlice_s))
      handle(*reply, number);
    else
      watch_silence(number);
  }
  unproven_ = taken_for_granted_ ? unproven_ + 1 : 0;
  if (unproven_ > kMaxUnproven)
    fail("The printer no longer acknowledges what it is sent",
         "Check the cable, switch the printer off and on, then print the job again.");
  if (!taken_for_granted_) far_back_ = 0;
  prompt_.clear();
  return number + 1;
}

void GcodeStream::handle(const GcodeReply& reply, std::size_t number) {
  // A temperature report may come on its own for ever: it proves nothing unless we wait for heat.
  if (reply.kind != GcodeReplyKind::kTemperature || is_heating(command(number)))
    alive_at_s_ = channel_.now_s();
  switch (reply.kind) {
    case GcodeReplyKind::kOk:
      if (reply.has_position && number > commands_.size() + 1) position_seen_ = true;
      handle_ok(reply);
      break;
    case GcodeReplyKind::kResend:
      handle_resend(reply.number, number);
      break;
    case GcodeReplyKind::kBusy:
      busy_seen_ = true;
      if (reply.waiting && !cancelling_) reporter_.state(PrintState::kWaiting, prompt_);
      break;
    case GcodeReplyKind::kIdle:
      if (channel_.now_s() - attempt_at_s_ > 1) recover();
      break;
    case GcodeReplyKind::kStart:
      may_send_ = false;
      fail("The printer was reset in the middle of the print",
           "Clear the bed and print the job again; check the printer's power supply.");
    case GcodeReplyKind::kHalted:
      may_send_ = false;
      fail("The printer has halted: " + reply.text,
           "Find out why, switch the printer off and on, then print the job again.");
    case GcodeReplyKind::kThermal:
      handle_failed_heater(reply);
      break;
    case GcodeReplyKind::kTemperature:
      if (is_heating(command(number)) && !cancelling_)
        reporter_.state(PrintState::kHeating, reply.text);
      break;
    case GcodeReplyKind::kPosition:
      if (number > commands_.size() + 1) position_seen_ = true;
      break;
    case GcodeReplyKind::kPrompt:
      prompt_ = reply.text;
      if (!cancelling_) reporter_.state(PrintState::kWaiting, prompt_);
      break;
    default:
      break;
  }
}

void GcodeStream::handle_ok(const GcodeReply& reply) {
  if (owed_oks_ > 0) {
    --owed_oks_;
    if (resend_) resend_->due_s = channel_.now_s() + kSettle_s;
  } else if (resend_) {
    // The request was stale, for instance the answer to a doubled line: the line itself was taken.
    resend_.reset();
  }
  if (recovering_ && reply.has_temperature) {
    // Answers come in order, so whatever was still owed got lost.
    taken_for_granted_ = owed_oks_ > 0 && !resend_;
    owed_oks_ = 0;
  }
}

void GcodeStream::handle_resend(std::size_t asked, std::size_t number) {
  std::size_t next = asked;
  if (asked == 0 || asked > number + 1) next = number;  // garbled on its way
  if (asked > 0 && asked + kSlack < number) {
    if (asked == far_back_) {
      may_send_ = false;
      fail("The printer has lost its place (it asks for line " + std::to_string(asked) +
               " after line " + std::to_string(number) +
               "): it was reset in the middle of the print",
           "Clear the bed and print the job again; check the printer's power supply.");
    }
    far_back_ = asked;
    next = number;
  }
  asked_times_ = next == asked_ ? asked_times_ + 1 : 1;
  asked_ = next;
  if (asked_times_ >= kMaxSameResend)
    fail(
        "The printer asked ten times for line " + std::to_string(next) + " (" + command(next) + ")",
        "Use a shorter or better shielded cable, and check that link.baud fits the printer.");
  resend_ = Resend{next, channel_.now_s() + kResendWait_s};
}

// A failing heater is followed by the printer's halt, after which nothing may be sent.
void GcodeStream::handle_failed_heater(const GcodeReply& reply) {
  may_send_ = reply.text.find("system stopped") == std::string::npos;
  const double end = channel_.now_s() + 1;
  while (may_send_ && channel_.now_s() < end) {
    const auto next = channel_.receive(end - channel_.now_s());
    if (next && (next->kind == GcodeReplyKind::kHalted || next->kind == GcodeReplyKind::kStart))
      may_send_ = false;
  }
  fail(
      "A heater of the printer failed: " + reply.text,
      "Switch the printer off, check its heater and temperature sensor, then print the job again.");
}

void GcodeStream::obey_requests(std::size_t number) {
  if (control_.cancelled() && !cancelling_) begin_cancel(number);
  const int answer = control_.take_answer();
  if (answer < 0 || cancelling_) return;
  send_raw(abilities_.prompts ? "M876 S" + std::to_string(answer) : std::string("M108"));
}

// M108 ends a wait for heat or for the user, M410 drops the planned moves. Both are obeyed at once
// only when they are not numbered. The program is then replaced by the safe text; what the printer
// may still ask for again becomes M105, which does nothing.
void GcodeStream::begin_cancel(std::size_t number) {
  cancelling_ = true;
  reporter_.state(PrintState::kCancelling);
  send_raw("M108");
  send_raw("M410");
  const std::size_t first = std::min(number > kSlack ? number - kSlack : 1, commands_.size() + 1);
  commands_.resize(number);
  for (std::size_t i = first; i <= number; ++i) commands_[i - 1] = "M105";
  for (std::string& line : lines_of(options_.safe_gcode)) commands_.push_back(std::move(line));
  position_seen_ = false;
}

void GcodeStream::send_raw(std::string_view line) {
  channel_.send(line);
  ++owed_oks_;
}

void GcodeStream::watch_silence(std::size_t number) {
  const std::string text = command(number);
  const double limit =
      options_.timeout_s * (is_long(text) && !busy_seen_ && !cancelling_ ? kLongFactor : 1.0);
  const double now = channel_.now_s();
  if (now - alive_at_s_ >= limit || attempts_ >= kMaxAttempts)
    fail("The printer has not answered line " + std::to_string(number) + " (" + text + ")",
         "Check the cable, switch the printer off and on, then print the job again.");
  double patience = limit / kTriesPerTimeout;
  if (busy_seen_) patience = std::min(patience, kBusyPatience_s);
  if (now - std::max(alive_at_s_, attempt_at_s_) >= patience) recover();
}

// An empty line ends a half line that lost bytes left in the printer: Marlin then asks for the line
// again. M105 is answered by a printer that is alive, and only behind everything sent before. The
// same line is never just repeated: Marlin 2.1 answers a line that it already has with silence.
void GcodeStream::recover() {
  channel_.send("");
  send_raw("M105");
  recovering_ = true;
  ++attempts_;
  attempt_at_s_ = channel_.now_s();
}

void GcodeStream::show_state(std::size_t number) {
  if (cancelling_) return;
  const bool heating = is_heating(command(number));
  const PrintState state = heating ? PrintState::kHeating : PrintState::kPrinting;
  if (reporter_.current() != state) reporter_.state(state);
}

void GcodeStream::fail(const std::string& what, const std::string& hint) const {
  throw Error(Fault::kIo, what, hint);
}

}  // namespace packmerger
