// What a printer's reply to a line of G-code means.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>

#include "firmware_io/gcode/ascii.h"
#include "firmware_io/gcode/gcode.h"

namespace packmerger {

namespace {

using ascii::has;
using ascii::is_digit;
using ascii::one_of;
using ascii::trim;

bool starts_with_any_case(std::string_view text, std::string_view prefix) {
  return text.size() >= prefix.size() &&
         std::equal(prefix.begin(), prefix.end(), text.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) ==
                  std::tolower(static_cast<unsigned char>(b));
         });
}

// The number after "Resend:", which firmwares write "Resend: 3", "Resend:3", "rs 3", "rs N3" or
// "Resend: N:3"; 0 where there is none.
std::size_t first_number(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size() && !is_digit(text[i])) ++i;
  std::size_t number = 0;
  for (; i < text.size() && is_digit(text[i]) && number < 100'000'000; ++i)
    number = number * 10 + static_cast<std::size_t>(text[i] - '0');
  return number;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

template <std::size_t N>
bool has_any(const std::string& line, const std::array<std::string_view, N>& texts) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](std::string_view text) { return has(line, text); });
}

// In an error line, in small letters: the firmwares' own words for having stopped, or for a print
// that goes on without heat. M999 starts a stopped Marlin, Repetier or Smoothieware again. Who says
// what is in docs/PROTOCOLS.
bool tells_stop(const std::string& line) {
  static constexpr std::array<std::string_view, 9> kTexts = {
      "halted",          "stopped", "stop called", "kill() called", "kill caused",
      "watchdog barked", "m999",    "shutdown",    "dry run mode"};
  return has_any(line, kTexts);
}

bool tells_heater_failure(const std::string& line) {
  static constexpr std::array<std::string_view, 10> kTexts = {
      "heating failed",      "thermal runaway",         "thermal malfunction", "maxtemp triggered",
      "mintemp triggered",   "invalid extruder number", "heater decoupled",    "seems decoupled",
      "heater/sensor error", "temp sensor defect"};
  // RepRapFirmware: "Heater 1 fault: ...", "Heating fault on heater 1, ...".
  return has_any(line, kTexts) || (has(line, "heater") && has(line, " fault"));
}

// What a stopped printer says without the mark of an error: Marlin to every move that it refuses,
// old ones of their heaters, Klipper once, the moment that it shuts down or restarts, Smoothieware
// behind its cause, Repetier of each heater. What Klipper is busy with is never answered then.
// Messages of the program (M117, M118) begin with "echo:" or "//" where they are told at all.
bool tells_stop_plainly(std::string_view line) {
  static constexpr std::array<std::string_view, 4> kBeginnings = {
      "Printer stopped due to errors", "echo:Printer stopped due to errors",
      "// Klipper state: Shutdown", "// Klipper state: Disconnect"};
  static constexpr std::array<std::string_view, 5> kTexts = {
      "disabling all heaters", ": temp sensor defect", "temp triggered", "reset or m999",
      "m999 or $x"};
  if (std::any_of(kBeginnings.begin(), kBeginnings.end(),
                  [&](std::string_view text) { return line.starts_with(text); }))
    return true;
  return !line.starts_with("echo:") && !line.starts_with("//") && has_any(lower(line), kTexts);
}

// Lines that say that something is wrong; false for others.
bool read_error(std::string_view line, GcodeReply& reply) {
  const bool refused = line.starts_with("!!");
  const bool fatal = starts_with_any_case(line, "fatal:") || tells_stop_plainly(line);
  if (!refused && !fatal && !starts_with_any_case(line, "error")) return false;
  const std::string words = lower(line);
  reply.heater_failed = tells_heater_failure(words);
  reply.kind = fatal || reply.heater_failed || tells_stop(words) ? GcodeReplyKind::kStopped
               : refused                                         ? GcodeReplyKind::kRefused
                                                                 : GcodeReplyKind::kError;
  return true;
}

// `// Unknown command:"M600"`, `echo:Unknown command: "M600 U5"`.
bool read_unknown(std::string_view line, GcodeReply& reply) {
  constexpr std::string_view kUnknown = "unknown command:";
  if (line.starts_with("//")) line = trim(line.substr(2));
  if (line.starts_with("echo:")) line = trim(line.substr(5));
  if (!starts_with_any_case(line, kUnknown)) return false;
  std::string_view command = trim(line.substr(kUnknown.size()));
  if (command.starts_with('"')) command.remove_prefix(1);
  reply.kind = GcodeReplyKind::kUnknown;
  reply.text = gcode_word(command);
  return true;
}

// The cause of a reset, which Marlin prints right after "start".
bool tells_reset(std::string_view line) {
  static constexpr std::array<std::string_view, 5> kTexts = {
      "PowerUp", "External Reset", "Brown out Reset", "Watchdog Reset", "Software Reset"};
  if (line == "start") return true;
  if (!line.starts_with("echo:")) return false;
  const std::string_view text = trim(line.substr(5));
  return one_of(text, kTexts);
}

bool is_temperature(std::string_view line) {
  return line.starts_with("T:") || line.starts_with("T0:") || line.starts_with("B:");
}

bool is_position(std::string_view line) { return line.starts_with("X:") && has(line, "Y:"); }

// A number at the front, taken away; false where there is none.
bool take_number(std::string_view& text, double& number) {
  text = trim(text);
  std::size_t end = 0;
  while (end < text.size() && (is_digit(text[end]) || text[end] == '.' || text[end] == '-')) ++end;
  if (end == 0) return false;
  number = std::strtod(std::string(text.substr(0, end)).c_str(), nullptr);
  text.remove_prefix(end);
  return true;
}

// "T", "T0", "B", "C": the name of a heater for people; empty for another word.
std::string heater_name(std::string_view word) {
  if (word == "T") return "tool";
  if (word == "B") return "bed";
  if (word == "C") return "chamber";
  if (word.size() == 2 && word[0] == 'T' && is_digit(word[1]))
    return "tool " + std::string(1, word[1]);
  return "";
}

// " T:21.87 /0.00 B:21.87 /0.00 T0:… @:0 B@:0": where the tools are numbered, T is one of them.
std::vector<HeaterReport> read_heaters(std::string_view line) {
  std::vector<HeaterReport> heaters;
  bool numbered = false;
  for (std::size_t at = line.find(':'); at != std::string_view::npos; at = line.find(':', at + 1)) {
    const std::size_t begin = line.find_last_of(" \t", at) + 1;
    HeaterReport heater{heater_name(line.substr(begin, at - begin)), 0, {}};
    std::string_view rest = line.substr(at + 1);
    if (heater.name.empty() || !take_number(rest, heater.actual_c)) continue;
    rest = trim(rest);
    double target_c = 0;
    if (rest.starts_with('/') && take_number(rest = rest.substr(1), target_c))
      heater.target_c = target_c;
    numbered = numbered || heater.name.starts_with("tool ");
    heaters.push_back(std::move(heater));
  }
  if (numbered) std::erase_if(heaters, [](const HeaterReport& h) { return h.name == "tool"; });
  return heaters;
}

bool is_ok(std::string_view line) {
  return line.starts_with("ok") &&
         (line.size() == 2 || !std::isalnum(static_cast<unsigned char>(line[2])));
}

void read_ok(std::string_view line, GcodeReply& reply) {
  reply.kind = GcodeReplyKind::kOk;
  // An M114 on one line may count steps by letters that are heaters' too.
  reply.has_position = has(line, "X:") && has(line, "Y:");
  reply.has_temperature =
      !reply.has_position && (has(line, " T:") || has(line, " T0:") || has(line, " B:"));
  if (reply.has_temperature) reply.heaters = read_heaters(line);
  if (line.starts_with("ok N")) reply.number = first_number(line);
  reply.has_firmware = has(line, "FIRMWARE_NAME:");
}

// What the printer asks of its host.
void read_action(std::string_view action, GcodeReply& reply) {
  constexpr std::string_view kBegin = "prompt_begin";
  constexpr std::array<std::string_view, 2> kButtons = {"prompt_button", "prompt_choice"};
  const std::string_view word = action.substr(0, action.find(' '));
  reply.text = trim(action.substr(word.size()));
  if (word == kBegin) reply.kind = GcodeReplyKind::kPrompt;
  if (word == "prompt_end") reply.kind = GcodeReplyKind::kPromptEnd;
  if (one_of(word, kButtons)) reply.kind = GcodeReplyKind::kPromptButton;
  if (word == "pause" || word == "paused") reply.kind = GcodeReplyKind::kPause;
  if (word == "resume" || word == "resumed") reply.kind = GcodeReplyKind::kResume;
  if (word == "cancel") reply.kind = GcodeReplyKind::kCancel;
  reply.waiting = word == "paused";
}

// Lines that begin with a word of their own; false where none does.
bool read_by_prefix(std::string_view line, GcodeReply& reply) {
  constexpr std::string_view kAction = "action:";  // some firmwares write a blank before it
  if (starts_with_any_case(line, "resend") || starts_with_any_case(line, "rs ")) {
    reply.kind = GcodeReplyKind::kResend;
    reply.number = first_number(line);
  } else if (line.starts_with("echo:busy:") || line.starts_with("busy:")) {
    reply.kind = GcodeReplyKind::kBusy;
    reply.waiting = has(line, "paused for");
  } else if (line == "wait") {
    reply.kind = GcodeReplyKind::kIdle;
  } else if (line.starts_with("//") && trim(line.substr(2)).starts_with(kAction)) {
    read_action(trim(line.substr(2)).substr(kAction.size()), reply);
  } else if (line == "RequestPause:" || line == "RequestContinue:" || line == "RequestStop:") {
    // Repetier's own words for pause, resume and cancel.
    reply.kind = line == "RequestPause:"  ? GcodeReplyKind::kPause
                 : line == "RequestStop:" ? GcodeReplyKind::kCancel
                                          : GcodeReplyKind::kResume;
  } else if (line.starts_with("Cap:")) {
    reply.kind = GcodeReplyKind::kCapability;
    reply.text = line.substr(4);
  } else if (has(line, "FIRMWARE_NAME:")) {
    reply.kind = GcodeReplyKind::kFirmware;
  } else if (has(line, "SD printing")) {
    reply.kind = GcodeReplyKind::kCard;
    reply.waiting = line.starts_with("SD printing byte");
  } else {
    return false;
  }
  return true;
}

}  // namespace

GcodeReply read_gcode_reply(std::string_view line) {
  const std::string_view text = trim(line);
  GcodeReply reply;
  reply.text = text;
  if (is_ok(text)) {
    read_ok(text, reply);
  } else if (read_error(text, reply) || read_unknown(text, reply)) {
    return reply;
  } else if (tells_reset(text)) {
    reply.kind = GcodeReplyKind::kStart;
  } else if (is_temperature(text)) {
    reply.kind = GcodeReplyKind::kTemperature;
    reply.heaters = read_heaters(text);
  } else if (is_position(text)) {
    reply.kind = GcodeReplyKind::kPosition;
  } else {
    read_by_prefix(text, reply);
  }
  return reply;
}

}  // namespace packmerger
