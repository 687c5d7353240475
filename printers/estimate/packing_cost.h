// The objective the packer minimises, made from a profile (paper, equation (1), and two others).
#pragma once

#include "model/packing.h"
#include "model/printer.h"

namespace packmerger {

// paper: f = w·V_bp + (1 − w)·V_s, mm³. height: the height of the contents, mm. printer: the money
// one tray takes, predicted from its measure alone with the profile's estimator and prices;
// parts − 1 joints are assumed, as in one model whose parts lie on one tray.
//
// Every figure of TrayMeasure only grows while parts are dropped on a tray from above (a part that
// comes from above never fills an emptiness already counted), and evaluate never falls when one
// of them grows; so lower_bound is evaluate itself.
// Throws Error{kBadProfile} when a constant the prediction divides by is not positive.
Cost packing_cost(const Profile& profile);

}  // namespace packmerger
