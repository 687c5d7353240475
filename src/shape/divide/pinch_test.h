// Which tetrahedra surround a point, and whether a part is pinched there: the link condition of
// combinatorial manifolds. Internal to this folder.
#pragma once

#include <span>
#include <vector>

#include "model/segments.h"
#include "model/tet_mesh.h"

namespace packmerger {

// The star of every point, as compressed rows. Valid while no tetrahedron is split.
class Stars {
 public:
  explicit Stars(const TetMesh& mesh);
  // Ascending.
  std::span<const int> of(int point) const {
    return {tetrahedra_.data() + first_[point],
            static_cast<std::size_t>(first_[point + 1] - first_[point])};
  }

 private:
  std::vector<int> first_;
  std::vector<int> tetrahedra_;
};

// A part's boundary is a closed 2-manifold when around every point the part's own tetrahedra meet
// the link of the point (a sphere inside the mesh, a disk on its boundary) in one disk or in all of
// it: connected over faces, with Euler characteristic 1. Holds the scratch space of that test.
class PinchTest {
 public:
  // 0 when no part is pinched at the point. Otherwise a count that grows with the damage: surplus
  // pieces and holes of each part's share of the link.
  int defects(const TetMesh& mesh, const std::vector<int>& labels, int point,
              std::span<const int> star);

  struct Share {
    int label = 0;
    int pieces = 0;  // connected over faces that contain the point
    int tetrahedra = 0;
    int euler = 0;  // of the label's closed share of the link
  };
  // The share of every label in the link of the point, in the order of first appearance.
  const std::vector<Share>& shares(const TetMesh& mesh, const std::vector<int>& labels, int point,
                                   std::span<const int> star);

 private:
  int next_mark() { return ++mark_; }

  std::vector<int> tetrahedron_mark_;
  std::vector<int> point_mark_;
  std::vector<int> stack_;
  std::vector<Share> shares_;
  int mark_ = 0;
};

}  // namespace packmerger
