// What people and the machine itself ask of a print: to cancel, pause, go on, stop at once.
#include <algorithm>
#include <utility>

#include "firmware_io/gcode/gcode_stream.h"

namespace packmerger {

namespace {

// How often a printer that stands still is asked for its temperatures, which keeps it and the line
// awake.
constexpr double kPoll_s = 2;

}  // namespace

std::vector<std::string> gcode_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (const GcodeCommand& command : gcode_commands(text)) lines.emplace_back(command.text);
  return lines;
}

void GcodeStream::obey_requests() {
  if (control_.left()) leave_at_once();
  if (control_.stopped()) stop_at_once();
  if (control_.cancelled() && !cancelling_) begin_cancel();
  if (const auto wanted = control_.take_pause_request()) {
    parks_ = *wanted && !paused_ ? true : parks_;
    if (!*wanted || !paused_) pause_text_.clear();
    paused_ = *wanted;
  }
  if (const int answer = control_.take_answer(); answer >= 0 && !cancelling_) pass_on(answer);
}

// The question is shown no longer, or it would be answered twice, and the second time another one:
// firmwares that go on say nothing for a while. It comes back where the printer still waits.
void GcodeStream::pass_on(int answer) {
  send(abilities_.emergency_parser ? "M876 S" + std::to_string(answer) : std::string("M108"));
  answered_at_s_ = channel_.now_s();
  question_answered_ = true;
  if (between_) return show_pause();
  stands_still() ? reporter_.state(PrintState::kPaused, pause_text_) : show_state();
}

bool GcodeStream::stands_still() const { return between_ || (paused_ && !parks_); }

void GcodeStream::close_question() {
  prompt_.clear();
  choices_.clear();
  question_answered_ = false;
  if (stands_still()) show_pause();
}

// Only an M112 of its own is obeyed before its turn; the empty line ends whatever half line is in
// the printer.
void GcodeStream::stop_at_once() {
  may_send_ = false;
  channel_.send("\nM112");
  throw_stopped();
}

// A machine that says "paused" has parked by itself; one that says "pause" leaves that to its host.
void GcodeStream::handle_action(const GcodeReply& reply) {
  switch (reply.kind) {
    case GcodeReplyKind::kPrompt:
      prompt_ = reply.text;
      choices_.clear();
      question_answered_ = false;
      return reporter_.state(PrintState::kWaiting, prompt_, choices_);
    case GcodeReplyKind::kPromptButton:
      choices_.push_back(reply.text);
      return reporter_.state(PrintState::kWaiting, prompt_, choices_);
    case GcodeReplyKind::kPromptEnd:
      return close_question();
    case GcodeReplyKind::kPause:
      if (!paused_) parks_ = !reply.waiting;
      paused_ = true;
      if (!reply.waiting) return;
      pause_text_ = "at the printer";
      return show_pause();
    case GcodeReplyKind::kResume:
      paused_ = false;
      pause_text_.clear();
      return show_state();
    case GcodeReplyKind::kCancel:
      cancelled_at_printer_ = true;
      return begin_cancel();
    default:
      return;
  }
}

// No line of the program is given until the pause ends. Returns the number of the next one.
std::size_t GcodeStream::pause(std::size_t number) {
  between_ = true;
  show_pause();
  const bool parked = std::exchange(parks_, false);
  std::vector<std::string> resume = gcode_lines(options_.resume_gcode);
  if (!resume.empty() || !options_.pause_gcode.empty())
    for (std::string& line : commands_.modes(number - 1)) resume.push_back(std::move(line));
  if (parked) {
    std::vector<std::string> lines = gcode_lines(options_.pause_gcode);
    lines.insert(lines.begin(), "M400");
    number = execute_between(number, lines);
  }
  stand_still();
  number = highest_ + 1;
  if (parked && !cancelling_) number = execute_between(number, resume);
  pause_text_.clear();
  between_ = false;
  place_.forget();
  settled_ = last_;
  return number;
}

// A question with answers is shown until it is answered, though the printer stands paused.
void GcodeStream::show_pause() {
  const bool asks = !question_answered_;
  if (asks && !choices_.empty()) return reporter_.state(PrintState::kWaiting, prompt_, choices_);
  std::string text = pause_text_;
  if (asks && !prompt_.empty()) text += (text.empty() ? "" : ": ") + prompt_;
  reporter_.state(PrintState::kPaused, text);
}

// Listens, asks for the temperatures, and never gives up: a pause may take as long as it likes. A
// printer that is busy with a pause of its own reads nothing yet, and what it does not read would
// pile up.
void GcodeStream::stand_still() {
  double asked_at_s = channel_.now_s();
  while (paused_ && !cancelling_) {
    obey_requests();
    reporter_.tick();
    const double now = channel_.now_s();
    const bool answered = unanswered_.empty();
    if (now - (answered ? asked_at_s : std::max(asked_at_s, busy_at_s_)) >=
        (answered ? kPoll_s : std::max(kPoll_s, options_.timeout_s))) {
      unanswered_.clear();
      ask_for_proof();
      asked_at_s = channel_.now_s();
    }
    const auto reply = channel_.receive(kSlice_s);
    if (reply && reply->kind == GcodeReplyKind::kResend)
      ask_again_from(reply->number);
    else if (reply && reply->kind != GcodeReplyKind::kIdle)
      handle(*reply);
  }
}

// In a pause only questions are given again. A line that is really missing is asked for once more
// as soon as the next one is given.
void GcodeStream::ask_again_from(std::size_t number) {
  if (number <= open_ || number > last_) return;
  last_ = number - 1;
  unanswered_.clear();
}

// Executes lines in front of line `number`, which was never given, with numbers of their own.
std::size_t GcodeStream::execute_between(std::size_t number,
                                         const std::vector<std::string>& lines) {
  const std::size_t before = commands_.program_lines(number - 1);
  commands_.insert(number - 1, lines);
  while (commands_.program_lines(number) <= before && !cancelling_) number = exchange(number);
  return number;
}

}  // namespace packmerger
