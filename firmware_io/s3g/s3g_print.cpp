#include "firmware_io/s3g/s3g_print.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace packmerger::s3g {

namespace {

constexpr int kMaxRejected = 5;
constexpr double kDisturbed_s = 0.5;  // more than the time-out of a packet that did not come whole
constexpr std::uint8_t kStatusBusyAlone = (1U << 3) | (1U << 2);  // with a script of its own

const char* const kPrintAgain = "Clear the bed and print the job again.";

[[noreturn]] void fail(const std::string& what, const std::string& hint) {
  throw Error(Fault::kIo, what, hint);
}

std::uint8_t code_of(std::string_view action) { return static_cast<std::uint8_t>(action[0]); }

bool is_building(BuildState state) {
  return state == BuildState::kRunning || state == BuildState::kPaused ||
         state == BuildState::kCancelling;
}

}  // namespace

Print::Print(Channel& channel, Reporter& reporter, PrintControl& control)
    : channel_(channel), reporter_(reporter), control_(control) {}

void Print::connect(double boot_wait_s, const std::string& machine) {
  const double end = channel_.now_s() + boot_wait_s;
  while (channel_.now_s() < end) {
    channel_.pause(std::min(kSlice_s, end - channel_.now_s()));
    check_not_ended(control_);
  }
  channel_.resynchronize();
  // A build cancelled earlier is told to the first who asks.
  channel_.tolerate_cancelled(true);
  std::uint32_t version = 0;
  try {
    constexpr char kHostVersion = 100;  // below 39 the firmware hides its own
    version = read_integer(channel_.query(std::string{kVersion, kHostVersion, 0}, 2));
  } catch (const Error&) {
    version = 0;
  }
  if (version == 0)
    throw Error(
        Fault::kUnavailable, "Nothing that speaks s3g answers at " + channel_.name(),
        "Check that the printer is on, and that the profile's dialect and link.baud fit it.");
  channel_.query(std::string(1, kInit), 0);
  check_machine(channel_.name(), channel_.firmware_name(version), machine);
  const bool busy =
      is_building(channel_.statistics().state) || (channel_.board_status() & kStatusBusyAlone) != 0;
  if (busy)
    throw Error(Fault::kBusy, "The printer at " + channel_.name() + " is printing already",
                "Wait until that print is done, or cancel it at the printer.");
  if (channel_.is_finished()) buffer_.emptied(channel_.free_buffer());
  channel_.tolerate_cancelled(false);
  channel_.take_surplus();
}

void Print::run(const Actions& actions) {
  actions_ = &actions;
  note_heaters();
  reporter_.state(PrintState::kPrinting);
  watched_at_s_ = channel_.now_s();
  for (std::size_t i = 0; i < actions.size(); ++i) {
    send(i);
    reporter_.done(actions.done(i));
  }
  finish();
}

void Print::send(std::size_t index) {
  const std::string_view action = (*actions_)[index];
  int rejected = 0;
  while (true) {
    obey();
    if (channel_.take_missed())
      watch();
    else
      watch_when_due();
    channel_.hear_strays();
    if (channel_.surplus() > 0) check_nothing_taken_twice();
    Verdict verdict = channel_.try_action(action);
    if (verdict == Verdict::kAccepted) return note_accepted(index);
    if (verdict == Verdict::kFull) {
      wait_for_room(action.size());
      continue;
    }
    // What else the disturbance set off is heard before anything is sent again.
    channel_.pause(kDisturbed_s);
    if (channel_.surplus() > 0) verdict = Verdict::kUnclear;
    if (verdict == Verdict::kUnclear && was_taken(index)) return note_accepted(index);
    if (++rejected >= kMaxRejected)
      fail("The printer did not understand the same command five times",
           "Use a shorter or better shielded cable, then print the job again.");
  }
}

void Print::note_accepted(std::size_t index) {
  const std::string_view action = (*actions_)[index];
  const std::uint8_t code = code_of(action);
  buffer_.add(action.size());
  axes_.apply(action);
  accepted_ = index + 1;
  ++after_start_;
  if (code == kBuildStart) {
    started_ = true;
    ended_ = false;
    start_ = index;
    after_start_ = 0;
  }
  if (code == kBuildEnd) ended_ = true;
}

// Polls until the printer's buffer has room.
void Print::wait_for_room(std::size_t size) {
  double wait_s = 0.005;
  while (true) {
    const std::uint32_t free_bytes = channel_.free_buffer();
    buffer_.observe(free_bytes);
    if (free_bytes >= size) return;
    wait(wait_s, kSlice_s);
  }
}

void Print::finish() {
  double wait_s = 0.002;
  constexpr double kPatience_s = 5;
  double busy_at = channel_.now_s();
  while (true) {
    const bool idle = channel_.is_finished();
    const Statistics statistics = channel_.statistics();
    judge(statistics);
    if (idle && statistics.state == BuildState::kFinished) break;
    const bool paused = statistics.state == BuildState::kPaused;
    if (!idle || paused) busy_at = channel_.now_s();
    if (channel_.now_s() - busy_at > kPatience_s)
      fail("The printer has stopped without finishing its build", kPrintAgain);
    wait(wait_s, 2 * kSlice_s);
  }
  if (channel_.surplus() > 0) check_nothing_taken_twice();
}

// Short waits first, so that a quick printer is not held up, then longer ones.
void Print::wait(double& wait_s, double longest_s) {
  channel_.pause(wait_s);
  wait_s = std::min(wait_s * 1.2, longest_s);
  obey();
  watch_when_due();
}

void Print::obey() {
  control_.take_answer();  // a Replicator is answered at its own panel
  if (control_.left()) leave_at_once();
  if (control_.stopped()) stop_at_once();
  if (control_.cancelled()) cancel();
  reporter_.tick();
  if (const auto wanted = control_.take_pause_request()) pause_wanted_ = wanted;
  if (pause_wanted_ && seen_running_) set_paused(*std::exchange(pause_wanted_, std::nullopt));
}

void Print::stop_at_once() {
  may_abort_ = false;  // it is done here
  leaves_ = true;
  channel_.tolerate_cancelled(true);
  try {
    channel_.query(std::string(1, kAbort), 0);
  } catch (const Error& error) {
    throw Error(Fault::kIo,
                std::string("The printer was to be stopped at once, as somebody asked, but it is "
                            "not certain that it obeyed: ") +
                    error.what(),
                kMayBeHot);
  }
  throw_stopped();
}

// For a person who waits no longer.
void Print::leave_at_once() {
  may_abort_ = false;
  leaves_ = true;
  channel_.tell(kAbort);
  throw Error(Fault::kInterrupted,
              "The print was ended at once: the printer was told to abort, and nobody waited to "
              "see it obeyed",
              kMayBeHot);
}

// The query toggles, so the build state is read before each try, and what is wanted may already be
// so: a pause at the printer's panel is one too.
void Print::set_paused(bool wanted) {
  constexpr int kMostTries = 5;
  constexpr double kSettle_s = 0.2;
  for (int i = 0; i < kMostTries; ++i) {
    const BuildState state = channel_.statistics().state;
    const bool can = state == BuildState::kRunning || state == BuildState::kPaused;
    if (!can || (state == BuildState::kPaused) == wanted) break;
    channel_.try_query(kPause);
    channel_.pause(kSettle_s);
  }
  watch();
}

void Print::cancel() {
  reporter_.state(PrintState::kCancelling);
  channel_.tolerate_cancelled(true);
  may_abort_ = false;  // it is done here
  channel_.query(std::string(1, kAbort), 0);
  constexpr double kPatience_s = 10;
  const double end = channel_.now_s() + kPatience_s;
  while (is_building(channel_.statistics().state) || !channel_.is_finished()) {
    if (control_.left()) leave_at_once();
    if (control_.stopped()) stop_at_once();
    if (channel_.now_s() > end)
      fail("The printer was told to cancel but is still building",
           "Cancel at the printer's panel, or switch it off.");
    channel_.pause(kSlice_s / 2);
  }
  throw Error(Fault::kInterrupted, "The print was cancelled", "");
}

void Print::end_by(const Error& error) {
  const bool failed = error.fault() == Fault::kIo && !leaves_;
  if (failed && control_.left()) leave_at_once();
  if (failed && control_.stopped()) stop_at_once();
  abort_quietly();
  if (failed && control_.cancelled()) throw_failed_cancel(error);
}

void Print::abort_quietly() {
  if (!may_abort_ || !channel_.may_abort()) return;
  try {
    channel_.tolerate_cancelled(true);
    channel_.query(std::string(1, kAbort), 0);
  } catch (const Error&) {
    // The port is gone or the printer dead; the failure that led here is what the user must read.
  }
}

}  // namespace packmerger::s3g
