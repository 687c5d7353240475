#include "shape/divide/manifold_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "base/error.h"
#include "shape/divide/contacts.h"
#include "shape/divide/label_moves.h"
#include "shape/divide/pinch_test.h"
#include "shape/divide/star_split.h"

namespace packmerger {
namespace {

using Edge = std::pair<int, int>;  // lower index first

// One of the segments that meet at a pinch.
struct Candidate {
  int label = 0;
  int pieces = 0;
  double share = 0;  // of the room around the pinch: an angle in any unit
};

// The segment that gets the room around a pinch: no new contacts first, then one that is in one
// piece there (so that nothing is joined by a thin neck), then the one with most room.
int receiver(const std::vector<Candidate>& candidates, Contacts& contacts) {
  const auto rank = [&](const Candidate& c) {
    int new_contacts = 0;
    for (const Candidate& other : candidates)
      new_contacts += contacts.has(c.label, other.label) ? 0 : 1;
    return std::tuple(new_contacts, c.pieces > 1 ? 1 : 0, -c.share, c.label);
  };
  const int label =
      std::min_element(candidates.begin(), candidates.end(),
                       [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); })
          ->label;
  for (const Candidate& other : candidates) contacts.add(label, other.label);
  return label;
}

double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(std::abs(a.dot(b.cross(c))),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

// The solid angle of tetrahedron t at a point of it.
double solid_angle(const TetMesh& mesh, int t, int point) {
  std::array<Vec3, 3> arms;
  int filled = 0;
  for (const int other : mesh.tetrahedra[t])
    if (other != point) arms[filled++] = mesh.points[other] - mesh.points[point];
  return solid_angle(arms[0], arms[1], arms[2]);
}

// The angle of tetrahedron t around an edge of it.
double dihedral_angle(const TetMesh& mesh, int t, const Edge& edge) {
  const Vec3 axis = (mesh.points[edge.second] - mesh.points[edge.first]).normalized();
  std::array<Vec3, 2> arms;
  int filled = 0;
  for (const int other : mesh.tetrahedra[t]) {
    if (other == edge.first || other == edge.second) continue;
    const Vec3 arm = mesh.points[other] - mesh.points[edge.first];
    arms[filled++] = arm - arm.dot(axis) * axis;
  }
  return std::atan2(arms[0].cross(arms[1]).norm(), arms[0].dot(arms[1]));
}

bool has_corner(const TetMesh& mesh, int t, int point) {
  const std::array<int, 4>& corners = mesh.tetrahedra[t];
  return std::find(corners.begin(), corners.end(), point) != corners.end();
}

// The segments around an edge; pieces are runs of tetrahedra that share faces containing the edge.
std::vector<Candidate> around_edge(const TetMesh& mesh, const std::vector<int>& labels,
                                   const Edge& edge, const std::vector<int>& star_of_first) {
  std::vector<int> ring;
  for (const int t : star_of_first)
    if (has_corner(mesh, t, edge.second)) ring.push_back(t);
  std::vector<Candidate> found;
  int whole_ring = 0;
  for (const int t : ring) {
    auto one = std::find_if(found.begin(), found.end(),
                            [&](const Candidate& c) { return c.label == labels[t]; });
    if (one == found.end()) one = found.insert(one, {labels[t], 0, 0});
    one->share += dihedral_angle(mesh, t, edge);
    // A run of n tetrahedra has n - 1 inner faces, so the two faces of each, halved, miss one a
    // run.
    int inner = 0;
    for (int face = 0; face < 4; ++face) {
      const int corner = mesh.tetrahedra[t][face];
      const int across = mesh.neighbours[t][face];
      if (corner == edge.first || corner == edge.second || across < 0) continue;
      inner += labels[across] == labels[t] ? 1 : 0;
    }
    one->pieces += 2 - inner;
    whole_ring += inner;
  }
  for (Candidate& one : found) one.pieces /= 2;
  if (whole_ring == 2 * static_cast<int>(ring.size())) found.front().pieces = 1;  // a closed ring
  return found;
}

std::vector<Candidate> around_point(const TetMesh& mesh, const std::vector<int>& labels, int point,
                                    const std::vector<int>& star, PinchTest& test) {
  std::vector<Candidate> found;
  for (const PinchTest::Share& share : test.shares(mesh, labels, point, star)) {
    Candidate one{share.label, share.pieces, 0};
    for (const int t : star)
      if (labels[t] == share.label) one.share += solid_angle(mesh, t, point);
    found.push_back(one);
  }
  return found;
}

bool is_pinched(const std::vector<Candidate>& around) {
  return std::any_of(around.begin(), around.end(), [](const Candidate& c) { return c.pieces > 1; });
}

std::vector<int> pinched_points(const TetMesh& mesh, const Segments& segments) {
  const Stars stars(mesh);
  PinchTest test;
  std::vector<int> found;
  for (int point = 0; point < static_cast<int>(mesh.points.size()); ++point) {
    const auto star = stars.of(point);
    if (!star.empty() && test.defects(mesh, segments.of_tetrahedron, point, star) > 0)
      found.push_back(point);
  }
  return found;
}

// An edge is pinched only where its ends are.
std::vector<Edge> pinched_edges(const TetMesh& mesh, const Segments& segments,
                                const std::vector<int>& points, const StarSplitter& splitter) {
  std::vector<Edge> found;
  std::vector<int> others;
  for (const int point : points) {
    const std::vector<int> star = splitter.star(point);
    others.clear();
    for (const int t : star)
      for (const int other : mesh.tetrahedra[t])
        if (other > point && std::binary_search(points.begin(), points.end(), other))
          others.push_back(other);
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (const int other : others)
      if (is_pinched(around_edge(mesh, segments.of_tetrahedron, {point, other}, star)))
        found.push_back({point, other});
  }
  return found;
}

int split_pinched(TetMesh& mesh, Segments& segments, double reach_mm, const Progress& progress) {
  const std::vector<int> points = pinched_points(mesh, segments);
  if (points.empty()) return 0;
  StarSplitter splitter(mesh, segments);
  Contacts contacts(mesh, segments);
  PinchTest test;
  const std::vector<int>& labels = segments.of_tetrahedron;
  int count = 0;
  for (const Edge& edge : pinched_edges(mesh, segments, points, splitter)) {
    progress.check();
    const auto around = around_edge(mesh, labels, edge, splitter.star(edge.first));
    count += splitter.split_edge(edge.first, edge.second, receiver(around, contacts), reach_mm);
  }
  for (const int point : points) {
    progress.check();
    const std::vector<int> star = splitter.star(point);
    if (test.defects(mesh, labels, point, star) == 0) continue;
    const auto around = around_point(mesh, labels, point, star, test);
    count += splitter.split_point(point, receiver(around, contacts), reach_mm);
  }
  return count;
}

}  // namespace

ManifoldChange make_manifold(TetMesh& mesh, Segments& segments, const Progress& progress,
                             double reach_mm) {
  ManifoldChange change;
  change.reassigned = reassign_pinched(mesh, segments, reach_mm, progress);
  change.split = split_pinched(mesh, segments, reach_mm, progress);
  if (change.split > 0 && !is_manifold(mesh, segments))
    throw Error(
        Fault::kInternal,
        "Parts stay pinched although they were cut free: the shell's own surface is pinched",
        "Repair the model in a mesh editor and try again.");
  return change;
}

bool is_manifold(const TetMesh& mesh, const Segments& segments) {
  return pinched_points(mesh, segments).empty();
}

}  // namespace packmerger
