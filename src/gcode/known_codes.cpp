#include "gcode/known_codes.h"

#include <algorithm>
#include <span>

namespace packmerger {
namespace {

// Each list in ascending order.

// Firmware retraction moves the filament alone; G17 is the plane arcs lie in anyway; G94 is a feed
// a minute.
constexpr int kStillG[] = {4, 10, 11, 17, 21, 94};

constexpr int kStillM[] = {
    0,   1,                                                 // stops for the user
    16,  17,                                                // printer's name, motors on
    20,  21,  22,  27,  29,  31,  33,  34,                  // card: lists and reports
    73,  75,  76,  77,  78,  80,  85,  86,  87,             // progress, timers, power on
    100, 104, 105, 106, 107, 108, 109, 110, 111,            // heaters, fans, reports
    113, 114, 115, 117, 118, 119, 120, 122, 123,            //
    126, 127, 128, 129, 140, 141, 143, 145, 150, 154, 155,  // valves, bed, chamber, lights
    163, 164, 165, 166, 190, 191, 192, 193,                 // mixing, waits for heat
    201, 203, 204, 205, 207, 208, 209, 226,                 // accelerations and speeds
    250, 255, 256, 280, 281, 282, 300, 301, 304, 309,       // display, servos, sound, control
    355, 400, 403, 404, 406, 407, 412, 413, 414, 420, 430,  //
    486, 503, 569, 575, 593, 603, 710, 862, 876, 900,       // objects, filament, checks
    906, 907, 908, 909, 910, 911, 912, 913, 919};           // motor currents

// Parks, probes, loads filament, calibrates, prints or parks tools.
constexpr int kMovingG[] = {5, 6, 12, 26, 27, 30, 31, 32, 33, 34, 35, 38, 42, 60, 61, 76, 425};
constexpr int kMovingM[] = {48,  125, 240, 360, 361, 362, 363, 364, 401, 402, 600,
                            601, 602, 605, 701, 702, 915, 916, 917, 918, 951, 995};

constexpr int kScaleG[] = {18, 19, 53, 54, 55, 56, 57, 58, 59, 68, 69, 92};
constexpr int kScaleM[] = {92,  121, 149, 206, 211, 217, 218, 290, 302, 350, 351, 405, 421,
                           422, 423, 425, 428, 500, 501, 502, 504, 592, 665, 666, 672, 851,
                           852, 860, 861, 863, 864, 865, 866, 867, 868, 869, 871, 914};

// Starts files, macros and loops, or stops the machine or what it has planned.
constexpr int kOtherM[] = {23,  24,  25,  26,  28,  32,  98,  112, 410, 524, 808, 810,
                           811, 812, 813, 814, 815, 816, 817, 818, 819, 928, 997, 999};

// gpx: motor potentiometers; no plane but XY, no retraction by the firmware, no coordinate systems.
constexpr int kStillGpxG[] = {4, 17, 21, 71, 130};
constexpr int kStillGpxM[] = {6,   17,  31,  70,  71,  72,  73,  75,  76,  77,  78,  101, 102,
                              103, 104, 105, 106, 107, 108, 109, 110, 111, 113, 114, 115, 116,
                              117, 118, 126, 127, 133, 134, 135, 136, 137, 140, 155, 190, 201,
                              203, 204, 205, 300, 320, 321, 400, 420, 486, 862, 900};

bool holds(std::span<const int> codes, int number) {
  return std::binary_search(codes.begin(), codes.end(), number);
}

std::optional<std::string> still_in_marlin(const GcodeLine& line) {
  const bool g = line.letter() == 'G';
  const int number = line.number();
  // the checks of Prusa's firmware for the right printer have sub-numbers
  const bool plain = line.sub_number() == 0 || line.is('M', 862) || (!g && number == 862);
  if (plain && (g ? holds(kStillG, number) : holds(kStillM, number))) return std::nullopt;
  // steps of the extruder alone; limits that are only switched on, or asked for
  if (!g && number == 92 && !line.has('X') && !line.has('Y') && !line.has('Z')) return std::nullopt;
  if (!g && number == 211 && line.value_or('S', 1) != 0) return std::nullopt;
  if (!g && number == 149 && !line.has('F') && !line.has('K')) return std::nullopt;
  if (g ? holds(kMovingG, number) : holds(kMovingM, number))
    return "cannot be judged: it moves by itself, and nobody knows where to";
  if (g ? holds(kScaleG, number) : holds(kScaleM, number))
    return "cannot be judged: it changes what coordinates mean, or a limit";
  if (!g && holds(kOtherM, number))
    return "cannot be judged: it starts or stops what this program does not show";
  return "cannot be judged: this command is not known";
}

}  // namespace

std::optional<std::string> cannot_follow(const GcodeLine& line, GcodeRules rules) {
  if (rules == GcodeRules::kMarlin) return still_in_marlin(line);
  const bool g = line.letter() == 'G';
  const bool still = line.sub_number() == 0 || line.number() == 862
                         ? (g ? holds(kStillGpxG, line.number()) : holds(kStillGpxM, line.number()))
                         : false;
  // gpx then pushes filament out by time, whatever moves
  if (!g && line.number() == 108 && line.value_or('R', 0) > 0)
    return "cannot be judged: it turns the extruder by itself";
  if (still) return std::nullopt;
  return "cannot be judged: this command is not known to a Replicator";
}

}  // namespace packmerger
