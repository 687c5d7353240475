// Where the head is after each line given, in the words of M114, for printers that count no lines.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "gcode/gcode_line.h"

namespace packmerger {

// X, Y, Z and E in the program's own coordinates, mm; empty: not known.
using GcodePoint = std::array<std::optional<double>, 4>;

// "X:10.000 Y:20.000 Z:0.200 E:3.150 Count X:800": the first of each.
GcodePoint read_gcode_point(std::string_view report);

// What one line does to the place, and whether it may be executed twice without harm.
struct GcodeTrace {
  GcodePoint before;
  GcodePoint after;
  bool repeatable = false;
  // Where an axis may be after it, mm, as long as nobody knows how the line is read.
  std::array<std::vector<double>, 4> readings;
};

class GcodePlace {
 public:
  GcodeTrace follow(std::string_view command);
  // Somebody may have moved the head by hand.
  void forget() { at_ = {}; }
  // Where the head is behind the last line, of the axes that were not known.
  void learn(const GcodePoint& told);

  // Whether M114 behind this line tells what is not known any more since a macro: the place behind
  // the macro itself; behind a move, whether moves are relative or in inches.
  bool wants_report(std::string_view command) const;
  // What the printer tells then. trace: the line's own. Nothing is learned from a move that leads
  // to one and the same place however it is read, or to none of those.
  void learn_modes(std::string_view command, const GcodeTrace& trace, const GcodePoint& told);

 private:
  struct Reading {
    double to = 0;
    bool relative = false;
    bool inches = false;
  };
  // Of a word of a move, by what is known of the modes.
  std::vector<Reading> readings_of(std::size_t axis, double word, double before) const;

  // Each returns whether the line is repeatable.
  bool follow_g(const GcodeLine& line);
  bool follow_m(const GcodeLine& line);
  bool move(const GcodeLine& line);
  bool leave(const GcodeLine& line);
  bool lose();  // a line that may have done anything

  GcodePoint at_;
  // Empty: not known, as behind a macro.
  std::optional<bool> relative_ = false;
  // G90 and G91 are for E too in some firmwares and not in others; empty where that decides.
  std::optional<bool> relative_e_ = false;
  std::optional<bool> inches_ = false;
  bool behind_macro_ = false;
};

enum class GcodeFate {
  kTaken,
  kMissed,      // as the place proves
  kRepeatable,  // nobody knows, but it may be given again
  kUnknown
};

// Of a line, by what the printer says behind it. answered: as many oks came as were owed, one of
// which may have been doubled.
GcodeFate fate_of(const GcodeTrace& line, const GcodePoint& told, bool answered);

}  // namespace packmerger
