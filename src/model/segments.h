// A division of a tetrahedral mesh into segments (paper, sections 4 and 5).
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger {

struct Segments {
  std::vector<int> of_tetrahedron;  // one label per tetrahedron, in [0, count)
  int count = 0;
};

// An edge e_ij of the paper's weighted adjacency graph G(V, E): two segments that share faces.
struct SegmentEdge {
  int a = 0;  // a < b
  int b = 0;
  double area_mm2 = 0;  // a_ij: the cross-section, the area of the shared faces
};

// What the packer is given for one segment: its closed surface in model coordinates.
struct SegmentSurface {
  Mesh surface;
  double volume_mm3 = 0;
};

}  // namespace packmerger
