#include "firmware_io/gcode/gcode_stream.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace packmerger {

namespace {

constexpr int kMaxUnproven = 5;
constexpr const char* kNoPositions = "M154 S0";
constexpr int kMaxPositionTries = 10;
// One line at a time for so many after any trouble.
constexpr std::size_t kCareful = 10;

}  // namespace

GcodeStream::GcodeStream(GcodeChannel& channel, GcodeScript commands, const StreamOptions& options,
                         const GcodeAbilities& abilities, Reporter& reporter, PrintControl& control)
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
    if (number > commands_.size()) append_end();
    number = paused_ && may_pause_before(number) && !cancelling_ ? pause(number) : exchange(number);
    tell_done(number);
  }
}

// Where the printer tells its position unasked, M114 would prove nothing.
void GcodeStream::append_end() {
  if (end_ == 0) {
    if (positions_unasked_) commands_.append(kNoPositions);
    commands_.append("M400");
    end_ = commands_.size();
  }
  if (++position_tries_ > kMaxPositionTries)
    fail("The printer does not say where it is (M114), so the end of the print is unproven",
         "Look at the print, and switch the printer off and on before the next job.");
  commands_.append("M114");
}

std::string GcodeStream::command(std::size_t number) const {
  return std::string(commands_[number - 1]);
}

// What the link asks between two lines of the program.
bool GcodeStream::is_question(std::size_t number) const {
  if (is_behind_program(number) || !commands_.is_own(number - 1)) return false;
  return commands_[number - 1] == "M105" || commands_[number - 1] == "M114";
}

// To a printer that counts nothing no question is given again.
std::size_t GcodeStream::next_number() const {
  return (line_count_ == LineCount::kIgnored ? highest_ : last_) + 1;
}

void GcodeStream::tell_done(std::size_t next) {
  if (!cancelling_) reporter_.done(commands_.program_lines(next - 1));
}

// Gives a line, and others behind it, until the printer has answered all of them; returns the
// number of the line to give next.
std::size_t GcodeStream::exchange(std::size_t number) {
  bool is_new = number > highest_;
  resend_.reset();
  m105_behind_ = taken_for_granted_ = false;
  if (last_ > 0) hear_what_came();
  if (is_in_doubt()) {
    if (const auto again = settle_doubt()) return *again;
    is_new = is_new || line_count_ == LineCount::kIgnored;  // it has the line before
  }
  if (is_new) number = highest_ + 1;  // questions took the numbers up to there
  if (paused_ && !cancelling_ && may_pause_before(number)) return number;
  const bool gives = !resend_;
  if (gives && number > commands_.size()) return number;  // cancelled meanwhile
  if (gives) give(number);
  if (const auto again = hear_answers()) return *again;
  if (is_in_doubt())
    if (const auto again = settle_doubt()) return *again;
  // Several lines on their way can be put right only where the printer counts them.
  if (options_.window_bytes > 0 && !std::exchange(asked_whether_it_counts_, true))
    if (const auto again = learn_line_count()) return *again;
  if (taken_for_granted_) careful_until_ = last_ + kCareful;
  unproven_ = taken_for_granted_ ? unproven_ + 1 : 0;
  if (unproven_ > kMaxUnproven)
    fail("The printer no longer acknowledges what it is sent",
         "Check the cable, switch the printer off and on, then print the job again.");
  if (!taken_for_granted_) far_back_ = 0;
  if (gives) return next_number();
  return is_new ? highest_ + 1 : number;
}

// Until nothing is owed any more; returns a line that the printer asks for.
std::optional<std::size_t> GcodeStream::hear_answers() {
  while (!unanswered_.empty() || resend_) {
    if (resend_ && channel_.now_s() >= resend_->due_s) {
      unanswered_.clear();
      careful_until_ = last_ + kCareful;
      return resend_->number;
    }
    obey_requests();
    press_on_with_cancel();
    reporter_.tick();
    if (may_give_another()) give(last_ + 1);
    ask_temperatures();
    if (const auto reply = channel_.receive(resend_ ? kSettle_s : kSlice_s)) handle(*reply);
    watch_silence();
  }
  return std::nullopt;
}

// An ok that came though nothing is owed must not answer the next line.
void GcodeStream::hear_what_came(double quiet_s) {
  constexpr int kMost = 100;  // of a printer that never falls silent
  for (int i = 0; i < kMost; ++i) {
    const auto reply = channel_.receive(quiet_s);
    if (!reply) return;
    handle(*reply);
    obey_requests();
  }
}

bool GcodeStream::may_pause_before(std::size_t number) const {
  return number == highest_ + 1 && number <= commands_.size() && !commands_.is_own(number - 1) &&
         !between_;
}

// Within the window, and never behind a command that blocks or any trouble: which line an error is
// about is seen only where none is given behind it. Marlin queues four
// lines and reads no further: so few are given that a cancel is read at once.
bool GcodeStream::may_give_another() const {
  const std::size_t next = last_ + 1;
  const bool calm =
      !resend_ && !m105_behind_ && !cancelling_ && !paused_ && !between_ && complaint_.empty();
  if (options_.window_bytes == 0 || line_count_ != LineCount::kKept || !calm ||
      next < careful_until_ || next > commands_.size() || unanswered_.size() >= kMostLines ||
      blocks(command(open_)) || blocks(command(next)))
    return false;
  std::size_t bytes = numbered_gcode(next, command(next)).size();
  for (const Given& given : unanswered_) bytes += given.bytes;
  return bytes <= options_.window_bytes;
}

void GcodeStream::give(std::size_t number) {
  const std::string line = numbered_line(number, command(number));
  const bool asks = is_question(number);
  unanswered_.push_back({asks ? 0 : number, line.size() + 1, gcode_word(command(number)) == "M105",
                         asks ? number : 0});
  channel_.send(line);
  alive_at_s_ = attempt_at_s_ = given_at_s_ = busy_at_s_ = channel_.now_s();
  patience_factor_ = 1;
  if (asks)
    tally_.count_sent(unanswered_.back().asks_temperatures);
  else
    open(number);
  last_ = number;
  highest_ = std::max(highest_, number);
}

// The line that is waited for from now on, whatever is asked behind it.
void GcodeStream::open(std::size_t number) {
  open_ = number;
  tally_.begin(unanswered_.back().asks_temperatures);
  if (number > highest_) trace_ = place_.follow(command(number)), repeated_ = 0;
  heat_.begin(command(number));
  if (!between_) prompt_.clear(), choices_.clear();
  show_state();
}

// A question is a line of its own, with the next number: flipped on its way to another command, it
// is refused by a printer that checks sums. Numbers that were given stay what they are, so where
// lines are given again a question is among them already, or its number is far ahead.
void GcodeStream::ask(const std::string& question) {
  std::size_t number = last_ + kFarAhead;
  if (last_ == highest_ || line_count_ == LineCount::kIgnored) {
    commands_.insert(highest_, {question});
    number = last_ = ++highest_;
  } else if (is_question(last_ + 1) && command(last_ + 1) == question) {
    number = ++last_;
  }
  send(numbered_line(number, question), question == "M105");
  unanswered_.back().question = number;
}

void GcodeStream::handle(const GcodeReply& reply) {
  const bool heating = is_heating(command(open_));
  reporter_.heaters(reply.heaters);
  if (proves_life(reply)) alive_at_s_ = channel_.now_s();
  switch (reply.kind) {
    case GcodeReplyKind::kOk:
      if (reply.has_position) hear_position(reply);
      heed_probe(reply);
      handle_ok(reply);
      break;
    case GcodeReplyKind::kResend:
      complaint_.clear();
      handle_resend(reply.number);
      break;
    case GcodeReplyKind::kBusy:
      handle_busy(reply);
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
      hear_position(reply);
      break;
    default:
      cancelling_ ? hear_while_cancelling(reply) : handle_action(reply);
      break;
  }
}

void GcodeStream::hear_position(const GcodeReply& reply) {
  if (is_behind_program(open_)) position_seen_ = true;
  if (positions_owed_ > 0)
    --positions_owed_;
  else if (!tells_position(command(open_)) && !reply.has_position)
    positions_unasked_ = true;
  if (asks_position_) told_ = read_gcode_point(reply.text);
}

// Beside the program; what is obeyed at once only where it has no number comes so.
void GcodeStream::send(std::string_view line, bool asks_temperatures) {
  channel_.send(line);
  tally_.count_sent(asks_temperatures);
  unanswered_.push_back({0, line.size() + 1, asks_temperatures, 0});
}

void GcodeStream::show_state() {
  if (cancelling_ || between_) return;
  const PrintState state =
      is_heating(command(open_)) ? PrintState::kHeating : PrintState::kPrinting;
  if (state == PrintState::kPrinting)
    reporter_.state(state, printing_text());
  else if (reporter_.current() != state)
    reporter_.state(state);
}

void GcodeStream::fail(const std::string& what, const std::string& hint) const {
  throw Error(Fault::kIo, what, hint);
}

}  // namespace packmerger
