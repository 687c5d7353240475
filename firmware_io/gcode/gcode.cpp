#include "firmware_io/gcode/gcode.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "base/error.h"
#include "firmware_io/gcode/ascii.h"
#include "gcode/gcode_line.h"

namespace packmerger {

namespace {

using ascii::has;
using ascii::is_digit;
using ascii::one_of;
using ascii::trim;

[[noreturn]] void refuse(const GcodeCommand& command, const std::string& why,
                         const std::string& hint) {
  throw Error(Fault::kBadInput, "Line " + std::to_string(command.line) + " of the program " + why,
              hint);
}

}  // namespace

GcodeCommands::Iterator& GcodeCommands::Iterator::operator++() {
  command_ = {};
  while (!rest_.empty() && command_.text.empty()) {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    text = trim(text.substr(0, text.find(';')));
    if (!text.empty()) command_ = {text, line_};
  }
  return *this;
}

std::size_t GcodeCommands::count() const {
  std::size_t count = 0;
  for (Iterator i = begin(); i != end(); ++i) ++count;
  return count;
}

void check_gcode_commands(const GcodeCommands& commands) {
  bool is_empty = true;
  for (const GcodeCommand& command : commands) {
    is_empty = false;
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
    if (command.text.size() > kMaxGcodeCommand)
      refuse(command, "is too long for the printer's serial line",
             "Shorten it to " + std::to_string(kMaxGcodeCommand) +
                 " characters: number and checksum are added to it.");
  }
  if (is_empty)
    throw Error(Fault::kBadInput, "The program has no command", "Prepare the model again.");
}

std::string numbered_line(std::size_t number, std::string_view command) {
  std::string line = "N" + std::to_string(number) + " ";
  line += command;
  std::uint8_t checksum = 0;
  for (char c : line) checksum = static_cast<std::uint8_t>(checksum ^ static_cast<std::uint8_t>(c));
  line += '*';
  line += std::to_string(checksum);
  return line;
}

std::string numbered_gcode(std::size_t number, std::string_view command) {
  return numbered_line(number, command) + '\n';
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
  static constexpr std::array<std::string_view, 13> kWords = {
      "G4", "G28", "G29", "G30", "G32", "M0", "M1", "M400", "M226", "M600", "M601", "M109", "M190"};
  const std::string_view word = gcode_word(command);
  return is_macro(command) || one_of(word, kWords);
}

bool is_macro(std::string_view command) { return gcode_word(command).size() < 2; }

bool blocks(std::string_view command) { return is_heating(command) || is_long(command); }

double dwell_s(std::string_view command) {
  constexpr double kLongest_s = 86400;
  const GcodeLine line(command, GcodeRules::kMarlin);
  if (!line.is('G', 4) && !line.is('M', 0) && !line.is('M', 1)) return 0;
  const double seconds = line.value('S').value_or(line.value('P').value_or(0) / 1000);
  return seconds > 0 ? std::min(seconds, kLongest_s) : 0;
}

bool tells_position(std::string_view command) {
  static constexpr std::array<std::string_view, 8> kWords = {"M114", "G28", "G29",  "G30",
                                                             "G33",  "G34", "M206", "M428"};
  return one_of(gcode_word(command), kWords);
}

Omission omission_of(std::string_view word) {
  static constexpr std::array<std::string_view, 5> kOfPerson = {"M0", "M1", "M226", "M600", "M601"};
  static constexpr std::array<std::string_view, 18> kOfPrint = {
      "G0",  "G1",  "G2",  "G3",   "G5",   "G20",  "G28",  "G90",  "G91",
      "G92", "M82", "M83", "M104", "M109", "M140", "M190", "M141", "M191"};
  if (one_of(word, kOfPerson)) return Omission::kOfPerson;
  // A printer with one tool may know no tools at all.
  const bool other_tool = word.starts_with('T') && word != "T0";
  return other_tool || one_of(word, kOfPrint) ? Omission::kOfPrint : Omission::kMinor;
}

bool waits_for_user(std::string_view command) {
  const std::string_view word = gcode_word(command);
  if (word != "M0" && word != "M1") return false;
  const std::string_view rest = trim(command.substr(word.size()));
  const bool timed = rest.size() > 1 && (rest[0] == 'P' || rest[0] == 'S') && is_digit(rest[1]);
  return !timed;
}

}  // namespace packmerger
