// Moves of single tetrahedra from one segment to another that never break a segment. Internal to
// this folder.
#pragma once

#include <vector>

#include "base/progress.h"
#include "model/segments.h"
#include "model/tet_mesh.h"
#include "shape/divide/pinch_test.h"

namespace packmerger {

// Labels of a mesh that is not being split, with what is needed to judge a move.
class LabelMoves {
 public:
  LabelMoves(const TetMesh& mesh, std::vector<int>& labels, int label_count);

  int label(int tetrahedron) const { return labels_[tetrahedron]; }
  int defects(int point) { return test_.defects(mesh_, labels_, point, stars_.of(point)); }
  std::span<const int> star(int point) const { return stars_.of(point); }

  // How many defects more (negative: fewer) the four corners would have after the move.
  int change_of_defects(int tetrahedron, int to);

  // Its segment stays non-empty and, as far as can be told nearby, face-connected without it.
  bool can_leave(int tetrahedron);

  void move(int tetrahedron, int to);

 private:
  int defects_at_corners(int tetrahedron);

  const TetMesh& mesh_;
  std::vector<int>& labels_;
  std::vector<int> sizes_;  // tetrahedra by label
  Stars stars_;
  PinchTest test_;
  std::vector<int> mark_;  // of tetrahedra: in the neighbourhood, then visited
  int last_mark_ = 0;
  std::vector<int> stack_;
};

// Re-assigns whole tetrahedra whose edges are at most reach_mm long where that leaves fewer
// pinches. Returns how many moves were made.
int reassign_pinched(const TetMesh& mesh, Segments& segments, double reach_mm,
                     const Progress& progress);

// Re-assigns teeth: tetrahedra whose move makes the area of the cuts, and the length of the cut
// curves on the surface times the mesh's mean edge length, smaller together, makes no new pinch,
// and lets no two segments share faces that shared none. A few sweeps. Returns how many moves were
// made.
int straighten_cuts(const TetMesh& mesh, Segments& segments, const Progress& progress);

}  // namespace packmerger
