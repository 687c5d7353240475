#include "firmware_io/gcode/gcode_place.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string>

#include "firmware_io/gcode/ascii.h"
#include "firmware_io/gcode/gcode.h"
#include "gcode/known_codes.h"

namespace packmerger {

namespace {

constexpr std::array<char, 4> kAxes = {'X', 'Y', 'Z', 'E'};
constexpr std::size_t kE = 3;
// Printers tell two or three decimals.
constexpr double kRounding_mm = 0.0055;

// At every axis where both are known.
bool agree(const GcodePoint& a, const GcodePoint& b) {
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (a[i] && b[i] && std::abs(*a[i] - *b[i]) > kRounding_mm) return false;
  return true;
}

// So far apart that what is told cannot be both.
bool differ_at(std::size_t axis, const GcodePoint& a, const GcodePoint& b) {
  return a[axis] && b[axis] && std::abs(*a[axis] - *b[axis]) > 2 * kRounding_mm;
}

bool differ(const GcodePoint& a, const GcodePoint& b) {
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (differ_at(i, a, b)) return true;
  return false;
}

// Of every axis that the line moves: what was cut short on its way proves nothing.
bool tells_enough(const GcodePoint& told, const GcodePoint& before, const GcodePoint& after) {
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (!told[i] && differ_at(i, before, after)) return false;
  return true;
}

// Klipper's own commands that move nothing and leave the modes and the origin as they are, after
// its sources; slicers write some of them with every feature. Each may be executed twice.
bool is_klipper_setting(std::string_view command) {
  static constexpr std::array<std::string_view, 24> kWords = {
      "EXCLUDE_OBJECT_DEFINE",  "EXCLUDE_OBJECT_END",
      "EXCLUDE_OBJECT_START",   "RESPOND",
      "SAVE_GCODE_STATE",       "SAVE_VARIABLE",
      "SET_DISPLAY_TEXT",       "SET_FAN_SPEED",
      "SET_FILAMENT_SENSOR",    "SET_GCODE_VARIABLE",
      "SET_HEATER_TEMPERATURE", "SET_IDLE_TIMEOUT",
      "SET_INPUT_SHAPER",       "SET_LED",
      "SET_LED_TEMPLATE",       "SET_PIN",
      "SET_PRESSURE_ADVANCE",   "SET_PRINT_STATS_INFO",
      "SET_RETRACTION",         "SET_TEMPERATURE_FAN_TARGET",
      "SET_TMC_CURRENT",        "SET_VELOCITY_LIMIT",
      "TEMPERATURE_WAIT",       "TURN_OFF_HEATERS"};
  std::string word(command.substr(0, command.find_first_of(" \t")));
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return ascii::one_of(word, kWords);
}

bool is_move(const GcodeLine& line) {
  return line.letter() == 'G' && line.sub_number() == 0 && line.number() <= 3;
}

// The axes of `point` that `other` knows too.
GcodePoint where_known(GcodePoint point, const GcodePoint& other) {
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (!other[i]) point[i].reset();
  return point;
}

}  // namespace

GcodePoint read_gcode_point(std::string_view report) {
  GcodePoint point;
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const std::size_t at = report.find(std::string(1, kAxes[i]) + ":");
    if (at == std::string_view::npos) continue;
    const std::string number(report.substr(at + 2, report.find(' ', at + 3) - at - 2));
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (end != number.c_str() && *end == '\0' && std::isfinite(value)) point[i] = value;
  }
  return point;
}

GcodeTrace GcodePlace::follow(std::string_view command) {
  const GcodeLine line(command, GcodeRules::kMarlin);
  GcodeTrace trace;
  trace.before = at_;
  trace.still_before = still();
  trace.repeatable = true;
  if (is_macro(command) && !line.is_empty())
    trace.repeatable = is_klipper_setting(command) || lose();
  else if (line.letter() == 'G' && line.sub_number() == 0)
    trace.repeatable = line.readable() ? follow_g(line) : lose();
  else if (line.letter() == 'M' && line.sub_number() == 0)
    trace.repeatable = follow_m(line);
  else if (line.letter() == 'T')
    at_ = {};
  else if (!line.is_empty())
    trace.repeatable = lose();
  if (!at_[kE]) still_e_.reset();
  trace.after = at_;
  trace.still_after = still();
  trace.is_unreadable = is_move(line) && !can_read(line);
  return trace;
}

GcodePoint GcodePlace::still() const {
  GcodePoint point = at_;
  if (counts_relative_e_ != true) point[kE] = still_e_;
  return point;
}

void GcodePlace::learn(const GcodePoint& told) {
  if (!at_[kE]) still_e_ = told[kE];
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (!at_[i]) at_[i] = told[i];
  if (counts_relative_e_ || !differ_at(kE, at_, still())) return;
  if (differ_at(kE, told, still()) != differ_at(kE, told, at_))
    counts_relative_e_ = differ_at(kE, told, still());
  if (counts_relative_e_ == false) at_[kE] = still_e_;
}

bool GcodePlace::follow_g(const GcodeLine& line) {
  switch (line.number()) {
    case 0:
    case 1:
    case 2:
    case 3:
      return move(line);
    case 10:
    case 11:
      at_[kE].reset();  // the firmware's own retraction
      return true;
    case 20:
    case 21:
      inches_ = line.number() == 20;
      return true;
    case 28:
    case 29:
      for (std::size_t i = 0; i < kE; ++i) at_[i].reset();
      return true;
    case 90:
    case 91:
      relative_ = line.number() == 91;
      if (relative_e_ != relative_) relative_e_.reset();
      return true;
    case 92:
      if (std::none_of(kAxes.begin(), kAxes.end(), [&](char axis) { return line.has(axis); }))
        at_ = {};  // all of them, or in some firmwares none
      for (std::size_t i = 0; i < kAxes.size(); ++i)
        if (line.has(kAxes[i])) at_[i] = inches_ == false ? line.value(kAxes[i]) : std::nullopt;
      if (line.has('E')) still_e_ = at_[kE];
      return true;
    default:
      return leave(line);
  }
}

bool GcodePlace::follow_m(const GcodeLine& line) {
  switch (line.number()) {
    case 82:
    case 83:
      relative_e_ = line.number() == 83;
      return true;
    case 18:
    case 84:
    case 220:
    case 221:
      return true;  // motors off, speed, flow
    default:
      return leave(line);
  }
}

bool GcodePlace::move(const GcodeLine& line) {
  bool repeatable = true;
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    if (!line.has(kAxes[i])) continue;
    const std::optional<double> to = line.value(kAxes[i]);
    const std::optional<bool> relative = i == kE ? relative_e_ : relative_;
    repeatable = repeatable && relative == false;
    if (!to || inches_ != false || !relative || (*relative && !at_[i]))
      at_[i].reset();
    else if (!*relative)
      at_[i] = *to;
    else if (i != kE || counts_relative_e_ != false)
      *at_[i] += *to;
    if (i == kE && relative == false) still_e_ = at_[kE];
  }
  return repeatable;
}

// Whatever else there is: it leaves the head where it is, or nobody knows what it does.
bool GcodePlace::leave(const GcodeLine& line) {
  const bool stays = !cannot_follow(line, GcodeRules::kMarlin);
  if (!stays) at_ = {};
  return stays;
}

// Whether it is known of any of its axes how the move is read.
bool GcodePlace::can_read(const GcodeLine& line) const {
  const bool moves = line.has('X') || line.has('Y') || line.has('Z');
  if (!moves && !line.has('E')) return true;
  return inches_ && ((moves && relative_) || (line.has('E') && relative_e_));
}

bool GcodePlace::lose() {
  at_ = {};
  relative_.reset();
  relative_e_.reset();
  inches_.reset();
  return false;
}

namespace {

// Nothing: neither here nor there.
std::optional<GcodeFate> fate_between(const GcodePoint& before, const GcodePoint& after,
                                      const GcodeTrace& line, const GcodePoint& told,
                                      bool answered) {
  if (differ(before, after)) {
    if (!tells_enough(told, before, after)) return GcodeFate::kUnknown;
    if (agree(told, after)) return GcodeFate::kTaken;
    return agree(told, before) ? std::optional(GcodeFate::kMissed) : std::nullopt;
  }
  if (!agree(told, where_known(after, before))) return std::nullopt;
  if (answered && !line.is_unreadable) return GcodeFate::kTaken;
  return line.repeatable ? GcodeFate::kRepeatable : GcodeFate::kUnknown;
}

}  // namespace

// Whether the printer counts E in relative mode is perhaps not known: then both must lead to one
// and the same fate, or what is told must fit one of them only.
GcodeFate fate_of(const GcodeTrace& line, const GcodePoint& told, bool answered) {
  const auto counted = fate_between(line.before, line.after, line, told, answered);
  const auto still = fate_between(line.still_before, line.still_after, line, told, answered);
  if (counted && still && *counted != *still) return GcodeFate::kUnknown;
  return counted.value_or(still.value_or(GcodeFate::kUnknown));
}

}  // namespace packmerger
