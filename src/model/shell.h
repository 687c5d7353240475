// The model hollowed: what is left of the solid after its inside was taken out (paper, section 3).
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger {

struct Shell {
  Mesh outer;                  // the model's own surface, or its re-sampled stand-in
  std::vector<Mesh> cavities;  // each one component; normals point into the cavity (out of matter)
  std::vector<Vec3> cavity_points;  // one point strictly inside each cavity, same order
  double wall_mm = 0;
  double volume_mm3 = 0;  // V_o: the outer volume less the cavities
};

}  // namespace packmerger
