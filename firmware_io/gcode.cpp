#include "firmware_io/gcode.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

#include "base/error.h"

namespace packmerger {

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

bool starts_with_any_case(std::string_view text, std::string_view prefix) {
  return text.size() >= prefix.size() &&
         std::equal(prefix.begin(), prefix.end(), text.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) ==
                  std::tolower(static_cast<unsigned char>(b));
         });
}

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

template <std::size_t N>
bool one_of(std::string_view word, const std::array<std::string_view, N>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

[[noreturn]] void refuse(const GcodeCommand& command, const std::string& why,
                         const std::string& hint) {
  throw Error(Fault::kBadInput, "Line " + std::to_string(command.line) + " of the program " + why,
              hint);
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

// What Marlin prints when it stops for good, and OctoPrint's list of errors that mean it will.
bool tells_halt(std::string_view line) {
  return has(line, "halted") || has(line, "kill() called") || has(line, "KILL caused") ||
         has(line, "Watchdog barked");
}

bool tells_heater_failure(std::string_view line) {
  static constexpr std::array<std::string_view, 6> kTexts = {
      "Heating failed",    "Thermal Runaway",   "Thermal Malfunction",
      "MAXTEMP triggered", "MINTEMP triggered", "Invalid extruder number"};
  return std::any_of(kTexts.begin(), kTexts.end(),
                     [&](std::string_view text) { return has(line, text); });
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

bool is_ok(std::string_view line) {
  return line.starts_with("ok") &&
         (line.size() == 2 || !std::isalnum(static_cast<unsigned char>(line[2])));
}

void read_ok(std::string_view line, GcodeReply& reply) {
  reply.kind = GcodeReplyKind::kOk;
  reply.has_temperature = has(line, " T:") || has(line, " T0:") || has(line, " B:");
  reply.has_position = has(line, "X:") && has(line, "Y:");
  reply.has_firmware = has(line, "FIRMWARE_NAME:");
}

// Lines that begin with a word of their own; false where none does.
bool read_by_prefix(std::string_view line, GcodeReply& reply) {
  if (starts_with_any_case(line, "resend") || starts_with_any_case(line, "rs ")) {
    reply.kind = GcodeReplyKind::kResend;
    reply.number = first_number(line);
  } else if (line.starts_with("echo:busy:") || line.starts_with("busy:")) {
    reply.kind = GcodeReplyKind::kBusy;
    reply.waiting = has(line, "paused for");
  } else if (line == "wait") {
    reply.kind = GcodeReplyKind::kIdle;
  } else if (line.starts_with("//action:prompt_begin")) {
    reply.kind = GcodeReplyKind::kPrompt;
    reply.text = trim(line.substr(21));
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

std::vector<GcodeCommand> gcode_commands(std::string_view program) {
  std::vector<GcodeCommand> commands;
  std::size_t line = 0;
  while (!program.empty()) {
    const std::size_t end = std::min(program.find('\n'), program.size());
    std::string_view text = program.substr(0, end);
    program.remove_prefix(std::min(end + 1, program.size()));
    ++line;
    text = trim(text.substr(0, text.find(';')));
    if (!text.empty()) commands.push_back({text, line});
  }
  return commands;
}

void check_gcode_commands(const std::vector<GcodeCommand>& commands) {
  if (commands.empty())
    throw Error(Fault::kBadInput, "The program has no command", "Prepare the model again.");
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const GcodeCommand& command = commands[i];
    for (char c : command.text)
      if ((c < ' ' || c > '~') && c != '\t')
        refuse(command, "holds a byte that is not plain ASCII",
               "Remove accented letters and control characters outside comments.");
    if ((command.text[0] == 'N' || command.text[0] == 'n') && command.text.size() > 1 &&
        is_digit(command.text[1]))
      refuse(command, "is numbered already", "Give a program without line numbers and checksums.");
    // Marlin looks for these four characters anywhere in a numbered line.
    if (has(command.text, "M110"))
      refuse(command, "holds M110, which would change the printer's line count",
             "Remove it: PackMerger numbers the lines itself.");
    if (numbered_gcode(i + 1, command.text).size() - 1 > kMaxGcodeLine)
      refuse(command, "is too long for the printer's serial line",
             "Shorten it: with number and checksum a line may have " +
                 std::to_string(kMaxGcodeLine) + " characters.");
  }
}

std::string numbered_gcode(std::size_t number, std::string_view command) {
  std::string line = "N" + std::to_string(number) + " ";
  line += command;
  std::uint8_t checksum = 0;
  for (char c : line) checksum = static_cast<std::uint8_t>(checksum ^ static_cast<std::uint8_t>(c));
  line += '*';
  line += std::to_string(checksum);
  line += '\n';
  return line;
}

std::string_view gcode_word(std::string_view command) {
  std::size_t end = std::min<std::size_t>(1, command.size());
  while (end < command.size() && (is_digit(command[end]) || command[end] == '.')) ++end;
  return command.substr(0, end);
}

bool is_heating(std::string_view command) {
  static constexpr std::array<std::string_view, 4> kWords = {"M109", "M190", "M191", "M303"};
  return one_of(gcode_word(command), kWords);
}

bool is_long(std::string_view command) {
  static constexpr std::array<std::string_view, 12> kWords = {
      "G4", "G28", "G29", "G30", "G32", "M0", "M1", "M400", "M226", "M600", "M109", "M190"};
  return one_of(gcode_word(command), kWords);
}

bool waits_for_user(std::string_view command) {
  const std::string_view word = gcode_word(command);
  if (word != "M0" && word != "M1") return false;
  const std::string_view rest = trim(command.substr(word.size()));
  const bool timed = rest.size() > 1 && (rest[0] == 'P' || rest[0] == 'S') && is_digit(rest[1]);
  return !timed;
}

GcodeReply read_gcode_reply(std::string_view line) {
  const std::string_view text = trim(line);
  GcodeReply reply;
  reply.text = text;
  if (is_ok(text)) {
    read_ok(text, reply);
  } else if (starts_with_any_case(text, "error") || text.starts_with("!!")) {
    if (tells_heater_failure(text))
      reply.kind = GcodeReplyKind::kThermal;
    else if (tells_halt(text) || text.starts_with("!!"))
      reply.kind = GcodeReplyKind::kHalted;
  } else if (tells_reset(text)) {
    reply.kind = GcodeReplyKind::kStart;
  } else if (is_temperature(text)) {
    reply.kind = GcodeReplyKind::kTemperature;
  } else if (is_position(text)) {
    reply.kind = GcodeReplyKind::kPosition;
  } else {
    read_by_prefix(text, reply);
  }
  return reply;
}

}  // namespace packmerger
