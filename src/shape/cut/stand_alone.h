// What a piece would need in support if it stood alone on the plate, judged from samples of its
// matter within a fraction of a millisecond. Internal to this folder.
#pragma once

#include <vector>

#include "shape/cut/matter_samples.h"
#include "shape/cut/plane_cut.h"

namespace packmerger {

struct Standing {
  double support_mm3 = 0;
  Vec3 up = Vec3::UnitZ();  // unit; what is up when the piece stands on the plate
};

// A piece as the judge sees it.
struct PieceShape {
  std::vector<int> samples;   // ascending
  std::vector<Plane> planes;  // it was cut by
  double volume_mm3 = 0;      // of its matter
};

// The least support over directions: both normals of its planes, its principal axes, and a regular
// set on the sphere; the best of them are refined.
//
// At support_angle 0 support is the volume under the piece's upper envelope, down to the plate,
// less its matter, exactly. The envelope is the highest sample in each cell of a coarse map. Such a
// map finds edges and slopes too high by half a cell on average, in proportion to its total
// variation, which is taken off again. Single empty cells are closed first. At larger angles the
// result is lowered by the share of the down-facing surface, times height, that is steep enough.
Standing stand_alone(const MatterSamples& samples, const PieceShape& piece, double support_angle);

}  // namespace packmerger
