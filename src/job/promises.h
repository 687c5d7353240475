// What a job folder promises of its trays, proved on the points that are written.
#pragma once

#include <optional>
#include <string>

#include "base/progress.h"
#include "job/compare/arrangement.h"
#include "model/printer.h"

namespace packmerger {

struct BrokenPromise {
  std::string what;       // a plain sentence without a full stop
  double missing_mm = 0;  // by how much more room it would be kept, where that is known
};

// Looks at every tray's parts as they are written, rounded to 32-bit floats: all at least gap_mm
// apart, and never touching or within one another even at a gap of 0; all within `room` and over no
// wall of its plate; and each
// taken out in removal_order along its path, if it has one, and then straight up without meeting
// another. Rounding may take 0.0001 mm of a distance. Nothing where all of it holds.
std::optional<BrokenPromise> broken_promise(const Arrangement& arrangement, double gap_mm,
                                            const Room& room, const Progress& progress);

}  // namespace packmerger
