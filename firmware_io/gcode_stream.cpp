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
// With a window: this many lines at once, and one at a time for so many after any trouble.
constexpr std::size_t kMostLines = 3;
constexpr std::size_t kCareful = 10;
// The ok that belongs to a Resend follows at once; some firmwares send none.
constexpr double kResendWait_s = 0.5;
// Further answers on their way settle whether a request for a line is still true.
constexpr double kSettle_s = 0.05;
// Marlin says "busy" every two seconds.
constexpr double kBusyPatience_s = 6;
// A command that blocks longer than usual without a word is given this many time-outs.
constexpr double kLongFactor = 5;

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
  reporter_.state(PrintState::kPrinting);
  std::size_t number = 1;
  while (!is_behind_program(number) || !position_seen_) {
    if (number > commands_.size() + 1 + kMaxPositionTries)
      fail("The printer does not say where it is (M114), so the end of the print is unproven",
           "Look at the print, and switch the printer off and on before the next job.");
    const bool may_pause = number == highest_ + 1 && number <= commands_.size();
    number = paused_ && may_pause && !cancelling_ ? pause(number) : exchange(number);
    tell_done(number);
  }
}

std::string GcodeStream::command(std::size_t number) const {
  if (number <= commands_.size()) return commands_[number - 1];
  return number == commands_.size() + 1 ? "M400" : "M114";
}

std::size_t GcodeStream::program_lines_before(std::size_t number) const {
  std::size_t lines = std::min(number - 1, commands_.size());
  for (const Insertion& insertion : inserted_)
    if (insertion.first < number) lines -= std::min(insertion.count, number - insertion.first);
  return lines;
}

void GcodeStream::tell_done(std::size_t next) {
  if (!cancelling_) reporter_.done(program_lines_before(next));
}

// Gives a line, and others behind it, until the printer has answered all of them; returns the
// number of the line to give next.
std::size_t GcodeStream::exchange(std::size_t number) {
  resend_.reset();
  m105_behind_ = taken_for_granted_ = false;
  attempts_ = 0;
  give(number);
  while (!unanswered_.empty() || resend_) {
    if (resend_ && channel_.now_s() >= resend_->due_s) {
      unanswered_.clear();
      careful_until_ = last_ + kCareful;
      return resend_->number;
    }
    obey_requests();
    watch_unproven_life();
    reporter_.tick();
    if (may_give_another()) give(last_ + 1);
    ask_temperatures();
    if (const auto reply = channel_.receive(resend_ ? kSettle_s : kSlice_s))
      handle(*reply);
    else
      watch_silence();
  }
  if (taken_for_granted_) careful_until_ = last_ + kCareful;
  unproven_ = taken_for_granted_ ? unproven_ + 1 : 0;
  if (unproven_ > kMaxUnproven)
    fail("The printer no longer acknowledges what it is sent",
         "Check the cable, switch the printer off and on, then print the job again.");
  if (!taken_for_granted_) far_back_ = 0;
  return last_ + 1;
}

// Within the window, and never behind a command that blocks or any trouble. Marlin queues four
// lines and reads no further: so few are given that a cancel is read at once.
bool GcodeStream::may_give_another() const {
  const std::size_t next = last_ + 1;
  const bool calm = !resend_ && !m105_behind_ && !cancelling_ && !paused_ && !between_;
  if (options_.window_bytes == 0 || !calm || next < careful_until_ || next > commands_.size() ||
      unanswered_.size() >= kMostLines || blocks(command(last_)) || blocks(command(next)))
    return false;
  std::size_t bytes = numbered_gcode(next, command(next)).size();
  for (const Given& given : unanswered_) bytes += given.bytes;
  return bytes <= options_.window_bytes;
}

void GcodeStream::give(std::size_t number) {
  std::string line = numbered_gcode(number, command(number));
  unanswered_.push_back({number, line.size()});
  line.pop_back();
  channel_.send(line);
  last_ = number;
  highest_ = std::max(highest_, number);
  alive_at_s_ = attempt_at_s_ = works_at_s_ = channel_.now_s();
  doubt_after_s_ = options_.timeout_s;
  prompt_.clear();
  choices_.clear();
  show_state();
}

// Of a printer that does not tell them by itself. The answer also says that everything before was
// answered or got lost.
void GcodeStream::ask_temperatures() {
  constexpr double kPoll_s = 5;
  if (abilities_.autoreport || cancelling_ || resend_ || m105_behind_ ||
      unanswered_.size() >= kMostLines || channel_.now_s() - asked_temperatures_at_s_ < kPoll_s)
    return;
  asked_temperatures_at_s_ = channel_.now_s();
  send_raw("M105");
  m105_behind_ = true;
}

void GcodeStream::handle(const GcodeReply& reply) {
  const bool heating = is_heating(command(last_));
  reporter_.heaters(reply.heaters);
  const bool waits_for_heat = reply.text.find(" W:") != std::string::npos;
  if (reply.kind == GcodeReplyKind::kBusy || waits_for_heat) works_at_s_ = channel_.now_s();
  // A temperature report may come on its own for ever: it proves nothing unless it is that of a
  // wait for heat, which has a W where the others are asked for too.
  const bool waits = heating && (!abilities_.autoreport || waits_for_heat);
  if (reply.kind != GcodeReplyKind::kTemperature || waits) alive_at_s_ = channel_.now_s();
  switch (reply.kind) {
    case GcodeReplyKind::kOk:
      complaint_.clear();
      if (reply.has_position && is_behind_program(last_)) position_seen_ = true;
      handle_ok(reply);
      break;
    case GcodeReplyKind::kResend:
      complaint_.clear();
      handle_resend(reply.number);
      break;
    case GcodeReplyKind::kBusy:
      busy_seen_ = true;
      if (reply.waiting && !cancelling_) reporter_.state(PrintState::kWaiting, prompt_, choices_);
      break;
    case GcodeReplyKind::kIdle:
      if (channel_.now_s() - attempt_at_s_ > 1) recover();
      break;
    case GcodeReplyKind::kStart:
      may_send_ = false;
      fail("The printer was reset in the middle of the print",
           "Clear the bed and print the job again; check the printer's power supply.");
    case GcodeReplyKind::kStopped:
    case GcodeReplyKind::kRefused:
      throw_told_failure(reply);
    case GcodeReplyKind::kError:
      handle_error(reply);
      break;
    case GcodeReplyKind::kUnknown:
      handle_unknown(reply.text);
      break;
    case GcodeReplyKind::kTemperature:
      if (heating && !cancelling_ && !between_) reporter_.state(PrintState::kHeating, reply.text);
      break;
    case GcodeReplyKind::kPosition:
      if (is_behind_program(last_)) position_seen_ = true;
      break;
    default:
      if (!cancelling_) handle_action(reply);
      break;
  }
}

void GcodeStream::handle_ok(const GcodeReply& reply) {
  if (!unanswered_.empty()) {
    const std::size_t number = unanswered_.front().number;
    unanswered_.pop_front();
    if (resend_)
      resend_->due_s = channel_.now_s() + kSettle_s;
    else if (number > 0) {
      acknowledged_ = std::max(acknowledged_, number);
      tell_done(number + 1);
    }
  } else if (resend_) {
    // The request was stale, for instance the answer to a doubled line: the line itself was taken.
    resend_.reset();
  }
  if (m105_behind_ && reply.has_temperature) {
    // Answers come in order, so whatever was still owed got lost.
    taken_for_granted_ = !unanswered_.empty() && !resend_;
    unanswered_.clear();
    m105_behind_ = false;
  }
}

void GcodeStream::handle_resend(std::size_t asked) {
  std::size_t next = asked;
  if (asked == 0 || asked > last_ + 1) next = last_;  // garbled on its way
  // A printer that was reset asks for line 1; in the first lines that would seem to be near.
  if (asked > 0 && (asked + kSlack < last_ || (asked == 1 && acknowledged_ > 0))) {
    if (asked == far_back_)
      fail("The printer has lost its place (it asks for line " + std::to_string(asked) +
               " after line " + std::to_string(last_) + "): it was probably reset",
           "Clear the bed and print the job again; check the printer's power supply.");
    far_back_ = asked;
    next = last_;
  }
  // Every line that was on its way behind the one it lacks asks for that one again.
  if (!resend_ || next != asked_) asked_times_ = next == asked_ ? asked_times_ + 1 : 1;
  asked_ = next;
  if (asked_times_ >= kMaxSameResend)
    fail(
        "The printer asked ten times for line " + std::to_string(next) + " (" + command(next) + ")",
        "Use a shorter or better shielded cable, and check that link.baud fits the printer.");
  resend_ = Resend{next, channel_.now_s() + kResendWait_s};
}

void GcodeStream::send_raw(std::string_view line) {
  channel_.send(line);
  unanswered_.push_back({0, line.size() + 1});
}

void GcodeStream::watch_silence() {
  const double now = channel_.now_s();
  const bool stands_still = paused_ && !parks_ && !between_;
  if (stands_still) alive_at_s_ = now;  // for as long as the machine likes
  const std::string text = command(last_);
  const double limit =
      options_.timeout_s * (is_long(text) && !busy_seen_ && !cancelling_ ? kLongFactor : 1.0);
  if (now - alive_at_s_ >= limit || attempts_ >= kMaxAttempts) fail_in_silence();
  double patience = limit / kTriesPerTimeout;
  if (busy_seen_) patience = std::min(patience, kBusyPatience_s);
  if (now - std::max(alive_at_s_, attempt_at_s_) >= patience) recover();
}

// Reports that come unasked go on when the answer to the line got lost, so they are trusted for a
// while only, and then for twice as long: heating may truly take that time.
void GcodeStream::watch_unproven_life() {
  if (!is_heating(command(last_)) || channel_.now_s() - works_at_s_ < doubt_after_s_) return;
  works_at_s_ = channel_.now_s();
  doubt_after_s_ *= 2;
  recover();
}

// An empty line ends a half line that lost bytes left in the printer: Marlin then asks for the line
// again. M105 is answered by a printer that is alive, and only behind everything sent before. The
// same line is never just repeated: Marlin 2.1 answers a line that it already has with silence.
void GcodeStream::recover() {
  channel_.send("");
  send_raw("M105");
  m105_behind_ = true;
  ++attempts_;
  attempt_at_s_ = channel_.now_s();
}

void GcodeStream::show_state() {
  if (cancelling_ || between_) return;
  const PrintState state =
      is_heating(command(last_)) ? PrintState::kHeating : PrintState::kPrinting;
  if (state == PrintState::kPrinting)
    reporter_.state(state, printing_text());
  else if (reporter_.current() != state)
    reporter_.state(state);
}

void GcodeStream::fail(const std::string& what, const std::string& hint) const {
  throw Error(Fault::kIo, what, hint);
}

}  // namespace packmerger
