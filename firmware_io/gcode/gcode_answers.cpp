// What the printer's answers are for, and how it is known that it is still there.
#include <algorithm>
#include <utility>

#include "firmware_io/gcode/gcode_stream.h"

namespace packmerger {

namespace {

constexpr int kMaxSameResend = 10;
constexpr int kTriesPerTimeout = 5;
// The ok that belongs to a Resend follows at once; some firmwares send none.
constexpr double kResendWait_s = 0.5;
// Marlin says "busy" every two seconds unless it is told otherwise (M113).
constexpr double kBusyPatience_s = 6;
constexpr double kBusiesMissed = 3;
// A command that blocks longer than usual without a word is given this many time-outs.
constexpr double kLongFactor = 5;
// What still waits for its user so long after an answer has not heard it.
constexpr double kAnswerHeard_s = 5;
// After so many lines M105 proves that no ok was one too many; sooner where some were.
constexpr std::size_t kLinesPerProof = 100;
constexpr std::size_t kLinesPerProofInDoubt = 4;
constexpr std::size_t kDoubtedLines = 200;

}  // namespace

// The one of unanswered_ that an ok is for; its size: none, the ok is one too many. Where the
// printer names the line (ADVANCED_OK) that decides, and where it answers M105 with temperatures,
// nothing else answers M105 and such an answer is for nothing else.
std::size_t GcodeStream::answered_by(const GcodeReply& ok) const {
  const auto index_of = [&](const auto& is_it) {
    const auto found = std::find_if(unanswered_.begin(), unanswered_.end(), is_it);
    return static_cast<std::size_t>(found - unanswered_.begin());
  };
  if (ok.has_temperature) return index_of([](const Given& g) { return g.asks_temperatures; });
  if (ok.number > 0 && ok.number <= last_)
    return index_of([&](const Given& g) { return std::max(g.number, g.question) == ok.number; });
  if (unanswered_.empty() || (unanswered_.front().asks_temperatures && temperatures_in_ok_))
    return unanswered_.size();
  return 0;
}

void GcodeStream::handle_ok(const GcodeReply& reply) {
  temperatures_in_ok_ = temperatures_in_ok_ || reply.has_temperature;
  const bool owed = tally_.count_ok(reply.has_temperature);
  const std::size_t answered = answered_by(reply);
  if (answered == unanswered_.size()) {
    // One too many opens nothing. A request may have been stale, for instance the answer to a
    // doubled line: the line itself was taken.
    if (unanswered_.empty() && resend_)
      resend_.reset();
    else if (!owed || !was_silent_)
      doubted_until_ = last_ + kDoubtedLines, in_doubt_ = true;
    return;
  }
  const Given given = unanswered_[answered];
  const auto behind = unanswered_.begin() + static_cast<std::ptrdiff_t>(answered);
  const auto is_line = [](const Given& g) { return g.number > 0; };
  const bool lost = std::any_of(unanswered_.begin(), behind, is_line);
  unanswered_.erase(unanswered_.begin(), behind + 1);
  if (std::none_of(unanswered_.begin(), unanswered_.end(), is_line)) settle_complaint(lost);
  if (given.asks_temperatures) {
    // Answers come in order, so whatever was still owed got lost, but not a line that was given
    // behind the question.
    taken_for_granted_ = lost && !resend_;
    in_doubt_ = in_doubt_ || lost;
    std::erase_if(unanswered_, [](const Given& each) { return each.number == 0; });
    m105_behind_ = false;
    proven_ = unanswered_.empty() ? last_ : unanswered_.front().number - 1;
  }
  if (resend_)
    resend_->due_s = channel_.now_s() + kSettle_s;
  else if (given.number > 0) {
    acknowledged_ = std::max(acknowledged_, given.number);
    tell_done(given.number + 1);
  }
}

// One that checks sums and counts nothing asks for what came garbled, by that line's own number.
// Which kind it is, the answer to the probe decides.
void GcodeStream::handle_resend(std::size_t asked) {
  tally_.count_refusal();
  if (line_count_ == LineCount::kUnknown) {
    in_doubt_ = true;
    // The line that it lacks is a late one; one that counts nothing names the probe's own number.
    if (probes_ && asked > 0 && asked <= last_ + 1 && asked + kSlack >= open_)
      line_count_ = LineCount::kKept;
  }
  if (line_count_ == LineCount::kIgnored) {
    if (last_ > open_ && asked != open_) return forget_question();
    asked = open_;
  }
  const std::size_t given = line_count_ == LineCount::kKept ? highest_ : last_;
  std::size_t next = asked;
  if (asked == 0 || asked > given + 1) next = last_;  // garbled on its way
  // A printer that was reset asks for line 1; in the first lines that would seem to be near. Line 1
  // itself may have lost its number on the way, and was answered as a line without one.
  if (asked > 0 && (asked + kSlack < open_ || (asked == 1 && acknowledged_ > 1))) {
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

// It came garbled to a printer that counts nothing, which is no loss: the ok behind the request is
// all the answer that it gets. A line before it that lacks its own is doubtful.
void GcodeStream::forget_question() {
  m105_behind_ = false;
  for (Given& given : unanswered_) {
    if (given.number > 0) in_doubt_ = true;
    if (given.number == 0 && std::exchange(given.asks_temperatures, false)) return;
  }
}

// Never by what comes unasked: reports of positions or temperatures go on for ever when the answer
// to the line got lost.
bool GcodeStream::proves_life(const GcodeReply& reply) {
  const bool waits_for_heat = reply.text.find(" W:") != std::string::npos;
  if (reply.kind == GcodeReplyKind::kTemperature)
    return heat_.comes_nearer(reply.heaters) || waits_for_heat;
  return reply.kind == GcodeReplyKind::kOk || reply.kind == GcodeReplyKind::kResend ||
         reply.kind == GcodeReplyKind::kBusy;
}

void GcodeStream::handle_busy(const GcodeReply& reply) {
  const double now = channel_.now_s();
  busy_seen_ = true;
  // Of a pause the machine may say nothing at all until somebody comes.
  const double interval_s = now - std::exchange(busy_at_s_, now);
  if (!stands_still()) busy_interval_s_ = std::max(busy_interval_s_, interval_s);
  if (cancelling_)
    hear_while_cancelling(reply);
  else if (reply.waiting && now - answered_at_s_ >= kAnswerHeard_s) {
    question_answered_ = false;
    reporter_.state(PrintState::kWaiting, prompt_, choices_);
  }
}

void GcodeStream::watch_silence() {
  const double now = channel_.now_s();
  if (stands_still() && !between_) alive_at_s_ = now;  // for as long as the machine likes
  const bool may_be_long =
      is_long(command(open_)) && !busy_seen_ && !cancelling_ && complaint_.empty();
  const double limit = std::max(options_.timeout_s * (may_be_long ? kLongFactor : 1.0),
                                kBusiesMissed * busy_interval_s_) +
                       (may_be_long ? dwell_s(command(open_)) : 0);
  // Behind an error line it is time for a Resend or an ok.
  const double since_s = complaint_.empty() ? alive_at_s_ : std::max(alive_at_s_, complained_at_s_);
  if (now - since_s >= limit) fail_in_silence();
  double patience = limit / kTriesPerTimeout;
  if (busy_seen_) patience = std::min(patience, kBusyPatience_s);
  if (now - std::max(alive_at_s_, attempt_at_s_) >= std::min(patience * patience_factor_, limit))
    recover();
}

// An empty line ends a half line that lost bytes left in the printer: Marlin then asks for the line
// again. M105 is answered by a printer that is alive, and only behind everything sent before. The
// same line is never just repeated: Marlin 2.1 answers a line that it already has with silence. A
// printer that is alive meanwhile reads nothing yet, so it is asked ever more seldom. One that
// counts no lines may answer the empty line too, in the place of the one that got lost.
void GcodeStream::recover() {
  was_silent_ = true;
  if (attempt_at_s_ > given_at_s_ && alive_at_s_ >= attempt_at_s_) patience_factor_ *= 2;
  ask_behind_empty_line();
  attempt_at_s_ = channel_.now_s();
}

void GcodeStream::ask_behind_empty_line() {
  channel_.send("");
  tally_.count_empty_line();
  ask_for_proof();
}

// The answer to M105 comes behind all others: what was owed before it and did not come got lost,
// and an ok that comes before it, though nothing else is owed, is one too many.
void GcodeStream::ask_for_proof() {
  ask("M105");
  m105_behind_ = true;
  asked_behind_ = last_;
}

bool GcodeStream::wants_proof() const {
  if (asked_behind_ == last_) return false;
  if (end_ > 0 && open_ >= end_)
    // once the position did not come, or where it comes unasked
    return position_tries_ > 1 || positions_unasked_;
  const bool doubted = last_ < doubted_until_;
  return !blocks(command(open_)) &&
         last_ >= proven_ + (doubted ? kLinesPerProofInDoubt : kLinesPerProof);
}

// Of a printer that does not tell them by itself, and to prove where it is.
void GcodeStream::ask_temperatures() {
  constexpr double kPoll_s = 5;
  if (resend_ || m105_behind_ || probes_ || asks_position_ || unanswered_.size() >= kMostLines)
    return;
  const bool polls = !abilities_.autoreport && !cancelling_ &&
                     channel_.now_s() - asked_temperatures_at_s_ >= kPoll_s;
  if (!polls && !wants_proof()) return;
  asked_temperatures_at_s_ = channel_.now_s();
  ask_for_proof();
}

}  // namespace packmerger
