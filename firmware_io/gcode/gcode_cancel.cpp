// How a cancel comes to its end, whatever the printer waits for.
#include <algorithm>
#include <array>
#include <cctype>

#include "base/error.h"
#include "firmware_io/gcode/ascii.h"
#include "firmware_io/gcode/gcode_stream.h"

namespace packmerger {

namespace {

// A machine that homes or levels its bed cannot be interrupted; nothing but M112 ends it sooner.
constexpr double kLongestCancel_s = 60;
// Its question is complete by then: the buttons come behind it.
constexpr double kQuestion_s = 0.3;
constexpr double kAnswerEvery_s = 2;

// The button that goes on: another one, such as "Purge More", may bring the same question again.
std::size_t button_that_ends(const std::vector<std::string>& choices) {
  constexpr std::array<std::string_view, 8> kWords = {"continue", "resume", "done",  "cancel",
                                                      "abort",    "stop",   "close", "ok"};
  for (std::size_t i = 0; i < choices.size(); ++i) {
    std::string text = choices[i];
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (std::any_of(kWords.begin(), kWords.end(),
                    [&](std::string_view word) { return ascii::has(text, word); }))
      return i;
  }
  return choices.empty() ? 0 : choices.size() - 1;
}

}  // namespace

// M410 drops the planned moves, M108 ends a wait for heat or for the user. Both are obeyed at once
// only when they are not numbered. The program is then replaced by the safe text; what the printer
// may still ask for again becomes M105, which does nothing.
void GcodeStream::begin_cancel() {
  cancelling_ = true;
  paused_ = false;
  cancelled_at_s_ = channel_.now_s();
  answer_at_s_ = cancelled_at_s_ + kAnswerEvery_s;
  reporter_.state(PrintState::kCancelling);
  send("M410");
  send("M108");
  // In a pause the numbers of its questions run away from the line that may still be lacking.
  const std::size_t from = std::min(highest_, open_);
  const std::size_t first = std::min(from > kSlack ? from - kSlack : 1, commands_.size() + 1);
  commands_.shorten(highest_);
  for (std::size_t i = first; i <= commands_.size(); ++i) commands_.replace(i - 1, "M105");
  end_ = 0;
  position_tries_ = 0;
  for (std::string& line : gcode_lines(options_.safe_gcode)) commands_.append(std::move(line));
  position_seen_ = false;
}

// What the printer asks while a cancel is under way, and that it still waits for its user.
void GcodeStream::hear_while_cancelling(const GcodeReply& reply) {
  if (reply.kind == GcodeReplyKind::kPrompt) {
    prompt_ = reply.text;
    choices_.clear();
    answer_every_s_ = kAnswerEvery_s;
    answer_at_s_ = channel_.now_s() + kQuestion_s;
    asks_ = true;
  }
  if (reply.kind == GcodeReplyKind::kPromptButton) choices_.push_back(reply.text);
  if (reply.kind == GcodeReplyKind::kBusy && reply.waiting) asks_ = true;
}

// Ever more seldom where the printer does not go on, since what it does not read piles up.
void GcodeStream::press_on_with_cancel() {
  if (!cancelling_) return;
  const double now = channel_.now_s();
  if (now - cancelled_at_s_ >= kLongestCancel_s) halt_in_cancel();
  if (!asks_ || now < answer_at_s_) return;
  asks_ = false;
  answer_at_s_ = now + answer_every_s_;
  answer_every_s_ *= 2;
  const std::size_t button = button_that_ends(choices_);
  send("M108");
  if (abilities_.emergency_parser) send("M876 S" + std::to_string(button));
  std::string text = "answering the printer, which waits for its user";
  if (!prompt_.empty()) text += ": " + prompt_;
  if (button < choices_.size()) text += " (" + choices_[button] + ")";
  reporter_.state(PrintState::kCancelling, text);
}

void GcodeStream::halt_in_cancel() {
  constexpr double kPatience_s = 2;
  may_send_ = false;
  channel_.send("\nM112");
  bool halted = false;
  const double end = channel_.now_s() + kPatience_s;
  while (!halted && channel_.now_s() < end) {
    const auto reply = channel_.receive(end - channel_.now_s());
    halted = reply && reply->kind == GcodeReplyKind::kStopped;
  }
  if (halted)
    throw Error(fault_of_cancel(),
                "The print was cancelled; the printer did not come to rest within a minute and was "
                "halted (M112)",
                "Look at the machine, and switch it off and on before the next job.");
  throw Error(fault_of_cancel(),
              "The print was cancelled, but the printer did not come to rest within a minute, and "
              "does not say that it obeys M112",
              kMayBeHot);
}

Fault GcodeStream::fault_of_cancel() const {
  return cancelled_at_printer_ ? Fault::kIo : Fault::kInterrupted;
}

// The few bytes that matter, for a person who waits no longer.
void GcodeStream::leave_at_once() {
  may_send_ = false;
  std::string bytes = "\nM410\nM108";
  for (const std::string& line : gcode_lines(options_.safe_gcode)) bytes += "\n" + line;
  channel_.send(bytes);
  throw Error(Fault::kInterrupted,
              "The print was ended at once: the printer was sent its safe text, and nobody waited "
              "to see it obeyed",
              kMayBeHot);
}

}  // namespace packmerger
