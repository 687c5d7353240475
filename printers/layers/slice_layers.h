// A tray cut into layers: what the analytic estimators need to know of each.
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger {

// One closed curve in which a layer's plane cuts a part.
struct Contour {
  double area_mm2 = 0;  // negative for a hole
  double perimeter_mm = 0;
  Eigen::AlignedBox2d box;
};

struct Layer {
  std::vector<Contour> contours;
  double area_mm2 = 0;      // of matter: the contours' sum
  double perimeter_mm = 0;  // outlines and holes
};

// What is round one outline of a layer: it, less the holes in it.
struct Island {
  const Contour* outline = nullptr;
  double area_mm2 = 0;
  double perimeter_mm = 0;  // of the holes too
};
std::vector<Island> islands_of(const Layer& layer);  // as long as the layer lives

// The cut through one closed mesh at one height.
Layer slice_at(const Mesh& part, double z_mm);

// Layer k is cut at (k + 1/2) · layer_mm above the plate, k from 0 to layer_count(top) − 1.
// parts: closed meshes in tray coordinates, mm. Overlapping parts are counted twice.
// Same result on any number of threads.
std::vector<Layer> slice_layers(const std::vector<const Mesh*>& parts, double layer_mm);

}  // namespace packmerger
