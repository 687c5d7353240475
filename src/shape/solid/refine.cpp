#include "shape/solid/refine.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace packmerger {
namespace {

using Edge = std::pair<int, int>;  // lower number first

Edge edge_of(int a, int b) { return a < b ? Edge(a, b) : Edge(b, a); }

struct EdgeHash {
  std::size_t operator()(const Edge& edge) const {
    return (static_cast<std::uint64_t>(edge.first) << 32 |
            static_cast<std::uint32_t>(edge.second)) *
           0x9e3779b97f4a7c15ull;
  }
};

// Longest first; equal lengths in order of the corners.
using LongEdge = std::tuple<double, int, int>;

class SurfaceSplitter {
 public:
  SurfaceSplitter(TriangleSoup& soup, std::vector<int>& markers, double max_edge_mm)
      : soup_(soup), markers_(markers), max_squared_(max_edge_mm * max_edge_mm) {
    for (std::size_t i = 0; i < soup.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const int a = soup.triangles[i][k];
        const int b = soup.triangles[i][(k + 1) % 3];
        triangles_at_[edge_of(a, b)].push_back(static_cast<int>(i));
        if (a < b) consider(a, b);
      }
  }

  void run() {
    while (!long_edges_.empty()) {
      const auto [length, minus_a, minus_b] = long_edges_.top();
      long_edges_.pop();
      split(-minus_a, -minus_b);
    }
  }

 private:
  void consider(int a, int b) {
    const double squared = (soup_.points[a] - soup_.points[b]).squaredNorm();
    if (squared > max_squared_) long_edges_.emplace(squared, -std::min(a, b), -std::max(a, b));
  }

  void replace(int a, int b, int from, int to) {
    auto& triangles = triangles_at_.at(edge_of(a, b));
    std::replace(triangles.begin(), triangles.end(), from, to);
  }

  // Each edge stays queued until it is split, and is split once.
  void split(int a, int b) {
    const int middle = static_cast<int>(soup_.points.size());
    soup_.points.push_back((soup_.points[a] + soup_.points[b]) / 2);
    const auto entry = triangles_at_.find(Edge(a, b));
    const std::vector<int> triangles = std::move(entry->second);
    triangles_at_.erase(entry);
    for (const int triangle : triangles) split_triangle(triangle, a, b, middle);
    consider(a, middle);
    consider(middle, b);
  }

  void split_triangle(int triangle, int a, int b, int middle) {
    auto& corners = soup_.triangles[triangle];
    const int added = static_cast<int>(soup_.triangles.size());
    const int apex = corners[0] + corners[1] + corners[2] - a - b;
    auto other = corners;
    std::replace(corners.begin(), corners.end(), b, middle);
    std::replace(other.begin(), other.end(), a, middle);
    soup_.triangles.push_back(other);
    markers_.push_back(markers_[triangle]);
    replace(b, apex, triangle, added);
    triangles_at_[edge_of(a, middle)].push_back(triangle);
    triangles_at_[edge_of(middle, b)].push_back(added);
    triangles_at_[edge_of(middle, apex)] = {triangle, added};
    consider(middle, apex);
  }

  TriangleSoup& soup_;
  std::vector<int>& markers_;
  double max_squared_;
  std::unordered_map<Edge, std::vector<int>, EdgeHash> triangles_at_;
  std::priority_queue<LongEdge> long_edges_;
};

class TetSplitter {
 public:
  TetSplitter(TetMesh& mesh, double max_volume_mm3) : mesh_(mesh), max_volume_(max_volume_mm3) {
    at_point_.resize(mesh.points.size());
    for (int t = 0; t < mesh.count(); ++t) {
      for (const int corner : mesh.tetrahedra[t]) at_point_[corner].push_back(t);
      consider(t);
    }
  }

  void run() {
    while (!large_.empty()) {
      const auto [volume, minus_t] = large_.top();
      large_.pop();
      const int t = -minus_t;
      // A tetrahedron may have shrunk, or grown small pieces, since it was queued.
      if (mesh_.volume_mm3(t) != volume) continue;
      split(propagated(longest_edge(t)));
      consider(t);
    }
    link_neighbours(mesh_);
  }

 private:
  void consider(int t) {
    const double volume = mesh_.volume_mm3(t);
    if (volume > max_volume_) large_.emplace(volume, -t);
  }

  LongEdge longest_edge(int t) const {
    const auto& c = mesh_.tetrahedra[t];
    LongEdge longest(-1, 0, 0);
    for (int i = 0; i < 4; ++i)
      for (int k = i + 1; k < 4; ++k)
        longest =
            std::max(longest, LongEdge((mesh_.points[c[i]] - mesh_.points[c[k]]).squaredNorm(),
                                       -std::min(c[i], c[k]), -std::max(c[i], c[k])));
    return longest;
  }

  std::vector<int> around(int a, int b) const {
    std::vector<int> tets;
    for (const int t : at_point_[a]) {
      const auto& corners = mesh_.tetrahedra[t];
      if (std::find(corners.begin(), corners.end(), b) != corners.end()) tets.push_back(t);
    }
    return tets;
  }

  // The edge from which no tetrahedron around leads to a longer one. The lengths (with the corners
  // as tie-break) grow strictly, so the walk ends.
  Edge propagated(LongEdge edge) const {
    for (;;) {
      const auto [length, minus_a, minus_b] = edge;
      LongEdge longest = edge;
      for (const int t : around(-minus_a, -minus_b)) longest = std::max(longest, longest_edge(t));
      if (longest == edge) return {-minus_a, -minus_b};
      edge = longest;
    }
  }

  void split(const Edge& edge) {
    const auto [a, b] = edge;
    const int middle = static_cast<int>(mesh_.points.size());
    mesh_.points.push_back((mesh_.points[a] + mesh_.points[b]) / 2);
    at_point_.emplace_back();
    for (const int t : around(a, b)) {
      const int added = mesh_.count();
      mesh_.tetrahedra.push_back(mesh_.tetrahedra[t]);
      mesh_.sides.push_back(mesh_.sides[t]);
      mesh_.neighbours.push_back(mesh_.neighbours[t]);
      cut(t, b, a, middle);
      cut(added, a, b, middle);
      std::erase(at_point_[b], t);
      for (const int corner : mesh_.tetrahedra[added]) at_point_[corner].push_back(added);
      at_point_[middle].push_back(t);
      consider(t);
      consider(added);
    }
  }

  // Corner `gone` moves to the middle; the face opposite `kept` is now the cut.
  void cut(int t, int gone, int kept, int middle) {
    for (int i = 0; i < 4; ++i) {
      if (mesh_.tetrahedra[t][i] == kept) mesh_.sides[t][i] = FaceSide::kInterior;
      if (mesh_.tetrahedra[t][i] == gone) mesh_.tetrahedra[t][i] = middle;
    }
  }

  TetMesh& mesh_;
  double max_volume_;
  std::vector<std::vector<int>> at_point_;  // tetrahedra around each point
  std::priority_queue<std::pair<double, int>> large_;
};

}  // namespace

void split_long_edges(TriangleSoup& soup, std::vector<int>& markers, double max_edge_mm) {
  SurfaceSplitter(soup, markers, max_edge_mm).run();
}

void split_large_tetrahedra(TetMesh& mesh, double max_volume_mm3) {
  TetSplitter(mesh, max_volume_mm3).run();
}

}  // namespace packmerger
