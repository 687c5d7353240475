// What became of a line that a printer answered doubtfully: one that counts lines asks for what it
// lacks, any other (Klipper) is asked where it stands.
#include <utility>

#include "firmware_io/gcode/gcode_stream.h"

namespace packmerger {

namespace {

constexpr int kTries = 3;
// A line that loses more is bad, and flips bits too, which nobody could see here.
constexpr int kMostMissed = 5;
constexpr int kMostRepeated = 3;
// For the answers to what was asked while a slow command was executed; they come at once behind it.
constexpr double kOwed_s = 2;

}  // namespace

bool GcodeStream::is_in_doubt() const {
  return (in_doubt_ || was_silent_) && line_count_ != LineCount::kKept && !cancelling_ &&
         !resend_ && open_ > settled_;
}

// Returns the line to give again, where it got lost.
std::optional<std::size_t> GcodeStream::settle_doubt() {
  if (was_silent_) hear_what_is_owed();
  if (resend_) return hear_answers();
  if (is_proven_by_oks()) return std::nullopt;
  std::optional<std::size_t> again = learn_line_count();
  const bool counts = line_count_ == LineCount::kKept;
  if (!again && line_count_ == LineCount::kIgnored && was_silent_ && !in_doubt_) {
    again = learn_about_empty_lines();
    if (!again && is_proven_by_oks()) return std::nullopt;
  }
  const bool answered = tally_.proves_line(temperatures_in_ok_, answers_empty_);
  // Only one that counts none answers an empty line, so that the ok was perhaps not the line's.
  if (counts || answered) complaint_.clear();
  if (!again && !complaint_.empty() && !cancelling_) fail_unanswered();
  // One that says nothing to the probe may be either.
  if (!again && !counts && !cancelling_ && (line_count_ == LineCount::kIgnored || !answered))
    again = prove_by_position(answered);
  in_doubt_ = was_silent_ = false;
  return again;
}

bool GcodeStream::is_proven_by_oks() {
  if (in_doubt_ || !tally_.is_complete(temperatures_in_ok_) ||
      !tally_.proves_line(temperatures_in_ok_, answers_empty_))
    return false;
  was_silent_ = taken_for_granted_ = false;
  complaint_.clear();
  return true;
}

// Klipper says ok to an empty line, RepRapFirmware says nothing: only where that is known is it
// plain whether the one ok behind a silence was the line's or the empty line's. That it says
// nothing is believed the second time, since an answer may get lost.
std::optional<std::size_t> GcodeStream::learn_about_empty_lines() {
  constexpr int kSilences = 2;
  int silences = 0;
  while (!empty_is_known_ && temperatures_in_ok_ && !cancelling_) {
    ask_behind_empty_line();
    if (const auto again = hear_answers()) return again;
    const std::optional<bool> told = tally_.tells_of_empty_line();
    if (!told) return std::nullopt;
    if (!*told && ++silences < kSilences) continue;
    answers_empty_ = *told;
    empty_is_known_ = true;
  }
  return std::nullopt;
}

// A printer that was only slow has yet to answer whatever it was asked meanwhile; one that says
// that it has nothing to do has not.
void GcodeStream::hear_what_is_owed() {
  const double end_s = channel_.now_s() + kOwed_s;
  while (!resend_ && !tally_.is_complete(temperatures_in_ok_) && channel_.now_s() < end_s) {
    const auto reply = channel_.receive(kSettle_s);
    if (reply && reply->kind == GcodeReplyKind::kIdle) return;
    if (reply) handle(*reply);
    obey_requests();
  }
}

// Asks, three times at most, until that settles it. Returns a line that the printer asks for
// instead; one that may count nothing means nothing by that while it is probed.
template <typename Ask, typename IsSettled>
std::optional<std::size_t> GcodeStream::ask_until(const IsSettled& is_settled,
                                                  const Ask& ask_once) {
  bool settled = is_settled();
  for (int i = 0; i < kTries && !settled && !cancelling_; ++i) {
    hear_what_came(kSettle_s);
    ask_once();
    const auto again = hear_answers();
    const bool heeds = !std::exchange(probes_, false) || line_count_ == LineCount::kKept;
    if (!again) hear_what_came(kSettle_s);
    asks_position_ = false;
    settled = is_settled();
    if (again && heeds) return again;
    resend_.reset();
  }
  return std::nullopt;
}

// M105 under a wrong number: a printer that counts asks for the line that it lacks, or for the next
// one; any other executes it.
std::optional<std::size_t> GcodeStream::learn_line_count() {
  return ask_until([&] { return line_count_ != LineCount::kUnknown; },
                   [&] {
                     probes_ = true;
                     probed_at_s_ = channel_.now_s();
                     send(numbered_line(last_ + kFarAhead, "M105"), true);
                   });
}

// A temperature that was asked for in another way (after a silence) proves nothing.
void GcodeStream::heed_probe(const GcodeReply& ok) {
  const bool executed = probes_ && ok.has_temperature && attempt_at_s_ <= probed_at_s_;
  if (executed && line_count_ == LineCount::kUnknown) line_count_ = LineCount::kIgnored;
}

std::optional<std::size_t> GcodeStream::prove_by_position(bool answered) {
  GcodeFate fate = GcodeFate::kUnknown;
  told_.reset();
  const auto again = ask_until(
      [&] {
        if (told_) fate = fate_of(trace_, *told_, answered);
        return fate != GcodeFate::kUnknown;
      },
      [&] {
        told_.reset();
        asks_position_ = true;
        positions_owed_ += 2;  // the answer may be doubled on its way
        ask("M114");
      });
  if (again || cancelling_) return again;
  if (fate == GcodeFate::kTaken) {
    taken_for_granted_ = false;
    place_.learn(*told_);
    return std::nullopt;
  }
  const bool fails = fate == GcodeFate::kUnknown ||
                     (fate == GcodeFate::kMissed && ++missed_ > kMostMissed) ||
                     (fate == GcodeFate::kRepeatable && ++repeated_ > kMostRepeated);
  if (!fails) return open_;
  // One that may count after all asks for what it lacks.
  if (line_count_ == LineCount::kIgnored) fail_in_doubt(answered);
  return std::nullopt;
}

void GcodeStream::fail_in_doubt(bool answered) const {
  const std::string line = "line " + std::to_string(open_) + " (" + command(open_) + ")";
  const std::string hint =
      "Look at what lies between PackMerger and the printer (cable, serial server, plug-in), then "
      "print the job again.";
  if (missed_ > kMostMissed)
    fail("The way to the printer loses lines, such as " + line +
             ", and the printer checks neither their numbers nor their sums",
         hint);
  if (!told_)
    fail("The printer does not say where it is (M114), so nobody can tell whether it executed " +
             line,
         hint);
  if (answered)
    fail(
        "The printer is not where " + line +
            " leads: something got lost or was doubled on its way, and the printer counts no lines",
        hint);
  fail("Nobody can tell whether the printer executed " + line +
           ": its answer got lost, and the printer counts no lines",
       hint);
}

}  // namespace packmerger
