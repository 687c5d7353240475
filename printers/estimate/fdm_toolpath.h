// FDM by tool path: how long the beads are that fill each layer, and how fast they are laid.
#pragma once

#include <vector>

#include "model/mesh.h"
#include "model/printer.h"
#include "printers/estimate/print_terms.h"
#include "printers/layers/slice_layers.h"

namespace packmerger {

// A bead is a rectangle with half-round ends: line_width_mm wide, a layer high.
struct Bead {
  double spacing_mm = 0;  // from one bead to the next that touches it
  double area_mm2 = 0;    // of its cross-section
};
Bead bead(const FdmSettings& settings, double layer_mm);

// Lengths of bead in one layer, mm.
struct LayerPath {
  double external_mm = 0;  // the outermost bead of every contour
  double internal_mm = 0;  // the other shells
  double solid_mm = 0;
  double sparse_mm = 0;
  double fill_lines = 0;  // straight pieces that solid and sparse fill consist of
  double total_mm() const { return external_mm + internal_mm + solid_mm + sparse_mm; }
};

// exposed_mm2: solid fill that tops and bottoms near this layer ask for (exposed_areas below).
LayerPath layer_path(const FdmSettings& settings, double layer_mm, const Layer& layer,
                     double exposed_mm2);

// Seconds for it: stretched to min_layer_s by going slower, but not below min_speed_mm_s.
double layer_time_s(const FdmSettings& settings, const LayerPath& path);

// For each of `count` layers the area that lies within solid_layers below an upper facet or above
// a lower one and is not covered by the shells of the layer beyond.
std::vector<double> exposed_areas(const FdmSettings& settings, double layer_mm,
                                  const std::vector<const Mesh*>& parts, int count);

// Seconds for support of this volume below facets of this area.
double support_time_s(const FdmSettings& settings, double layer_mm, double support_mm3,
                      double interface_mm2);

// Adds a tray's layers, path, beads and support.
void add_tool_path(PrintTerms& terms, const Profile& profile,
                   const std::vector<const Mesh*>& parts);

}  // namespace packmerger
