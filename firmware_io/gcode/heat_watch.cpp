#include "firmware_io/gcode/heat_watch.h"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "firmware_io/gcode/gcode.h"

namespace packmerger {

void HeatWatch::begin(std::string_view command) {
  const std::string_view word = gcode_word(command);
  heater_.reset();
  if (word == "M109") heater_ = "tool";
  if (word == "M190") heater_ = "bed";
  if (word == "M191") heater_ = "chamber";
  nearest_c_.clear();
  target_c_.reset();
  if (is_macro(command)) {
    heater_ = "";
    return;  // its letters mean what its user likes
  }
  const std::size_t at = command.find_first_of("SR", word.size());
  if (at == std::string_view::npos) return;
  const std::string number(command.substr(at + 1));
  char* end = nullptr;
  const double target_c = std::strtod(number.c_str(), &end);
  if (end != number.c_str()) target_c_ = target_c;
}

bool HeatWatch::comes_nearer(const std::vector<HeaterReport>& heaters) {
  constexpr double kStep_c = 0.1;
  bool nearer = false;
  for (const HeaterReport& heater : heaters) {
    if (!heater_ || !heater.name.starts_with(*heater_)) continue;
    const std::optional<double> target_c = target_c_ ? target_c_ : heater.target_c;
    if (!target_c) continue;
    const double away_c = std::abs(*target_c - heater.actual_c);
    // A macro may set one target after the other.
    const auto [nearest_c, is_first] =
        nearest_c_.try_emplace(std::pair(heater.name, *target_c), away_c);
    if (!is_first && away_c > nearest_c->second - kStep_c) continue;
    nearest_c->second = away_c;
    nearer = true;
  }
  return nearer;
}

}  // namespace packmerger
