// Where the head is after each line given, in the words of M114 (Marlin's and RepRapFirmware's),
// for printers that count no lines.
#pragma once

#include <array>
#include <optional>
#include <string_view>

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
  // The same of a printer that counts E in absolute mode alone (RepRapFirmware); where it is known
  // whether it does, equal to those above.
  GcodePoint still_before;
  GcodePoint still_after;
  bool repeatable = false;
  bool is_unreadable = false;  // a move, relative or not, mm or inches: no place tells what it did
};

class GcodePlace {
 public:
  GcodeTrace follow(std::string_view command);
  // Somebody may have moved the head by hand.
  void forget() {
    at_ = {};
    still_e_.reset();
  }
  // Where the head is behind the last line, of the axes that were not known, and whether E is
  // counted in relative mode.
  void learn(const GcodePoint& told);

 private:
  // Each returns whether the line is repeatable.
  bool follow_g(const GcodeLine& line);
  bool follow_m(const GcodeLine& line);
  bool move(const GcodeLine& line);
  bool leave(const GcodeLine& line);
  // at_, where E counts in absolute mode alone.
  GcodePoint still() const;
  bool can_read(const GcodeLine& line) const;
  bool lose();  // a line that may have done anything

  GcodePoint at_;
  std::optional<double> still_e_;  // where relative moves of E are not counted; known as at_'s is
  std::optional<bool> counts_relative_e_;
  // Empty: not known, as behind a macro.
  std::optional<bool> relative_ = false;
  // G90 and G91 are for E too in some firmwares and not in others; empty where that decides.
  std::optional<bool> relative_e_ = false;
  std::optional<bool> inches_ = false;
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
