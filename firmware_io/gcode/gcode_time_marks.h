// The time that a G-code program is expected to take, mark by mark.
#pragma once

#include <vector>

#include "firmware_io/remaining_time.h"

namespace packmerger {

class GcodeCommands;

// Whether the program carries its slicer's clock: at least two marks (M73 R, minutes left).
bool has_slicer_marks(const GcodeCommands& commands);

// From the slicer's marks (M73 R, minutes left) where the program has them, otherwise from the
// lengths and speeds of its moves and its dwells; heating and homing count nothing. done: commands.
std::vector<TimeMark> time_marks(const GcodeCommands& commands);

}  // namespace packmerger
