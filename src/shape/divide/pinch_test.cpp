#include "shape/divide/pinch_test.h"

#include <algorithm>
#include <cstdlib>

namespace packmerger {

Stars::Stars(const TetMesh& mesh) : first_(mesh.points.size() + 1, 0) {
  for (const auto& corners : mesh.tetrahedra)
    for (const int point : corners) ++first_[point + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  tetrahedra_.resize(first_.back());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int t = 0; t < mesh.count(); ++t)
    for (const int point : mesh.tetrahedra[t]) tetrahedra_[next[point]++] = t;
}

const std::vector<PinchTest::Share>& PinchTest::shares(const TetMesh& mesh,
                                                       const std::vector<int>& labels, int point,
                                                       std::span<const int> star) {
  shares_.clear();
  tetrahedron_mark_.resize(mesh.tetrahedra.size(), 0);
  point_mark_.resize(mesh.points.size(), 0);

  // Pieces, by flooding; `shared` counts every face between two tetrahedra of a piece twice.
  const int visited = next_mark();
  for (const int start : star) {
    if (tetrahedron_mark_[start] == visited) continue;
    const int label = labels[start];
    auto share = std::find_if(shares_.begin(), shares_.end(),
                              [label](const Share& s) { return s.label == label; });
    if (share == shares_.end()) share = shares_.insert(share, Share{label, 0, 0, 0});
    ++share->pieces;
    int shared = 0;
    int size = 0;
    tetrahedron_mark_[start] = visited;
    stack_.assign(1, start);
    while (!stack_.empty()) {
      const int t = stack_.back();
      stack_.pop_back();
      ++size;
      for (int face = 0; face < 4; ++face) {
        const int across = mesh.neighbours[t][face];
        if (mesh.tetrahedra[t][face] == point || across < 0 || labels[across] != label) continue;
        ++shared;
        if (tetrahedron_mark_[across] == visited) continue;
        tetrahedron_mark_[across] = visited;
        stack_.push_back(across);
      }
    }
    // In the link a tetrahedron is a triangle and a face containing the point is an edge.
    share->tetrahedra += size;
    share->euler += size - (3 * size - shared / 2);
  }

  // The link's vertices: the other corners.
  for (Share& share : shares_) {
    const int counted = next_mark();
    for (const int t : star) {
      if (labels[t] != share.label) continue;
      for (const int other : mesh.tetrahedra[t]) {
        if (other == point || point_mark_[other] == counted) continue;
        point_mark_[other] = counted;
        ++share.euler;
      }
    }
  }
  return shares_;
}

int PinchTest::defects(const TetMesh& mesh, const std::vector<int>& labels, int point,
                       std::span<const int> star) {
  if (std::all_of(star.begin(), star.end(),
                  [&](int t) { return labels[t] == labels[star.front()]; }))
    return 0;
  int sum = 0;
  for (const Share& share : shares(mesh, labels, point, star))
    sum += share.pieces - 1 + std::abs(share.euler - 1);
  return sum;
}

}  // namespace packmerger
