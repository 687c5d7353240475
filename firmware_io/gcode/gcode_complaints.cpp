// What a printer complains of in the middle of a print.
#include <algorithm>
#include <utility>

#include "firmware_io/gcode/gcode_stream.h"

namespace packmerger {

// Whether it is harmless, only what follows tells: a Resend, or an ok to the open line. The words
// tell nothing, because a line that garbles what is sent garbles them too.
void GcodeStream::handle_error(const GcodeReply& reply) {
  if (!complaint_.empty()) return;
  complaint_ = reply.text;
  complained_at_s_ = channel_.now_s();
}

// By an ok behind which no line is open any more. line_unanswered: it answers what was asked behind
// a line that got none of its own, and no ok to a question makes an error line harmless. One that
// came after an empty line may be for that instead (settle_doubt() finds out).
void GcodeStream::settle_complaint(bool line_unanswered) {
  if (complaint_.empty()) return;
  if (line_unanswered && !resend_ && !cancelling_) fail_unanswered();
  if (!was_silent_ || line_count_ == LineCount::kKept || cancelling_) complaint_.clear();
}

void GcodeStream::fail_unanswered() const {
  fail("The printer said \"" + complaint_ + "\", and neither that it has executed what it was " +
           "sent then nor that it wants it again",
       "Find out why, switch the printer off and on, then print the job again.");
}

void GcodeStream::fail_in_silence() const {
  if (!complaint_.empty())
    fail("The printer said \"" + complaint_ + "\" and has not answered since",
         "Find out why, switch the printer off and on, then print the job again.");
  fail("The printer has not answered line " + std::to_string(open_) + " (" + command(open_) + ")",
       "Check the cable, switch the printer off and on, then print the job again.");
}

// Printers answer a command that they do not know with ok and pass over it.
void GcodeStream::handle_unknown(const std::string& word) {
  const auto given = std::find_if(unanswered_.begin(), unanswered_.end(), [&](const Given& g) {
    return g.number > 0 && gcode_word(command(g.number)) == word;
  });
  // Noise makes unknown commands of what is sent without a number, and, where numbers are not
  // looked at, of every line.
  if (given == unanswered_.end()) in_doubt_ = true;
  if (given == unanswered_.end() || cancelling_) return;
  const Omission omission = omission_of(word);
  if (omission == Omission::kOfPrint)
    fail("The printer does not know \"" + command(given->number) + "\", without which the print " +
             "goes wrong",
         "Enable " + word + " in the printer's firmware, or prepare the job for what it knows.");
  if (omission == Omission::kOfPerson && !between_) {
    parks_ = parks_ || !paused_;
    paused_ = true;
    pause_text_ = "the printer does not know \"" + command(given->number) +
                  "\"; do by hand what it asks for, then go on";
  }
  if (std::find(unknown_.begin(), unknown_.end(), word) == unknown_.end()) unknown_.push_back(word);
  show_state();
}

// What people should know while it prints.
std::string GcodeStream::printing_text() const {
  std::string text;
  for (const std::string& word : unknown_)
    text += (text.empty() ? "the printer passes over what it does not know: " : ", ") + word;
  return text;
}

}  // namespace packmerger
