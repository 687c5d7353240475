// The last word on gaps: distances between the meshes themselves, nothing of the grid (FCL).
#pragma once

#include <limits>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

// The least Euclidean distance between any two of the closed surfaces, mm; 0 where two intersect or
// one lies within another's matter; infinity for fewer than two. Pairs that are further apart than
// `enough` are not told from one another: the answer is then some value not below `enough`.
double least_gap_mm(const std::vector<Mesh>& parts,
                    double enough = std::numeric_limits<double>::infinity());

}  // namespace packmerger
