// Whether a printer that waits for heat is getting on with it, where it says nothing but its
// temperatures.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_io/print_state.h"

namespace packmerger {

class HeatWatch {
 public:
  // `command` is waited for from now on: M109 for a tool, M190 for the bed, M191 for the chamber;
  // with any other nothing is.
  void begin(std::string_view command);

  // True where the heater that is waited for has come at least 0.1 °C nearer to its target than
  // ever before, so a heater that stands still cannot seem to move for long.
  bool comes_nearer(const std::vector<HeaterReport>& heaters);

 private:
  std::string heater_;  // how its name begins; empty: none is waited for
  std::optional<double> target_c_;
  double nearest_c_ = std::numeric_limits<double>::infinity();
};

}  // namespace packmerger
