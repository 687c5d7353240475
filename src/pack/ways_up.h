// Which ways up are worth trying for a part: all those of a rotation set, ranked by what the part
// would cost alone on a tray.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "model/packing.h"
#include "pack/rotations.h"

namespace packmerger {

// The rotation is turn_about_z(turn) * base.
struct WayUp {
  Mat3 base = Mat3::Identity();
  double turn = 0;                // the cheapest one, radians
  double cost = 0;                // Cost::evaluate of the part alone on the plate
  double support_mm3 = 0;         // V_s of the part alone
  double inside_support_mm3 = 0;  // V_s between the part's own surfaces
};

// The ways up in which the surfaces together fit the build volume, each in its cheapest turn,
// cheapest first. Empty where none fits. tick
// is called once for each way.
std::vector<WayUp> ranked_ways_up(const std::vector<TriangleSoup>& surfaces, double volume_mm3,
                                  const RotationSet& rotations, const PackProblem& problem,
                                  const std::function<void()>& tick);

// A rotation found by sampling and refining in which the surfaces fit the build volume although no
// rotation of the set did; empty where none was found.
std::optional<WayUp> way_up_that_fits(const std::vector<TriangleSoup>& surfaces, double volume_mm3,
                                      const PackProblem& problem);

// Whether a box fits the build volume, to within rounding.
bool fits(const Vec3& size_mm, const Vec3& build_mm);

}  // namespace packmerger
