#include "firmware_io/gcode_place.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "firmware_io/gcode.h"
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
bool differ(const GcodePoint& a, const GcodePoint& b) {
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (a[i] && b[i] && std::abs(*a[i] - *b[i]) > 2 * kRounding_mm) return true;
  return false;
}

bool is_move(const GcodeLine& line) { return line.is('G', 0) || line.is('G', 1); }

bool near(const std::optional<double>& a, double b, double by) {
  return a && std::abs(*a - b) <= by;
}

bool leads_to(const GcodeTrace& line, std::size_t axis, const std::optional<double>& place,
              double by) {
  const std::vector<double>& to = line.readings[axis];
  return std::any_of(to.begin(), to.end(), [&](double each) { return near(place, each, by); });
}

// Whether each axis that nobody knows how to read is where it leads in one of the ways.
bool fits_readings(const GcodeTrace& line, const GcodePoint& told) {
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (!line.readings[i].empty() && !leads_to(line, i, told[i], kRounding_mm)) return false;
  return true;
}

// Whether one of those axes leads elsewhere in all of the ways.
bool moves_anyway(const GcodeTrace& line) {
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (!line.readings[i].empty() && !leads_to(line, i, line.before[i], 2 * kRounding_mm))
      return true;
  return false;
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
  trace.repeatable = true;
  if (is_macro(command) && !line.is_empty())
    trace.repeatable = lose();
  else if (line.letter() == 'G' && line.sub_number() == 0)
    trace.repeatable = line.readable() ? follow_g(line) : lose();
  else if (line.letter() == 'M' && line.sub_number() == 0)
    trace.repeatable = follow_m(line);
  else if (line.letter() == 'T')
    at_ = {};
  else if (!line.is_empty())
    trace.repeatable = lose();
  trace.after = at_;
  if (behind_macro_ && is_move(line) && line.readable())
    for (std::size_t i = 0; i < kAxes.size(); ++i)
      if (const auto word = line.value(kAxes[i]); word && trace.before[i] && !at_[i])
        for (const Reading& reading : readings_of(i, *word, *trace.before[i]))
          trace.readings[i].push_back(reading.to);
  return trace;
}

void GcodePlace::learn(const GcodePoint& told) {
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (!at_[i]) at_[i] = told[i];
}

bool GcodePlace::wants_report(std::string_view command) const {
  if (!behind_macro_ || (relative_ && relative_e_ && inches_)) return false;
  if (is_macro(command)) return true;
  const GcodeLine line(command, GcodeRules::kMarlin);
  const bool moves = line.has('X') || line.has('Y') || line.has('Z');
  return is_move(line) &&
         ((moves && (!relative_ || !inches_)) || (line.has('E') && (!relative_e_ || !inches_)));
}

std::vector<GcodePlace::Reading> GcodePlace::readings_of(std::size_t axis, double word,
                                                         double before) const {
  constexpr double kInch_mm = 25.4;
  const std::optional<bool>& known = axis == kE ? relative_e_ : relative_;
  std::vector<Reading> readings;
  for (const bool relative : {false, true})
    for (const bool inches : {false, true})
      if (known.value_or(relative) == relative && inches_.value_or(inches) == inches)
        readings.push_back(
            {word * (inches ? kInch_mm : 1) + (relative ? before : 0), relative, inches});
  return readings;
}

void GcodePlace::learn_modes(std::string_view command, const GcodeTrace& trace,
                             const GcodePoint& told) {
  const GcodeLine line(command, GcodeRules::kMarlin);
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    if (trace.readings[i].empty() || !told[i]) continue;
    std::vector<Reading> readings = readings_of(i, *line.value(kAxes[i]), *trace.before[i]);
    std::erase_if(readings, [&](const Reading& reading) {
      return std::abs(reading.to - *told[i]) > 2 * kRounding_mm;
    });
    if (readings.size() != 1 || std::abs(readings[0].to - *told[i]) > kRounding_mm) continue;
    (i == kE ? relative_e_ : relative_) = readings[0].relative;
    inches_ = readings[0].inches;
  }
  learn(told);
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
    else
      at_[i] = *relative ? *at_[i] + *to : *to;
  }
  return repeatable;
}

// Whatever else there is: it leaves the head where it is, or nobody knows what it does.
bool GcodePlace::leave(const GcodeLine& line) {
  const bool stays = !cannot_follow(line, GcodeRules::kMarlin);
  if (!stays) at_ = {};
  return stays;
}

bool GcodePlace::lose() {
  at_ = {};
  relative_.reset();
  relative_e_.reset();
  inches_.reset();
  behind_macro_ = true;
  return false;
}

GcodeFate fate_of(const GcodeTrace& line, const GcodePoint& told, bool answered) {
  const bool fits = fits_readings(line, told);
  if (differ(line.before, line.after) || moves_anyway(line)) {
    if (agree(told, line.after) && fits) return GcodeFate::kTaken;
    return agree(told, line.before) ? GcodeFate::kMissed : GcodeFate::kUnknown;
  }
  if (!agree(told, where_known(line.after, line.before)) || !fits) return GcodeFate::kUnknown;
  if (answered) return GcodeFate::kTaken;
  return line.repeatable ? GcodeFate::kRepeatable : GcodeFate::kUnknown;
}

}  // namespace packmerger
