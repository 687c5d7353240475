// Signed distances to a closed surface, sampled on a grid: what the separation of parts asks some
// ten thousand times in every step.
#pragma once

#include <array>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

using Vec3f = Eigen::Vector3f;

class DistanceGrid {
 public:
  // What at() says beyond the grid.
  static constexpr float kFar = 1e3F;

  // surface: closed, normals outward, mm; it may be several that touch along facets. The grid ends
  // reach_mm outside of the surface's box.
  DistanceGrid(const Mesh& surface, double pitch_mm, double reach_mm);

  // mm, negative within matter, interpolated between eight samples; kFar where the point does not
  // lie within the grid.
  float at(const Vec3f& point) const;
  // The same, and its gradient where it is not kFar.
  float at(const Vec3f& point, Vec3f& gradient) const;

  const Vec3f& low() const { return low_; }
  const Vec3f& high() const { return high_; }
  double pitch_mm() const { return pitch_; }

 private:
  // Of a point within the grid: its cell's first sample, and where in the cell it lies.
  struct Cell {
    const float* first = nullptr;  // nullptr: not within the grid
    Vec3f inside = Vec3f::Zero();  // 0..1
  };
  Cell cell(const Vec3f& point) const;

  float pitch_;
  Vec3f low_ = Vec3f::Zero();
  Vec3f high_ = Vec3f::Zero();
  std::array<int, 3> size_{};  // samples along each axis
  std::vector<float> distance_;
};

// Squared distance from a point to a triangle, mm².
double squared_distance(const Vec3& point, const std::array<Vec3, 3>& triangle);

}  // namespace packmerger
