// Cutting a spindle around an edge, or a ball around a point, out of a tetrahedral mesh. Internal
// to this folder.
#pragma once

#include <array>
#include <vector>

#include "model/segments.h"
#include "model/tet_mesh.h"

namespace packmerger {

// Splits tetrahedra while it keeps the mesh linked and every point's star at hand. Tetrahedra and
// points are added at the end; the first piece of a split tetrahedron keeps its index.
class StarSplitter {
 public:
  StarSplitter(TetMesh& mesh, Segments& segments);

  // Ascending.
  std::vector<int> star(int point) const;

  // New points lie in the faces around the edge u–v, at most reach_mm from its middle and at most
  // a third of the way to the face's third corner; the spindle between them and the edge gets
  // `label`. Only tetrahedra that contain the edge are split. Returns how many.
  int split_edge(int u, int v, int label, double reach_mm);

  // New points lie on the edges that leave the point, at most reach_mm from it and at most a third
  // of the way; the ball within gets `label`. Only tetrahedra that contain the point are split.
  // Returns how many.
  int split_point(int point, int label, double reach_mm);

 private:
  // A piece of a split tetrahedron. support[i] is the set (one bit each) of those corners of the
  // parent that points[i] is an average of: a face whose points together miss parent corner f lies
  // on the parent's face f.
  struct Piece {
    int parent;
    std::array<int, 4> points;
    std::array<unsigned, 4> support;
    int label;
  };

  int new_point(const Vec3& from, int towards, double reach_mm);
  void replace(const std::vector<int>& parents, const std::vector<Piece>& pieces);

  TetMesh& mesh_;
  Segments& segments_;
  std::vector<int> tetrahedron_of_point_;
  // what star() needs, kept to spare allocations
  mutable std::vector<int> mark_;
  mutable int last_mark_ = 0;
};

}  // namespace packmerger
