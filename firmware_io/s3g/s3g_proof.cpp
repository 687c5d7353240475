// What a printer whose answer got lost has of a build: proved by what its buffer holds, by its
// build's state, by its own count, where it has one, and by where it stands.
#include <string>
#include <utility>

#include "base/error.h"
#include "firmware_io/s3g/s3g_print.h"

namespace packmerger::s3g {

namespace {

const char* const kBetterCable =
    "Use a shorter or better shielded cable. Clear the bed and print the job again.";

[[noreturn]] void fail(const std::string& what) { throw Error(Fault::kIo, what, kBetterCable); }

std::uint8_t code_of(std::string_view action) { return static_cast<std::uint8_t>(action[0]); }

}  // namespace

// Sending the action again might execute it twice, so the printer is asked.
bool Print::was_taken(std::size_t index) {
  const std::string_view action = (*actions_)[index];
  may_have_ended_ = code_of(action) == kBuildEnd;
  const std::optional<bool> taken = has_taken(action);
  may_have_ended_ = false;
  if (!taken)
    fail("An answer of the printer got lost, and nothing tells whether it took the command");
  // The answer that was missed may have come since; more than that, and nothing is certain.
  if (channel_.take_surplus() > (*taken ? 1 : 0))
    fail("The printer answered more often than it was spoken to");
  return *taken;
}

// The packet that came last is the one whose second answer would be heard first.
void Print::check_nothing_taken_twice() {
  channel_.take_surplus();
  if (!started_) return;
  const std::optional<bool> twice = has_taken((*actions_)[accepted_ - 1]);
  if (!twice || *twice || channel_.surplus() > 0)
    fail("The printer may have executed a command twice");
}

// Whether the printer has taken `action` behind all that it is known to have. Mostly its buffer
// tells at once; otherwise it is let run empty.
std::optional<bool> Print::has_taken(std::string_view action) {
  if (const auto told = buffer_tells(action.size())) return told;
  const Statistics statistics = channel_.statistics();
  judge(statistics);
  if (const auto told = build_tells(code_of(action), statistics.state)) return told;
  if (const auto told = count_tells(statistics.actions)) return told;
  return position_tells(action);
}

std::optional<bool> Print::buffer_tells(std::size_t length) {
  double wait_s = 0.005;
  while (!channel_.is_finished()) {
    if (const auto told = buffer_.tells(channel_.free_buffer(), length)) return told;
    wait(wait_s, kSlice_s);
  }
  buffer_.emptied(channel_.free_buffer());
  return std::nullopt;
}

// A build that has begun or ended has executed its start or end.
std::optional<bool> Print::build_tells(std::uint8_t code, BuildState state) const {
  if (code == kBuildStart && !started_) return state == BuildState::kRunning;
  if (code == kBuildEnd && !ended_ && state == BuildState::kFinished) return true;
  return std::nullopt;
}

// Most firmware is built without a count, and then always tells 0.
std::optional<bool> Print::count_tells(std::uint32_t actions) {
  counts_ = counts_ || actions > 0;
  if (!counts_ || !started_ || ended_) return std::nullopt;
  if (actions == after_start_) return false;
  if (actions == after_start_ + 1) return true;
  fail("The printer's count does not tell which commands it has");
}

std::optional<bool> Print::position_tells(std::string_view action) {
  if (!started_ || ended_) return std::nullopt;
  Axes with = axes_;
  with.apply(action);
  return tells(position_at_rest(), axes_, with);
}

// Its buffer is empty, but moves may still be on their way: until none of its axes has made a step
// for a while. A machine that stands paused stands somewhere else.
Steps Print::position_at_rest() {
  constexpr double kRest_s = 0.5;
  Steps stands = channel_.position();
  double since_s = channel_.now_s();
  double wait_s = kSlice_s / 2;
  while (channel_.now_s() - since_s < kRest_s) {
    wait(wait_s, kSlice_s);
    const bool runs = channel_.statistics().state == BuildState::kRunning;
    const Steps now = channel_.position();
    if (!runs || now != std::exchange(stands, now)) since_s = channel_.now_s();
  }
  return stands;
}

}  // namespace packmerger::s3g
