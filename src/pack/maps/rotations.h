// The rotations a part is tried in: steps about the three axes (paper, section 6.1), without
// repetitions, ordered as ways up and turns about the vertical.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/geometry.h"

namespace packmerger {

// Every rotation is turn_about_z(turns[j]) * ways_up[i]. With a step that divides 180° these are
// exactly the different products of turns about x, then y, then z by multiples of the step: 24 for
// 90°, 744 for 30° (62 ways up, 12 turns).
struct RotationSet {
  std::vector<Mat3> ways_up;  // each with another model direction pointing up; the first: identity
  std::vector<double> turns;  // radians in [0, 2π), ascending, the first 0
};

// step: radians; 0 or less: the identity alone.
RotationSet rotation_set(double step);

// Ways up whose up directions are spread evenly over the sphere.
std::vector<Mat3> spread_ways(int count);

// Equal for rotations that differ by rounding only.
using RotationKey = std::array<std::int64_t, 9>;
RotationKey key_of(const Mat3& rotation);

// Exact at multiples of 90°, so that boxes stay boxes.
Mat3 turn_about_z(double angle);

// The least turn that brings one direction to another (neither of length 0); a rotation to
// rounding, of nearly opposite directions too.
Mat3 turn_between(const Vec3& from, const Vec3& to);

}  // namespace packmerger
