// The last word on gaps: distances between the meshes themselves, nothing of the grid (FCL).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

// The least Euclidean distance between any two of the closed surfaces, mm; 0 where two intersect or
// one lies within another's matter; infinity for fewer than two. Pairs that are further apart than
// `enough` are not told from one another: the answer is then some value not below `enough`.
double least_gap_mm(const std::vector<Mesh>& parts,
                    double enough = std::numeric_limits<double>::infinity());

// Work (base/effort.h) that a distance of two surfaces is counted as, on average.
inline constexpr std::uint64_t kStepsOfDistance = 40'000;

// A closed surface that is looked at in several poses.
class MovableSurface {
 public:
  explicit MovableSurface(const Mesh& mesh);

  Box3 box(const Pose& at) const;

  // The least distance between points of two surfaces, mm: 0 where they intersect, but not where
  // one lies within the other. Told up to `enough`. Thread-safe.
  friend double surface_distance_mm(const MovableSurface& a, const Pose& at_a,
                                    const MovableSurface& b, const Pose& at_b, double enough);

 private:
  struct Tree;

  Mesh mesh_;
  std::shared_ptr<const Tree> tree_;
};

}  // namespace packmerger
