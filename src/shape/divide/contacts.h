// Which segments share faces. Internal to this folder.
#pragma once

#include <algorithm>
#include <set>
#include <utility>

#include "shape/divide/adjacency.h"

namespace packmerger {

// Asked before a tetrahedron changes hands: two segments that only come to touch by such a change
// would have a tiny cross-section, which is hard to glue.
class Contacts {
 public:
  Contacts(const TetMesh& mesh, const Segments& segments) {
    for (const SegmentEdge& edge : adjacency(mesh, segments)) pairs_.insert({edge.a, edge.b});
  }
  bool has(int a, int b) const { return a == b || pairs_.contains(std::minmax(a, b)); }
  void add(int a, int b) {
    if (a != b) pairs_.insert(std::minmax(a, b));
  }

 private:
  std::set<std::pair<int, int>> pairs_;  // lower label first
};

}  // namespace packmerger
