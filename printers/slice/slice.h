// PrusaSlicer's command line as a child process. The whole tray is given as one STL: several
// objects would each be dropped to z = 0 and printed through one another without a word.
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "model/estimate.h"
#include "model/printer.h"
#include "model/tray.h"

namespace packmerger {

enum class SliceFlavour {
  // For the figures: flavour marlin, because the slicer's clock heeds machine limits only there,
  // and without the profile's start and end text.
  kFigures,
  // For the program: flavour sailfish for dialect s3g, otherwise the profile's gcode_flavor
  // (marlin where it names none), with the start and end text.
  kProgram
};

struct SlicedTray {
  std::string gcode;     // in the machine's own coordinates
  double time_s = 0;     // by the slicer's clock
  double model_mm3 = 0;  // extruded for everything that is not support, skirt included
  double model_g = 0;
  double support_mm3 = 0;  // extruded as support and support interface
  double support_g = 0;
  bool skirt_left_out = false;  // the profile asks for one, and it has no room
};

// The room to leave on each side of a tray's contents, seen from above, so that support stays on
// the plate: slicers let it reach past the part it holds. 0 where nothing is sliced or supported.
double slicer_margin_mm(const Profile& profile);

// Where the contents stand too near the sides of the build volume, support's broader first layer
// is made narrower and the skirt left out; the program is checked all the same.
// Needs no display, no HOME and no other environment. Throws Error{kUnavailable} when PrusaSlicer
// is not installed, kBadInput when the contents leave the build volume, do not stand on the plate
// or cannot be sliced (with the slicer's message), kBadProfile when the slicer does not know an
// option or refuses a value, kInterrupted.
SlicedTray slice(const Profile& profile, const Tray& tray, SliceFlavour flavour,
                 const Progress& progress);

// Sums over the trays of slice(kFigures), plus fdm.start_s for each; priced. support_mm3 is what
// is extruded for support. source = kSlicer. Errors as slice().
Estimate estimate_by_slicer(const Profile& profile, const std::vector<Tray>& trays,
                            const Assembly& assembly, const Progress& progress);

}  // namespace packmerger
