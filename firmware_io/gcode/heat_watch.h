// Whether a printer that waits for heat is getting on with it, where it says nothing but its
// temperatures.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware_io/print_state.h"

namespace packmerger {

class HeatWatch {
 public:
  // `command` is waited for from now on: M109 for a tool, M190 for the bed, M191 for the chamber, a
  // macro for whatever has a target; with any other nothing is.
  void begin(std::string_view command);

  // True where a heater that is waited for has come at least 0.1 °C nearer to its target than ever
  // before, so a heater that stands still cannot seem to move for long.
  bool comes_nearer(const std::vector<HeaterReport>& heaters);

 private:
  std::optional<std::string> heater_;  // how its name begins; nullopt: none is waited for
  std::optional<double> target_c_;
  std::map<std::pair<std::string, double>, double> nearest_c_;  // by name and target
};

}  // namespace packmerger
