#include "shape/divide/star_split.h"

#include <algorithm>
#include <utility>

namespace packmerger {
namespace {

constexpr double kFraction = 1.0 / 3;  // of the way to the next point, at most

// From a few old points to the new ones made for them.
using PointMap = std::vector<std::pair<int, int>>;

int mapped(const PointMap& map, int point) {
  return std::find_if(map.begin(), map.end(), [point](const auto& p) { return p.first == point; })
      ->second;
}

bool contains(const PointMap& map, int point) {
  return std::any_of(map.begin(), map.end(), [point](const auto& p) { return p.first == point; });
}

int corner_index(const std::array<int, 4>& corners, int point) {
  return static_cast<int>(std::find(corners.begin(), corners.end(), point) - corners.begin());
}

// Whether the order of the four indices 0..3 is an odd permutation.
bool is_odd(const std::array<int, 4>& order) {
  int inversions = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) inversions += order[i] > order[j] ? 1 : 0;
  return inversions % 2 == 1;
}

}  // namespace

StarSplitter::StarSplitter(TetMesh& mesh, Segments& segments)
    : mesh_(mesh), segments_(segments), tetrahedron_of_point_(mesh.points.size(), -1) {
  for (int t = 0; t < mesh.count(); ++t)
    for (const int point : mesh.tetrahedra[t]) tetrahedron_of_point_[point] = t;
}

std::vector<int> StarSplitter::star(int point) const {
  std::vector<int> found;
  if (tetrahedron_of_point_[point] < 0) return found;
  mark_.resize(mesh_.tetrahedra.size(), 0);
  const int visited = ++last_mark_;
  found.push_back(tetrahedron_of_point_[point]);
  mark_[found[0]] = visited;
  for (std::size_t next = 0; next < found.size(); ++next)
    for (int face = 0; face < 4; ++face) {
      const int across = mesh_.neighbours[found[next]][face];
      if (mesh_.tetrahedra[found[next]][face] == point || across < 0 || mark_[across] == visited)
        continue;
      mark_[across] = visited;
      found.push_back(across);
    }
  std::sort(found.begin(), found.end());
  return found;
}

int StarSplitter::new_point(const Vec3& from, int towards, double reach_mm) {
  const Vec3 way = mesh_.points[towards] - from;
  const double length = way.norm();
  const double fraction = length * kFraction > reach_mm ? reach_mm / length : kFraction;
  mesh_.points.push_back(from + fraction * way);
  tetrahedron_of_point_.push_back(-1);
  return static_cast<int>(mesh_.points.size()) - 1;
}

int StarSplitter::split_edge(int u, int v, int label, double reach_mm) {
  std::vector<int> around = star(u);
  std::erase_if(around, [&](int t) { return corner_index(mesh_.tetrahedra[t], v) == 4; });
  const Vec3 middle = (mesh_.points[u] + mesh_.points[v]) / 2;
  PointMap inner;
  std::vector<Piece> pieces;
  for (const int t : around) {
    const std::array<int, 4> corners = mesh_.tetrahedra[t];
    std::array<int, 4> order{corner_index(corners, u), corner_index(corners, v), 0, 0};
    int filled = 2;
    for (int i = 0; i < 4; ++i)
      if (i != order[0] && i != order[1]) order[filled++] = i;
    if (is_odd(order)) std::swap(order[2], order[3]);
    for (int i = 2; i < 4; ++i)
      if (!contains(inner, corners[order[i]]))
        inner.emplace_back(corners[order[i]], new_point(middle, corners[order[i]], reach_mm));

    // (u, v, a, b) is positively oriented; a1 and b1 are the new points. Outside the spindle's
    // (u, v, a1, b1) remains an octahedron, four tetrahedra around its diagonal a–b1.
    const int a = corners[order[2]], b = corners[order[3]];
    const int a1 = mapped(inner, a), b1 = mapped(inner, b);
    const unsigned su = 1u << order[0], sv = 1u << order[1];
    const unsigned sa = 1u << order[2], sb = 1u << order[3];
    const unsigned sa1 = su | sv | sa, sb1 = su | sv | sb;
    const int old = segments_.of_tetrahedron[t];
    pieces.push_back({t, {u, v, a1, b1}, {su, sv, sa1, sb1}, label});
    pieces.push_back({t, {a, b1, u, a1}, {sa, sb1, su, sa1}, old});
    pieces.push_back({t, {a, b1, a1, v}, {sa, sb1, sa1, sv}, old});
    pieces.push_back({t, {a, b1, v, b}, {sa, sb1, sv, sb}, old});
    pieces.push_back({t, {a, b1, b, u}, {sa, sb1, sb, su}, old});
  }
  replace(around, pieces);
  return static_cast<int>(around.size());
}

int StarSplitter::split_point(int point, int label, double reach_mm) {
  const std::vector<int> around = star(point);
  const Vec3 centre = mesh_.points[point];
  PointMap inner;
  std::vector<Piece> pieces;
  for (const int t : around) {
    const std::array<int, 4> corners = mesh_.tetrahedra[t];
    std::array<int, 4> order{corner_index(corners, point), 0, 0, 0};
    int filled = 1;
    for (int i = 0; i < 4; ++i)
      if (i != order[0]) order[filled++] = i;
    for (int i = 1; i < 4; ++i)
      if (!contains(inner, corners[order[i]]))
        inner.emplace_back(corners[order[i]], new_point(centre, corners[order[i]], reach_mm));

    // Beyond the ball's (point, x1, y1, z1) remains a prism. With x < y < z the diagonals of its
    // sides depend on the side alone, so that both tetrahedra beside it cut it the same way.
    std::sort(order.begin() + 1, order.end(),
              [&](int i, int j) { return corners[i] < corners[j]; });
    const int x = corners[order[1]], y = corners[order[2]], z = corners[order[3]];
    const int x1 = mapped(inner, x), y1 = mapped(inner, y), z1 = mapped(inner, z);
    const unsigned sp = 1u << order[0];
    const unsigned sx = 1u << order[1], sy = 1u << order[2], sz = 1u << order[3];
    const unsigned sx1 = sp | sx, sy1 = sp | sy, sz1 = sp | sz;
    const int old = segments_.of_tetrahedron[t];
    const std::size_t first = pieces.size();
    pieces.push_back({t, {point, x1, y1, z1}, {sp, sx1, sy1, sz1}, label});
    pieces.push_back({t, {x1, x, y, z}, {sx1, sx, sy, sz}, old});
    pieces.push_back({t, {y1, x1, y, z}, {sy1, sx1, sy, sz}, old});
    pieces.push_back({t, {x1, y1, z1, z}, {sx1, sy1, sz1, sz}, old});
    if (is_odd(order))
      for (std::size_t i = first; i < pieces.size(); ++i) {
        std::swap(pieces[i].points[0], pieces[i].points[1]);
        std::swap(pieces[i].support[0], pieces[i].support[1]);
      }
  }
  replace(around, pieces);
  return static_cast<int>(around.size());
}

void StarSplitter::replace(const std::vector<int>& parents, const std::vector<Piece>& pieces) {
  struct Old {
    std::array<int, 4> neighbours;
    std::array<FaceSide, 4> sides;
  };
  std::vector<Old> old;
  for (const int t : parents) old.push_back({mesh_.neighbours[t], mesh_.sides[t]});

  struct Face {
    std::array<int, 3> key;
    int tetrahedron;
    int face;
    std::size_t piece;
  };
  std::vector<Face> faces;
  int previous_parent = -1;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    int t = pieces[i].parent;
    if (t == previous_parent) {
      t = mesh_.count();
      mesh_.tetrahedra.emplace_back();
      mesh_.neighbours.push_back({-1, -1, -1, -1});
      mesh_.sides.push_back({});
      segments_.of_tetrahedron.push_back(0);
    }
    previous_parent = pieces[i].parent;
    mesh_.tetrahedra[t] = pieces[i].points;
    segments_.of_tetrahedron[t] = pieces[i].label;
    for (const int point : pieces[i].points) tetrahedron_of_point_[point] = t;
    for (int f = 0; f < 4; ++f) {
      std::array<int, 3> key = face_corners(mesh_, t, f);
      std::sort(key.begin(), key.end());
      faces.push_back({key, t, f, i});
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.key < b.key; });

  const auto link = [&](int t, int f, int other) {
    mesh_.neighbours[t][f] = other;
    mesh_.sides[t][f] = FaceSide::kInterior;
  };
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Face& face = faces[i];
    if (i + 1 < faces.size() && faces[i + 1].key == face.key) {
      link(face.tetrahedron, face.face, faces[i + 1].tetrahedron);
      link(faces[i + 1].tetrahedron, faces[i + 1].face, face.tetrahedron);
      ++i;
      continue;
    }
    // On the star's hull: what lay beyond the parent's face lies beyond this one.
    const Piece& piece = pieces[face.piece];
    unsigned support = 0;
    for (int corner = 0; corner < 4; ++corner)
      if (corner != face.face) support |= piece.support[corner];
    int parent_face = 0;
    while ((support >> parent_face & 1u) != 0) ++parent_face;
    const Old& before =
        old[std::lower_bound(parents.begin(), parents.end(), piece.parent) - parents.begin()];
    const int beyond = before.neighbours[parent_face];
    if (beyond < 0) {
      mesh_.neighbours[face.tetrahedron][face.face] = -1;
      mesh_.sides[face.tetrahedron][face.face] = before.sides[parent_face];
      continue;
    }
    link(face.tetrahedron, face.face, beyond);
    for (int f = 0; f < 4; ++f) {
      std::array<int, 3> key = face_corners(mesh_, beyond, f);
      std::sort(key.begin(), key.end());
      if (key == face.key) link(beyond, f, face.tetrahedron);
    }
  }
}

}  // namespace packmerger
