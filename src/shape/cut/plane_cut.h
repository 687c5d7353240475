// Exact cuts of a tetrahedral mesh by planes.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "model/segments.h"
#include "model/tet_mesh.h"

namespace packmerger {

// plane.signedDistance(p) > 0 is the side above, where the normal points to.
using Plane = Eigen::Hyperplane<double, 3>;

// A point nearer to the plane than this counts as lying on it, and is moved there where its
// tetrahedra allow: otherwise slivers would arise.
inline constexpr double kOnPlane_mm = 0.02;

// Cuts one labelled region after the other. Every edge of the region that crosses the plane is
// bisected where it does, in all tetrahedra that share it, so the mesh keeps conforming; tetrahedra
// and points are added at the end. A point that lies on earlier planes only moves within them, so
// planes that meet in one line keep meeting in that line.
class PlaneCutter {
 public:
  // labels: one per tetrahedron, any numbers; grows with the mesh.
  PlaneCutter(TetMesh& mesh, std::vector<int>& labels);

  // Tetrahedra of `label` become `above` or `below`; the faces between lie within kOnPlane_mm of
  // the plane. Other labels stay, though their tetrahedra may be split along the region's rim.
  void cut(int label, const Plane& plane, int below, int above);

  // The tetrahedron of the mesh as it was at the start that this one is a piece of.
  int origin(int tetrahedron) const { return origin_[tetrahedron]; }

  // Makes mesh.neighbours right again; cut() does not keep them.
  void link();

 private:
  void snap(const std::vector<int>& region, const Plane& plane);
  bool may_move(const std::vector<int>& star, int point, const Vec3& to);
  void bisect(int tetrahedron);
  int middle_of(int a, int b) const;  // the new point on this edge, or -1

  TetMesh& mesh_;
  std::vector<int>& labels_;
  std::vector<int> origin_;
  std::vector<Plane> planes_;                           // so far
  std::map<int, std::vector<int>> held_;                // planes that a point lies on, ascending
  std::vector<std::pair<std::uint64_t, int>> middles_;  // of the current cut, by edge
  std::vector<int> open_;
  bool linked_ = true;
};

// Every face-connected piece of a label becomes a segment of its own, except that pieces smaller
// than least_mm3 go to the neighbour they share the largest area with, where there is one. Segments
// are numbered in the order of their first tetrahedra.
Segments connected_segments(const TetMesh& mesh, const std::vector<int>& labels, double least_mm3);

}  // namespace packmerger
