// One tray's contents, ready to be written or sliced.
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger {

// Parts in tray coordinates: origin front left, z = 0 the plate, mm.
struct Tray {
  std::vector<Mesh> parts;
};

// How much gluing a job needs: pairs of neighbouring parts count as joints.
struct Assembly {
  int parts = 1;
  int joints = 0;
};

}  // namespace packmerger
