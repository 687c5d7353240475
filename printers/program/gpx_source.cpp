#include "printers/program/gpx_source.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include <fmt/format.h>

#include "gcode/gcode_motion.h"
#include "gcode/known_codes.h"
#include "printers/program/gpx_flavour.h"

namespace packmerger {
namespace {

constexpr double kDeviationMm = 0.01;
constexpr std::size_t kLongestShown = 80;
constexpr std::array<char, 3> kAxes{'X', 'Y', 'Z'};

// Neither heat nor move anything: a Replicator has nothing like them, or answers nobody.
constexpr std::array<int, 22> kNeedless{31,  75,  76,  77,  78,  105, 110, 111, 113, 114, 115,
                                        117, 118, 155, 201, 203, 204, 205, 400, 486, 862, 900};
// What gpx may read in a comment; the others are machines, heats and pauses.
constexpr std::array<std::string_view, 8> kIdleMacros{
    "flavor",         "body",           "header", "footer", "open_start_gcode", "close_start_gcode",
    "open_end_gcode", "close_end_gcode"};

bool is_needless(int number) {
  return std::find(kNeedless.begin(), kNeedless.end(), number) != kNeedless.end();
}

class Writer {
 public:
  explicit Writer(Fault fault) : fault_(fault) {}

  GpxSource write(std::string_view gcode) {
    source_.makerbot_flavour = gpx_flavour(gcode, fault_) == GpxFlavour::kMakerBot;
    source_.gcode.reserve(gcode.size() + gcode.size() / 4);
    source_.gcode = "N1 G90\nN1 M82\n";
    for_each_line(gcode, [&](std::string_view text, int number) {
      text_ = text;
      number_ = number;
      take(GcodeLine(text, GcodeRules::kGpx));
      return true;
    });
    tell_what_is_left_out();
    tell_of_fan();
    return std::move(source_);
  }

 private:
  [[noreturn]] void refuse(const std::string& why, const std::string& hint) const {
    throw Error(fault_,
                fmt::format("Line {} of the program, \"{}\", {}", number_, shown_line(text_), why),
                hint);
  }
  [[noreturn]] void refuse(const std::string& why) const {
    refuse(why,
           "Let the slicer write what a Replicator knows, or convert the program yourself and "
           "give the .x3g.");
  }

  void put(std::string_view words) { source_.gcode += fmt::format("N{} {}\n", number_, words); }

  void take(const GcodeLine& line) {
    if (const auto macro = gpx_macro(text_)) check_macro(*macro);
    if (line.is_empty()) return;
    if (ended_) refuse("stands behind the end of the program (M2), and would not be printed");
    for (int axis = 0; axis < 3; ++axis) placed_before_[axis] = motion_.is_placed(axis);
    const GcodeStep step = motion_.follow(line);
    const bool plain = line.sub_number() == 0 || line.number() == 862;
    if (line.letter() == 'M' && plain && is_needless(line.number())) return leave_out(line);
    if (!line.readable() && !is_message(line)) refuse("cannot be read");
    if (step.moves) return move(line, step);
    switch (line.letter()) {
      case 'G':
        return take_g(line, step);
      case 'M':
        return take_m(line);
      case 'T':
        return pass(line);
      default:
        refuse("is no command");
    }
  }

  static bool is_message(const GcodeLine& line) { return line.is('M', 70) || line.is('M', 71); }

  void check_macro(std::string_view macro) const {
    const std::string_view name = macro.substr(0, macro.find_first_of(" \t"));
    if (std::find(kIdleMacros.begin(), kIdleMacros.end(), name) != kIdleMacros.end()) return;
    refuse("asks gpx for something in a comment, which is not converted",
           "Take the @ away, or convert the program with gpx yourself and give the .x3g.");
  }

  void leave_out(const GcodeLine& line) {
    ++left_out_[fmt::format("{}{}", line.letter(), line.number())];
  }

  // The words as they stand.
  void pass(const GcodeLine& line) { put(words(line)); }
  static std::string words(const GcodeLine& line) {
    std::string text = fmt::format("{}{}", line.letter(), line.number());
    for (char word = 'A'; word <= 'Z'; ++word) {
      if (!line.has(word)) continue;
      text += ' ';
      text += word;
      if (const auto value = line.value(word)) text += fmt::format("{:.5f}", *value);
    }
    return text;
  }

  void take_g(const GcodeLine& line, const GcodeStep& step) {
    if (step.doubt) refuse(*step.doubt);
    switch (line.number()) {
      case 4:
        if (step.time_s > 0) put(fmt::format("G4 P{:.0f}", step.time_s * 1000));
        return;
      case 28:
        return home(line);
      case 92:
        return set(line, step);
      case 130:
        return pass(line);
      case 161:
      case 162:
        if (!line.has('X') && !line.has('Y') && !line.has('Z')) refuse("names no axis to home");
        return home(line);
      default:
        return;  // a mode: what is written is absolute, and in mm
    }
  }

  void home(const GcodeLine& line) {
    std::string text = fmt::format("G{}", line.number());
    for (const char axis : kAxes)
      if (line.has(axis)) text += fmt::format(" {}", axis);
    if (const auto feed = line.value('F'))
      text += fmt::format(" F{:.3f}", *feed * motion_.unit_mm());
    put(text);
  }

  // Coordinates are the machine's own, so that shifting those that are known changes nothing.
  void set(const GcodeLine& line, const GcodeStep& step) {
    bool tells = false;
    for (int axis = 0; axis < 3; ++axis)
      tells = tells || (line.has(kAxes[axis]) && !(step.from[axis] && placed_before_[axis]));
    if (!tells) return;
    std::string text = "G92";
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> at = step.to[axis];
      if (!at && motion_.is_placed(axis))
        refuse(fmt::format("would lose where {} is, which only the machine knows", kAxes[axis]),
               "Name X, Y and Z in it, or move to a place of all three before.");
      text += fmt::format(" {}{:.5f}", kAxes[axis], at.value_or(0));
    }
    put(text + fmt::format(" A{:.5f} B{:.5f}", filament_mm_[0], filament_mm_[1]));
  }

  void move(const GcodeLine& line, const GcodeStep& step) {
    if (step.doubt) refuse(*step.doubt);
    for (int axis = 0; axis < 3; ++axis)
      if (step.named[axis] && !motion_.is_placed(axis))
        refuse(fmt::format("moves along {}, and nobody knows where that stands", kAxes[axis]),
               "Home it, then recall where home is (M132) or set it (G92).");
    const std::array<double, 2> start_mm = filament_mm_;
    const int pieces = step.arc ? step.arc->pieces(kDeviationMm) : 1;
    for (int piece = 1; piece <= pieces; ++piece) {
      const double part = static_cast<double>(piece) / pieces;
      std::string text = line.number() == 0 ? "G0" : "G1";
      for (int axis = 0; axis < 3; ++axis)
        if (const auto mm = place(step, axis, part))
          text += fmt::format(" {}{:.5f}", kAxes[axis], *mm);
      for (int tool = 0; tool < 2; ++tool) {
        filament_mm_[tool] = start_mm[tool] + part * step.by_tool_mm[tool];
        if (step.by_tool_mm[tool] != 0)
          text += fmt::format(" {}{:.5f}", "AB"[tool], filament_mm_[tool]);
      }
      if (const auto feed = line.value('F'); feed && piece == 1)
        text += fmt::format(" F{:.3f}", *feed * motion_.unit_mm());
      put(text);
    }
  }

  static std::optional<double> place(const GcodeStep& step, int axis, double part) {
    const bool on_arc = step.arc && (axis < 2 || step.named[axis]);
    if (!on_arc) return step.named[axis] ? step.to[axis] : std::nullopt;
    if (part == 1) return step.to[axis];
    if (axis < 2) return step.arc->at(part)[axis];
    const double from = step.from[axis].value_or(*step.to[axis]);
    return from + part * (*step.to[axis] - from);
  }

  void take_m(const GcodeLine& line) {
    const int number = line.number();
    switch (line.sub_number() == 0 ? number : -1) {
      case 0:
      case 1:
        refuse("waits for the user, which gpx would leave out",
               "Write M71 (a message), which a Replicator shows and waits.");
      case 2:
        ended_ = true;
        return pass(line);
      case 6:
      case 135:
        return put(line.has('T') ? words(line)
                                 : fmt::format("{} T{}", words(line), motion_.tool()));
      case 18:
      case 84:
        // gpx knows no time after which motors are let go, and would do it at once
        return line.has('S') ? leave_out(line) : pass(line);
      case 70:
      case 71:
        return message(line);
      case 73:
        if (const auto percent = line.value('P')) put(fmt::format("M73 P{:.0f}", *percent));
        return;
      case 82:
      case 83:
        return;
      case 104:
        return heat(line, kHottestNozzle);
      case 106:
      case 126:
        return turn_fan(line);
      case 109:
        return heat(line, source_.makerbot_flavour ? kHottestPlate : kHottestNozzle);
      case 108:
        if (line.has('R')) return pass(line);
        return line.has('T') ? put(fmt::format("M135 T{:.0f}", line.value_or('T', 0)))
                             : leave_out(line);
      case 132:
        for (int tool = 0; tool < 2; ++tool)
          if (line.has("AB"[tool])) filament_mm_[tool] = 0;
        return pass(line);
      case 134:
      case 140:
      case 190:
        return heat(line, kHottestPlate);
      case 220:
      case 221:
        return pass(line);
      case 420:
        // the lights; another firmware's bed levelling
        return line.has('R') || line.has('E') || line.has('B') ? pass(line) : leave_out(line);
      default:
        if (const auto doubt = cannot_follow(line, GcodeRules::kGpx)) refuse(*doubt);
        return pass(line);
    }
  }

  void heat(const GcodeLine& line, double hottest) {
    if (line.has('R')) refuse("waits for something to cool, which a Replicator does not");
    const auto heat = line.value('S');
    if (heat && (*heat < 0 || *heat > hottest))
      refuse(
          fmt::format("asks for a heat that gpx would change: it takes 0 to {:.0f} °C", hottest));
    pass(line);
  }

  // A speed below 1 is off, to gpx as to Marlin.
  void turn_fan(const GcodeLine& line) {
    constexpr double kWhole = 255;
    const auto speed = line.value('S');
    if (speed && *speed >= 1 && *speed < kWhole) {
      if (part_fans_ == 0) first_part_fan_ = number_;
      ++part_fans_;
    }
    pass(line);
  }

  // gpx takes the text from the comment.
  void message(const GcodeLine& line) {
    std::string text;
    const std::size_t start = text_.find_first_of("(;");
    if (start != std::string_view::npos)
      for (const char c : text_.substr(start + 1))
        if (c != '(' && c != ')' && c != '@' && c >= ' ' && c <= '~') text += c;
    if (text.empty() && line.is('M', 70)) refuse("shows no text: it stands in brackets");
    put(text.empty() ? words(line) : fmt::format("{} ({})", words(line), text));
  }

  void tell_what_is_left_out() {
    if (left_out_.empty()) return;
    std::string list;
    for (const auto& [name, count] : left_out_)
      list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", name, count);
    source_.warnings.push_back(
        {"left_out", "Left out of the x3g, because a Replicator has nothing like it: " + list});
  }

  void tell_of_fan() {
    if (part_fans_ == 0) return;
    source_.warnings.push_back(
        {"fan_full",
         fmt::format("Line {} of the program turns the fan on in part{}; a Replicator's fan is on "
                     "or off, and will be fully on",
                     first_part_fan_,
                     part_fans_ == 1 ? "" : fmt::format(", as do {} others", part_fans_ - 1))});
  }

  Fault fault_;
  GpxSource source_;
  GcodeMotion motion_{GcodeRules::kGpx};
  std::array<bool, 3> placed_before_{};
  std::array<double, 2> filament_mm_{};  // as it was written
  std::map<std::string, int> left_out_;
  int part_fans_ = 0;  // lines that set the fan to some speed
  int first_part_fan_ = 0;
  std::string_view text_;
  int number_ = 0;
  bool ended_ = false;
};

}  // namespace

std::optional<std::string_view> gpx_macro(std::string_view line) {
  for (std::size_t at = line.find_first_of(";("); at < line.size();
       at = line.find_first_of(";(", at)) {
    const bool bracket = line[at] == '(';
    const std::string_view comment = line.substr(at + 1);
    const std::size_t end = bracket ? comment.find(')') : std::string_view::npos;
    if (comment.size() > 1 && comment[0] == '@' &&
        std::isalpha(static_cast<unsigned char>(comment[1])) != 0)
      return comment.substr(1, end == std::string_view::npos ? end : end - 1);
    if (end == std::string_view::npos) break;
    at += end + 1;
  }
  return std::nullopt;
}

std::string shown_line(std::string_view line) { return std::string(line.substr(0, kLongestShown)); }

GpxSource gpx_source(std::string_view gcode, Fault fault) { return Writer(fault).write(gcode); }

}  // namespace packmerger
