#include "firmware_io/s3g_print.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace packmerger::s3g {

namespace {

constexpr int kMaxRejected = 5;
constexpr double kWatch_s = 1;
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

// Short waits first, so that a quick printer is not held up, then longer ones.
double next_wait(double& wait_s, double longest_s) {
  const double now = wait_s;
  wait_s = std::min(wait_s * 1.2, longest_s);
  return now;
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
  capacity_ = channel_.free_buffer();
  channel_.tolerate_cancelled(false);
  channel_.forget_too_much();
}

void Print::run(const std::vector<std::string_view>& actions,
                const std::vector<std::size_t>& counted) {
  actions_ = &actions;
  note_heaters();
  reporter_.state(PrintState::kPrinting);
  watched_at_s_ = channel_.now_s();
  for (std::size_t i = 0; i < actions.size(); ++i) {
    send(i);
    reporter_.done(counted[i]);
  }
  finish();
}

void Print::send(std::size_t index) {
  const std::string_view action = (*actions_)[index];
  int rejected = 0;
  while (true) {
    obey();
    if (channel_.take_missed() || channel_.now_s() - watched_at_s_ >= kWatch_s) watch();
    channel_.hear_strays();
    if (channel_.heard_too_much()) check_nothing_taken_twice();
    switch (channel_.try_action(action)) {
      case Verdict::kAccepted:
        return note_accepted(index);
      case Verdict::kFull:
        wait_for_room(action.size());
        continue;
      case Verdict::kUnclear:
        if (was_taken(index)) return note_accepted(index);
        break;
      case Verdict::kRejected:
        break;
    }
    if (++rejected >= kMaxRejected)
      fail("The printer did not understand the same command five times",
           "Use a shorter or better shielded cable, then print the job again.");
  }
}

void Print::note_accepted(std::size_t index) {
  const std::uint8_t code = code_of((*actions_)[index]);
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
  while (channel_.free_buffer() < size) {
    channel_.pause(next_wait(wait_s, kSlice_s));
    obey();
    if (channel_.now_s() - watched_at_s_ >= kWatch_s) watch();
  }
}

// Once the buffer is empty, the printer's own count tells what it took.
Statistics Print::drained_statistics() {
  wait_for_room(capacity_);
  return channel_.statistics();
}

// An answer got lost. Sending the action again might execute it twice, so the printer is asked.
bool Print::was_taken(std::size_t index) {
  const std::uint8_t code = code_of((*actions_)[index]);
  const Statistics statistics = drained_statistics();
  if (code == kBuildStart) return statistics.state == BuildState::kRunning;
  if (code != kBuildEnd) judge(statistics);
  // With an answer too many besides, the count proves nothing.
  if (started_ && !ended_ && !channel_.heard_too_much()) {
    if (code == kBuildEnd && statistics.state == BuildState::kFinished) return true;
    if (statistics.actions == after_start_) return false;
    if (statistics.actions == after_start_ + 1) return true;
  }
  fail("An answer of the printer got lost, and its count does not tell which commands it has",
       "Use a shorter or better shielded cable. " + std::string(kPrintAgain));
}

void Print::check_nothing_taken_twice() {
  channel_.forget_too_much();
  if (!started_) return;
  if (drained_statistics().actions != after_start_)
    fail("The printer has executed a command twice or not at all",
         "Use a shorter or better shielded cable. " + std::string(kPrintAgain));
}

void Print::finish() {
  double wait_s = 0.002;
  constexpr double kPatience_s = 5;
  double busy_at = channel_.now_s();
  while (true) {
    const bool idle = channel_.is_finished() && channel_.free_buffer() == capacity_;
    const Statistics statistics = channel_.statistics();
    judge(statistics);
    if (idle && statistics.state == BuildState::kFinished) break;
    const bool paused = statistics.state == BuildState::kPaused;
    if (!idle || paused) busy_at = channel_.now_s();
    if (channel_.now_s() - busy_at > kPatience_s)
      fail("The printer has stopped without finishing its build", kPrintAgain);
    obey();
    if (channel_.now_s() - watched_at_s_ >= kWatch_s) watch();
    channel_.pause(next_wait(wait_s, 2 * kSlice_s));
  }
  if (channel_.heard_too_much()) check_nothing_taken_twice();
}

void Print::obey() {
  control_.take_answer();  // a Replicator is answered at its own panel
  if (control_.stopped()) stop_at_once();
  if (control_.cancelled()) cancel();
  reporter_.tick();
  if (const auto wanted = control_.take_pause_request()) pause_wanted_ = wanted;
  if (pause_wanted_ && seen_running_) set_paused(*std::exchange(pause_wanted_, std::nullopt));
}

void Print::stop_at_once() {
  may_abort_ = false;  // it is done here
  channel_.tolerate_cancelled(true);
  channel_.query(std::string(1, kAbort), 0);
  throw_stopped();
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
  while (is_building(channel_.statistics().state) || channel_.free_buffer() < capacity_) {
    if (channel_.now_s() > end)
      fail("The printer was told to cancel but is still building",
           "Cancel at the printer's panel, or switch it off.");
    channel_.pause(kSlice_s / 2);
  }
  throw Error(Fault::kInterrupted, "The print was cancelled", "");
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
