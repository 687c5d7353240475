// Ways to cut a region by planes. Internal to this folder.
#pragma once

#include <vector>

#include "base/random.h"
#include "shape/cut/cut_state.h"

namespace packmerger {

// Where a region lies: the middle of its samples and its principal axes, longest first.
struct RegionFrame {
  Vec3 middle = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  // columns
  Vec3 half_mm = Vec3::Zero();   // half the extents along them
};
RegionFrame frame_of(const MatterSamples& samples, const std::vector<int>& region);

// `count` slices of equal volume between parallel planes.
CutRecipe slabs(const MatterSamples& samples, const std::vector<int>& region, const Vec3& normal,
                int count);

// `count` wedges round an axis through `point`, of equal angle on either side of the first plane.
CutRecipe wedges(const Vec3& point, const Vec3& axis, int count);

// A band of half the given width round an axis, one strip over each cap (across: its normal, at
// right angles to the axis), and what is left of the caps: on a ball seven pieces. halve: the four
// lenses are halved, eleven pieces.
CutRecipe ring(const Vec3& middle, const Vec3& axis, const Vec3& across, double band_half_mm,
               double strip_half_mm, bool halve);

// One plane, a slab or a few wedges, at random: planes parallel to those that cut the region
// already, along its principal axes, or any way.
CutRecipe random_recipe(const MatterSamples& samples, const std::vector<int>& region,
                        const std::vector<Plane>& planes, int most_steps, Random& random);

}  // namespace packmerger
