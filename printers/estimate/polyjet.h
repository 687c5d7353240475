// PolyJet: the head jets every layer in swaths; height costs most, then width, length little.
#pragma once

#include <vector>

#include "model/mesh.h"
#include "printers/estimate/print_terms.h"

namespace packmerger {

// The passes of so many layers that reach this far along x (the scan axis) and y, support
// included. An empty layer is still one pass.
void add_passes(PrintTerms& terms, const PolyjetSettings& settings, double layers, double x_mm,
                double y_mm);

// Those of a tray's layers, as it stands and turned by a quarter.
void add_passes(BothTerms& both, const Profile& profile, const std::vector<const Mesh*>& parts);

}  // namespace packmerger
