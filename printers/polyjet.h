// PolyJet: the head jets every layer in swaths; height costs most, then width, length little.
#pragma once

#include "model/printer.h"

namespace packmerger {

// How often the heads pass over a layer that reaches this far along y: once at least.
double polyjet_passes(const PolyjetSettings& settings, double y_mm);

// Seconds for one layer that reaches this far along x (the scan axis) and y, support included.
// An empty layer is still one pass.
double polyjet_layer_s(const PolyjetSettings& settings, double x_mm, double y_mm);

}  // namespace packmerger
