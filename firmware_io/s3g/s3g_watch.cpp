// What a build on a printer that speaks s3g is seen to do.
#include "base/error.h"
#include "firmware_io/s3g/s3g_print.h"

namespace packmerger::s3g {

namespace {

constexpr std::uint8_t kStatusHeatShutdown = 1U << 6;
constexpr std::uint8_t kStatusWaitsForButton = 1U << 4;

const char* const kPrintAgain = "Clear the bed and print the job again.";

[[noreturn]] void fail(const std::string& what, const std::string& hint) {
  throw Error(Fault::kIo, what, hint);
}

std::uint8_t code_of(std::string_view action) { return static_cast<std::uint8_t>(action[0]); }

bool waits_for_heat(std::string_view action) {
  return code_of(action) == kWaitForTool || code_of(action) == kWaitForPlatform;
}

}  // namespace

void Print::watch_when_due() {
  constexpr double kInterval_s = 1;
  if (channel_.now_s() - watched_at_s_ >= kInterval_s) watch();
}

// Asks the printer how its build stands.
void Print::watch() {
  watched_at_s_ = channel_.now_s();
  // An empty buffer: the build start was executed.
  if (started_ && !seen_running_) seen_running_ = channel_.is_finished();
  const Statistics statistics = channel_.statistics();
  const std::uint8_t board_status = channel_.board_status();
  if ((board_status & kStatusHeatShutdown) != 0) {
    may_abort_ = false;
    fail("The printer shut its heaters down because one was too hot or failed",
         "Switch the printer off, check heaters and sensors, then print the job again.");
  }
  judge(statistics);
  tell_heaters();
  show(statistics.state, board_status);
}

void Print::judge(const Statistics& statistics) {
  if (statistics.state == BuildState::kRunning) seen_running_ = true;
  if (!seen_running_) return;  // the state is still that of the build before
  const bool cancelled =
      statistics.state == BuildState::kCancelled || statistics.state == BuildState::kCancelling;
  const bool reset = statistics.state == BuildState::kNone;
  if (cancelled || reset) may_abort_ = false;
  if (cancelled) fail("The build was cancelled at the printer", kPrintAgain);
  if (reset)
    fail("The printer was reset in the middle of the print",
         "Check the printer's power supply. " + std::string(kPrintAgain));
  if (statistics.state == BuildState::kFinished && !ended_ && !may_have_ended_)
    fail("The printer ended its build before the program was through", kPrintAgain);
}

void Print::show(BuildState state, std::uint8_t board_status) {
  if (state == BuildState::kPaused) return reporter_.state(PrintState::kPaused);
  if ((board_status & kStatusWaitsForButton) != 0)
    return reporter_.state(PrintState::kWaiting, "Press the button at the printer");
  const std::string_view current = current_action();
  if (state == BuildState::kRunning && !current.empty() && waits_for_heat(current))
    reporter_.state(PrintState::kHeating, heating_text(current));
  else
    reporter_.state(PrintState::kPrinting);
}

// The one that left the buffer last; empty where that is not known.
std::string_view Print::current_action() {
  const auto waiting = buffer_.actions(channel_.free_buffer());
  if (!waiting || *waiting >= accepted_) return {};
  return (*actions_)[accepted_ - *waiting - 1];
}

std::string Print::heating_text(std::string_view action) {
  const auto tool = static_cast<std::uint8_t>(action[1]);
  const bool platform = code_of(action) == kWaitForPlatform;
  const int now = channel_.temperature(tool, platform ? 0x1E : 0x02);
  const int target = channel_.temperature(tool, platform ? 0x21 : 0x20);
  return (platform ? "platform " : "tool ") + std::to_string(now) + " of " +
         std::to_string(target) + " °C";
}

// Those that the program waits for; no others need exist.
void Print::note_heaters() {
  for (const std::string_view action : *actions_) {
    if (code_of(action) == kWaitForTool) tools_.insert(static_cast<std::uint8_t>(action[1]));
    if (code_of(action) == kWaitForPlatform) heats_platform_ = true;
  }
}

void Print::tell_heaters() {
  constexpr double kInterval_s = 5;
  if (channel_.now_s() - heaters_at_s_ < kInterval_s) return;
  heaters_at_s_ = channel_.now_s();
  std::vector<HeaterReport> heaters;
  const auto add = [&](std::string name, std::uint8_t tool, std::uint8_t actual,
                       std::uint8_t target) {
    heaters.push_back({std::move(name), static_cast<double>(channel_.temperature(tool, actual)),
                       static_cast<double>(channel_.temperature(tool, target))});
  };
  for (const std::uint8_t tool : tools_)
    add(tools_.size() == 1 ? "tool" : "tool " + std::to_string(tool), tool, 0x02, 0x20);
  if (heats_platform_) add("bed", 0, 0x1E, 0x21);
  reporter_.heaters(std::move(heaters));
}

}  // namespace packmerger::s3g
