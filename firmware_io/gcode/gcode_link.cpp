#include "firmware_io/gcode/gcode_link.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"
#include "firmware_io/conversation.h"
#include "firmware_io/gcode/ascii.h"
#include "firmware_io/gcode/gcode.h"
#include "firmware_io/gcode/gcode_channel.h"
#include "firmware_io/gcode/gcode_script.h"
#include "firmware_io/gcode/gcode_stream.h"
#include "firmware_io/gcode/gcode_time_marks.h"
#include "gcode/gcode_line.h"

namespace packmerger {

namespace {

void refuse_unanswerable_pauses(const GcodeCommands& commands, const GcodeAbilities& abilities) {
  if (abilities.prompts) return;
  for (const GcodeCommand& command : commands)
    if (waits_for_user(command.text))
      throw Error(Fault::kUnavailable,
                  "Line " + std::to_string(command.line) +
                      " of the program waits for a person, and this printer cannot ask one",
                  "Remove M0 and M1 from the program, or enable host prompts in the firmware.");
}

constexpr const char* kReportNothing = "M155 S0";

// Of the safe text: without numbers no sum protects it, and noise is what many prints fail by.
std::string what_turns_heaters_off(const std::string& text) {
  std::string lines;
  for (const GcodeCommand& command : gcode_commands(text)) {
    const GcodeLine line(command.text, GcodeRules::kMarlin);
    const bool is_heater = line.is('M', 104) || line.is('M', 140) || line.is('M', 141);
    if (is_heater && line.value('S') == 0.0) lines += std::string(command.text) + "\n";
  }
  return lines;
}

enum class Heard { kAnswer, kRequest, kReset };

// Waits a second for the answer to a line. refusal: the first "!!" that came.
Heard say(GcodeChannel& channel, std::string_view line, std::string& refusal) {
  constexpr double kPatience_s = 1;
  Heard heard = Heard::kAnswer;
  channel.send(line);
  const double end = channel.now_s() + kPatience_s;
  while (channel.now_s() < end) {
    const auto reply = channel.receive(end - channel.now_s());
    if (!reply || reply->kind == GcodeReplyKind::kOk) break;
    if (reply->kind == GcodeReplyKind::kStart) return Heard::kReset;
    if (reply->kind == GcodeReplyKind::kResend) heard = Heard::kRequest;
    if (reply->text.starts_with("!!") && refusal.empty()) refusal = reply->text;
  }
  return heard;
}

// For a printer that takes no line without a number any more.
void send_numbered(GcodeChannel& channel, const std::string& text, std::string& refusal) {
  constexpr int kTries = 3;
  std::size_t number = 0;
  say(channel, numbered_line(number, "M110 N0"), refusal);
  for (const GcodeCommand& command : gcode_commands(text)) {
    const std::string line = numbered_line(++number, command.text);
    for (int i = 0; i < kTries; ++i) {
      const Heard heard = say(channel, line, refusal);
      if (heard == Heard::kReset) return;
      if (heard == Heard::kAnswer) break;
    }
  }
}

// Behind a print, and after a failure the line count is unknown, so these go without numbers; no
// answer is insisted on. Repetier's firmware may ask for a numbered line instead: it gets all of
// them so, behind a count of its own. A printer that says it has stopped may still obey; one that
// is dead is not harmed. Returns the first "!!" of the answers: Klipper names the cause of its
// shutdown only to the commands that it refuses.
std::string send_text(GcodeChannel& channel, const std::string& text) {
  std::string refusal;
  try {
    for (const GcodeCommand& command : gcode_commands(text)) {
      const Heard heard = say(channel, command.text, refusal);
      if (heard == Heard::kRequest) send_numbered(channel, text, refusal);
      if (heard != Heard::kAnswer) break;
    }
  } catch (const Error&) {
    // The port is gone; the failure that led here is what the user must read.
  }
  return refusal;
}

}  // namespace

void check_gcode(std::string_view program) { check_gcode_commands(gcode_commands(program)); }

void print_gcode(Port& port, std::string_view program, const StreamOptions& options,
                 const PrintListener& listener, PrintControl& control) {
  const GcodeCommands commands = gcode_commands(program);
  check_gcode_commands(commands);
  GcodeScript script(program);
  Reporter reporter(port, listener, options, script.size(), RemainingTime(time_marks(commands)));
  GcodeChannel channel(port);
  const GcodeAbilities abilities = connect_gcode(channel, options, control);
  refuse_unanswerable_pauses(commands, abilities);

  const std::string silence = abilities.autoreport ? kReportNothing : "";
  const std::string safe =
      options.safe_gcode + "\n" + what_turns_heaters_off(options.safe_gcode) + silence;
  GcodeStream stream(channel, std::move(script), options, abilities, reporter, control);
  try {
    stream.run();
  } catch (const Error& error) {
    if (!stream.may_send()) throw;
    const std::string refusal = send_text(channel, safe);
    if (stream.was_cancelled() && error.fault() == Fault::kIo)
      throw_failed_cancel(error, stream.was_cancelled_at_printer());
    if (refusal.empty() || ascii::has(error.what(), refusal)) throw;
    throw Error(error.fault(), std::string(error.what()) + "; then it said: " + refusal,
                error.hint());
  } catch (...) {
    send_text(channel, safe);
    throw;
  }
  send_text(channel, silence);
  if (stream.was_cancelled_at_printer())
    throw Error(Fault::kIo, "The print was cancelled at the printer",
                "Clear the bed and print the job again.");
  if (stream.was_cancelled()) throw Error(Fault::kInterrupted, "The print was cancelled", "");
  reporter.state(PrintState::kDone);
}

}  // namespace packmerger
