#include "shape/cut/cut_tree.h"

#include <algorithm>
#include <numeric>

namespace packmerger {
namespace {

// The node where everything in this region ends up or is divided for good.
class Ends {
 public:
  explicit Ends(const CutTree& tree) : tree_(tree), end_(tree.size(), -1) {}
  int of(int node) {
    if (end_[node] >= 0) return end_[node];
    const CutNode& one = tree_[node];
    int end = node;
    if (!one.next.empty()) {
      const int first = of(one.next.front());
      const bool undivided = std::all_of(one.next.begin(), one.next.end(),
                                         [&](int next) { return of(next) == first; });
      if (undivided) end = first;
    }
    return end_[node] = end;
  }

 private:
  const CutTree& tree_;
  std::vector<int> end_;
};

// Every node that is reached, each after all that lead to it.
void append_in_order(const CutTree& tree, int node, Ends& ends, std::vector<char>& seen,
                     std::vector<int>& reversed) {
  if (seen[node]) return;
  seen[node] = 1;
  for (const int next : tree[node].next) append_in_order(tree, ends.of(next), ends, seen, reversed);
  reversed.push_back(node);
}

// Gives each face-connected piece of the region to the one of node.next whose samples it holds.
void hand_out_pieces(const TetMesh& mesh, int region, const CutNode& node, Ends& ends,
                     const PlaneCutter& cutter, const MatterSamples& samples, double least_mm3,
                     std::vector<int>& labels) {
  std::vector<int> next_of_sample(samples.count(), -1);
  for (std::size_t i = 0; i < node.members->size(); ++i)
    for (const int sample : (*node.members)[i]) next_of_sample[sample] = static_cast<int>(i);
  std::vector<char> seen(mesh.tetrahedra.size(), 0);
  for (int start = 0; start < mesh.count(); ++start) {
    if (labels[start] != region || seen[start]) continue;
    std::vector<double> votes(node.next.size(), 0);
    std::vector<int> piece{start};
    seen[start] = 1;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const int t = piece[i];
      const int next = next_of_sample[samples.of_tetrahedron[cutter.origin(t)]];
      if (next >= 0) votes[next] += mesh.volume_mm3(t);
      for (const int across : mesh.neighbours[t]) {
        if (across < 0 || labels[across] != region || seen[across]) continue;
        seen[across] = 1;
        piece.push_back(across);
      }
    }
    const auto most = std::max_element(votes.begin(), votes.end()) - votes.begin();
    // Where a neck too thin for the samples holds large pieces together, it is cut along them.
    const bool follow_samples =
        std::accumulate(votes.begin(), votes.end(), 0.0) - votes[most] > least_mm3;
    for (const int t : piece) {
      const int next = next_of_sample[samples.of_tetrahedron[cutter.origin(t)]];
      labels[t] = ends.of(node.next[follow_samples && next >= 0 ? next : most]);
    }
  }
}

}  // namespace

Segments cut_apart(TetMesh& mesh, const CutTree& tree, const MatterSamples& samples,
                   double least_mm3, const Progress& progress) {
  Ends ends(tree);
  std::vector<char> seen(tree.size(), 0);
  std::vector<int> order;
  append_in_order(tree, ends.of(0), ends, seen, order);
  std::reverse(order.begin(), order.end());

  std::vector<int> labels(mesh.tetrahedra.size(), ends.of(0));
  PlaneCutter cutter(mesh, labels);
  for (const int region : order) {
    progress.check();
    const CutNode& node = tree[region];
    if (node.kind == CutNode::Kind::kPlane)
      cutter.cut(region, node.plane, ends.of(node.next[0]), ends.of(node.next[1]));
    if (node.kind == CutNode::Kind::kPieces) {
      cutter.link();
      hand_out_pieces(mesh, region, node, ends, cutter, samples, least_mm3, labels);
    }
  }
  cutter.link();
  return connected_segments(mesh, labels, least_mm3);
}

}  // namespace packmerger
