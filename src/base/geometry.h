// The linear algebra of the house: Eigen, double precision, lengths in mm.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace packmerger {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Pose = Eigen::Isometry3d;  // rotation then translation, maps points to points
using Box3 = Eigen::AlignedBox3d;

inline double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
inline double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

// Directions spread evenly over the sphere (a Fibonacci lattice), from +z to −z.
inline std::vector<Vec3> spread_directions(int count) {
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double radius = std::sqrt(1 - z * z);
    directions.emplace_back(radius * std::cos(golden * i), radius * std::sin(golden * i), z);
  }
  return directions;
}

}  // namespace packmerger
