#include "firmware_io/heat_watch.h"

#include <cmath>
#include <cstdlib>

#include "firmware_io/gcode.h"

namespace packmerger {

void HeatWatch::begin(std::string_view command) {
  const std::string_view word = gcode_word(command);
  heater_ = word == "M109" ? "tool" : word == "M190" ? "bed" : word == "M191" ? "chamber" : "";
  nearest_c_ = std::numeric_limits<double>::infinity();
  target_c_.reset();
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
    if (heater_.empty() || !heater.name.starts_with(heater_)) continue;
    const std::optional<double> target_c = target_c_ ? target_c_ : heater.target_c;
    if (!target_c) continue;
    const double away_c = std::abs(*target_c - heater.actual_c);
    if (away_c > nearest_c_ - kStep_c) continue;
    nearest_c_ = away_c;
    nearer = true;
  }
  return nearer;
}

}  // namespace packmerger
