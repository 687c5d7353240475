// The simulated Marlin's machine: its commands, moves and heaters.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>

#include "firmware_io/simulated/marlin.h"

namespace packmerger::simulated {

namespace {

constexpr double kHoming_s = 5;
constexpr double kMacro_s = 8;

// The value of a parameter: of 'X' in "G1 X10 Y2", 10.
std::optional<double> value(const std::string& command, char letter) {
  for (std::size_t i = 1; i + 1 < command.size(); ++i)
    if (command[i] == letter && command[i - 1] == ' ')
      return std::strtod(command.c_str() + i + 1, nullptr);
  return std::nullopt;
}

}  // namespace

std::string Marlin::temperatures(double now_s) const {
  char text[96];
  std::snprintf(text, sizeof text, " T:%.2f /%.2f B:%.2f /%.2f @:0 B@:0",
                tool_.temperature(now_s, pace_), tool_.target(), bed_.temperature(now_s, pace_),
                bed_.target());
  return text;
}

std::string Marlin::position() const {
  char text[128];
  std::snprintf(text, sizeof text, "X:%.2f Y:%.2f Z:%.2f E:%.2f Count X:0 Y:0 Z:0", position_[0],
                position_[1], position_[2], position_[3]);
  return text;
}

void Marlin::plan(double seconds, double now_s) {
  const double start = planned_ends_s_.empty() ? now_s : planned_ends_s_.back();
  planned_ends_s_.push_back(start + pace_.machine_s(seconds));
}

void Marlin::execute(const std::string& command, double now_s) {
  block(Blocked::kNo, now_s);
  if (command.empty()) return;
  executed_.push_back(command);
  if (!is_injected_) count_line(now_s);
  if (is(command, "M600") && traits_.filament_change) return change_filament(now_s);
  if (is(command, "M600")) return say_unknown(command);
  if (execute_move(command, now_s)) return;
  if (is(command, "M104") || is(command, "M109"))
    tool_.set_target(value(command, 'S').value_or(value(command, 'R').value_or(0)), now_s);
  if (is(command, "M140") || is(command, "M190"))
    bed_.set_target(value(command, 'S').value_or(value(command, 'R').value_or(0)), now_s);
  if (is(command, "M109")) block(Blocked::kTool, now_s, tool_.ready_s(now_s, pace_));
  if (is(command, "M190")) block(Blocked::kBed, now_s, bed_.ready_s(now_s, pace_));
  if (is(command, "M0") || is(command, "M1")) execute_pause(command, now_s);
  if (const auto number = value(command, 'N'); number && is(command, "M110"))
    last_number_ = std::lround(*number);
  if (is(command, "M999")) stopped_ = false;
  if (is(command, "M112")) kill("kill() called!");
  if (is(command, "M410")) planned_ends_s_.clear();
  execute_report(command, now_s);
  const char letter = command[0];
  if (letter == 'G' || letter == 'M' || letter == 'T') return;
  const bool is_word = command.size() > 1 && std::isalpha(static_cast<unsigned char>(command[1]));
  if (traits_.macros && is_word)
    block(Blocked::kUntil, now_s, now_s + pace_.machine_s(kMacro_s));
  else
    say_unknown(command);
}

// Everything that moves or waits for moves. False for another command.
bool Marlin::execute_move(const std::string& command, double now_s) {
  if (is(command, "G90")) relative_ = relative_e_ = false;
  if (is(command, "G91")) relative_ = relative_e_ = true;
  if (is(command, "M82")) relative_e_ = false;
  if (is(command, "M83")) relative_e_ = true;
  const bool sets = is(command, "G92");
  const bool moves = is(command, "G0") || is(command, "G1");
  if (moves && stopped_) {
    say("Printer stopped due to errors. Fix the error and use M999 to restart. (Temperature is "
        "reset. Set it after restarting)");
    return true;
  }
  if (moves && std::exchange(refuses_move_, false)) {
    say("!! Move out of range: 500.000 0.000 5.000 [0.000]");
    return true;
  }
  if (sets || moves) {
    double squared_mm = 0;
    double extruded_mm = 0;
    constexpr std::array<char, 4> kAxes = {'X', 'Y', 'Z', 'E'};
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      const auto to = value(command, kAxes[i]);
      if (!to) continue;
      const bool relative = moves && (i < 3 ? relative_ : relative_e_);
      const double target = relative ? position_[i] + *to : *to;
      (i < 3 ? squared_mm : extruded_mm) +=
          i < 3 ? std::pow(target - position_[i], 2) : std::abs(target - position_[i]);
      if (i < 3 || !relative || traits_.counts_relative_e) position_[i] = target;
    }
    if (!moves) return true;
    if (const auto feed = value(command, 'F'); feed && *feed > 0) feed_mm_s_ = *feed / 60;
    const double way_mm = squared_mm > 0 ? std::sqrt(squared_mm) : extruded_mm;
    if (way_mm > 0) plan(way_mm / feed_mm_s_, now_s);
    block(Blocked::kPlannerFull, now_s);
    return true;
  }
  if (is(command, "G28")) {
    position_[0] = position_[1] = position_[2] = 0;
    says_position_ = true;
    block(Blocked::kUntil, now_s, now_s + pace_.machine_s(kHoming_s));
    return true;
  }
  if (is(command, "G4")) {
    const double seconds = value(command, 'S').value_or(value(command, 'P').value_or(0) / 1000);
    block(Blocked::kUntil, now_s, now_s + pace_.machine_s(seconds));
    return true;
  }
  if (is(command, "M400")) {
    block(Blocked::kPlannerEmpty, now_s);
    return true;
  }
  return false;
}

void Marlin::execute_report(const std::string& command, double now_s) {
  if (is(command, "M105")) reply_ = "ok" + temperatures(now_s);
  if (is(command, "M155") && traits_.autoreport)
    report_every(value(command, 'S').value_or(0), now_s);
  if (is(command, "M27")) say("Not SD printing");
  if (is(command, "M154")) {
    positions_every_s_ = value(command, 'S').value_or(0);
    next_position_s_ = positions_every_s_ > 0 ? now_s + pace_.line_s(positions_every_s_) : kNever;
  }
  if (is(command, "M113")) busy_every_s_ = std::max(value(command, 'S').value_or(2), 1.0);
  if (is(command, "M114")) say(position());
  if (is(command, "M115")) {
    say("FIRMWARE_NAME:Marlin " + traits_.version +
        " (simulated) PROTOCOL_VERSION:1.0 MACHINE_TYPE:PackMerger EXTRUDER_COUNT:1");
    say(std::string("Cap:AUTOREPORT_TEMP:") + (traits_.autoreport ? "1" : "0"));
    say(std::string("Cap:PROMPT_SUPPORT:") + (traits_.prompts ? "1" : "0"));
    say(std::string("Cap:EMERGENCY_PARSER:") + (traits_.emergency_parser ? "1" : "0"));
  }
}

void Marlin::say_unknown(const std::string& command) {
  if (traits_.comment_blank)
    say("// Unknown command:\"" + command.substr(0, command.find(' ')) + "\"");
  else
    say("echo:Unknown command: \"" + command + "\"");
}

void Marlin::ask(const std::string& question, const std::vector<std::string>& choices) {
  if (!traits_.prompts) return;
  say("//action:prompt_end");
  say("//action:prompt_begin " + question);
  for (const std::string& choice : choices) say("//action:prompt_button " + choice);
  say("//action:prompt_show");
}

void Marlin::execute_pause(const std::string& command, double now_s) {
  if (const auto seconds = value(command, 'S'))
    return block(Blocked::kUntil, now_s, now_s + pace_.machine_s(*seconds));
  const std::string text = command.size() > 3 ? command.substr(3) : "Click to resume";
  say("echo:" + text + (traits_.crlf ? "\r" : ""));
  ask(text, {"Continue"});
  block(Blocked::kUser, now_s);
}

// The first question stands until it is answered by M876 or M108; the second asks for more to be
// purged (0) or to go on (1), which only M876 answers.
void Marlin::change_filament(double now_s) {
  ask("Nozzle Parked", {"Continue"});
  block(Blocked::kUser, now_s);
  asks_again_ = true;
}

}  // namespace packmerger::simulated
