#include "shape/divide/smooth_cuts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>
#include <vector>

#include "shape/divide/adjacency.h"
#include "shape/divide/label_moves.h"
#include "shape/divide/pinch_test.h"
#include "shape/divide/surface_walk.h"

namespace packmerger {
namespace {

constexpr double kCreaseAngle = 40 * std::numbers::pi / 180;
constexpr double kTolerance_mm = 0.07;        // sampled; the promise is 0.1
constexpr double kLeastVolumeFraction = 0.1;  // of a tetrahedron's volume at the start
constexpr double kVolumeFraction = 5e-4;      // of V_o, that all moves together may add or take
constexpr int kHalvings = 3;                  // of a step that is too long

// For every point on a cut the points its position is averaged from.
struct CutNet {
  std::vector<int> points;                   // ascending
  std::vector<std::vector<int>> neighbours;  // same order
};

// An edge of a face between two segments.
struct CutEdge {
  int a, b;   // a < b
  int faces;  // between two segments, around the edge
};

std::vector<CutEdge> cut_face_edges(const TetMesh& mesh, const std::vector<int>& labels) {
  std::vector<std::array<int, 2>> all;
  for (int t = 0; t < mesh.count(); ++t)
    for (int f = 0; f < 4; ++f) {
      const int across = mesh.neighbours[t][f];
      if (across < t || labels[across] == labels[t]) continue;
      const std::array<int, 3> corners = face_corners(mesh, t, f);
      for (int i = 0; i < 3; ++i) {
        const auto [a, b] = std::minmax(corners[i], corners[(i + 1) % 3]);
        all.push_back({a, b});
      }
    }
  std::sort(all.begin(), all.end());
  std::vector<CutEdge> edges;
  for (const auto& [a, b] : all) {
    if (!edges.empty() && edges.back().a == a && edges.back().b == b)
      ++edges.back().faces;
    else
      edges.push_back({a, b, 1});
  }
  return edges;
}

// Points on the surface follow the cut curves; points inside follow the curves where three segments
// meet, if they lie on one, and the cut's surface otherwise.
CutNet cut_net(const TetMesh& mesh, const Segments& segments) {
  std::set<std::array<int, 2>> curves;
  for (const FaceSide side : {FaceSide::kOutside, FaceSide::kCavity})
    for (const auto& edge : cut_edges(mesh, segments, side)) curves.insert(edge);
  std::vector<char> on_surface(mesh.points.size(), 0);
  for (int t = 0; t < mesh.count(); ++t)
    for (int f = 0; f < 4; ++f)
      if (mesh.neighbours[t][f] < 0)
        for (const int corner : face_corners(mesh, t, f)) on_surface[corner] = 1;

  struct Ways {
    std::vector<int> curve, junction, surface;
  };
  std::vector<Ways> ways(mesh.points.size());
  const auto note = [&](int point, int other, const CutEdge& edge) {
    Ways& at = ways[point];
    if (on_surface[point]) {
      if (curves.contains({edge.a, edge.b})) at.curve.push_back(other);
      return;
    }
    at.surface.push_back(other);
    if (edge.faces > 2) at.junction.push_back(other);
  };
  for (const CutEdge& edge : cut_face_edges(mesh, segments.of_tetrahedron)) {
    note(edge.a, edge.b, edge);
    note(edge.b, edge.a, edge);
  }
  CutNet net;
  for (int point = 0; point < static_cast<int>(ways.size()); ++point) {
    Ways& at = ways[point];
    std::vector<int>& chosen = !at.curve.empty()      ? at.curve
                               : !at.junction.empty() ? at.junction
                                                      : at.surface;
    if (chosen.empty()) continue;
    net.points.push_back(point);
    net.neighbours.push_back(std::move(chosen));
  }
  return net;
}

// Moves points one by one and keeps what must be kept.
class Smoother {
 public:
  explicit Smoother(TetMesh& mesh)
      : mesh_(mesh), stars_(mesh), walk_(mesh, kCreaseAngle), face_of_(mesh.points.size(), -1) {
    for (int t = 0; t < mesh.count(); ++t)
      least_volumes_.push_back(kLeastVolumeFraction * mesh.volume_mm3(t));
    gain_limit_mm3_ = kVolumeFraction * total_volume_mm3(mesh);
    for (std::size_t point = 0; point < mesh.points.size(); ++point)
      if (const auto faces = walk_.faces_at(static_cast<int>(point)); !faces.empty())
        face_of_[point] = faces.front();
  }

  // Moves the point to the target or some way towards it, if at all.
  void move(int point, const Vec3& target) {
    const bool on_surface = face_of_[point] >= 0;
    if (on_surface && walk_.freedom(point) == Freedom::kNone) return;
    const Vec3 start = mesh_.points[point];
    const double volume = star_volume_mm3(point);
    double step = 1;
    for (int halving = 0; halving <= kHalvings; ++halving, step /= 2) {
      const SurfaceWalk::Place place = allowed_place(point, start + step * (target - start));
      mesh_.points[point] = place.point;
      if (!volumes_are_kept(point)) continue;
      const double gained = on_surface ? star_volume_mm3(point) - volume : 0;
      if (std::abs(gained_mm3_ + gained) > gain_limit_mm3_) continue;
      if (!on_surface || surface_is_kept(point, place)) {
        face_of_[point] = place.face;
        gained_mm3_ += gained;
        return;
      }
    }
    mesh_.points[point] = start;
  }

 private:
  SurfaceWalk::Place allowed_place(int point, const Vec3& wish) const {
    if (face_of_[point] < 0) return {wish, -1};
    if (walk_.freedom(point) == Freedom::kCrease)
      return {walk_.nearest_on_crease(wish, point), face_of_[point]};
    return walk_.nearest(wish, face_of_[point]);
  }

  double star_volume_mm3(int point) const {
    double sum = 0;
    for (const int t : stars_.of(point)) sum += mesh_.volume_mm3(t);
    return sum;
  }

  bool volumes_are_kept(int point) const {
    const auto star = stars_.of(point);
    return std::all_of(star.begin(), star.end(),
                       [&](int t) { return mesh_.volume_mm3(t) > least_volumes_[t]; });
  }

  // The surface around a moved point against the surface as it was.
  bool surface_is_kept(int point, const SurfaceWalk::Place& place) {
    ring_.clear();
    for (const int face : walk_.faces_at(point))
      for (const int corner : walk_.surface().faces[face].corners)
        if (corner != point) ring_.push_back(corner);
    std::sort(ring_.begin(), ring_.end());
    ring_.erase(std::unique(ring_.begin(), ring_.end()), ring_.end());
    return lies_flat(point, place) ||
           (new_faces_are_near(point, place.face) && old_faces_are_near(point));
  }

  // Both surfaces lie in one thin slab and nowhere turn back, as a fin's tip does: the cheap test
  // that nearly always does.
  bool lies_flat(int point, const SurfaceWalk::Place& place) const {
    const Vec3 normal = walk_.normal(place.face);
    const auto is_in_slab = [&](const Vec3& p) {
      return std::abs(normal.dot(p - place.point)) <= kTolerance_mm / 2;
    };
    const auto looks_up = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      return (b - a).cross(c - a).dot(normal) > 0;
    };
    const auto faces = walk_.faces_at(point);
    return is_in_slab(walk_.home(point)) &&
           std::all_of(ring_.begin(), ring_.end(),
                       [&](int other) {
                         return is_in_slab(mesh_.points[other]) && is_in_slab(walk_.home(other));
                       }) &&
           std::all_of(faces.begin(), faces.end(), [&](int face) {
             const auto [a, b, c] = walk_.surface().faces[face].corners;
             return looks_up(mesh_.points[a], mesh_.points[b], mesh_.points[c]) &&
                    looks_up(walk_.home(a), walk_.home(b), walk_.home(c));
           });
  }

  // Samples of the faces at the point as they are, against the surface as it was.
  bool new_faces_are_near(int point, int from) const {
    const auto faces = walk_.faces_at(point);
    return std::all_of(faces.begin(), faces.end(), [&](int face) {
      const auto [a, b, c] = walk_.surface().faces[face].corners;
      return all_samples(mesh_.points[a], mesh_.points[b], mesh_.points[c],
                         [&](const Vec3& p) { return is_near(walk_.nearest(p, from).point, p); });
    });
  }

  // Samples of the faces at the point as they were, against the surface as it is nearby.
  bool old_faces_are_near(int point) const {
    const auto is_near_faces_at = [&](const Vec3& p, int centre) {
      const auto faces = walk_.faces_at(centre);
      return std::any_of(faces.begin(), faces.end(), [&](int face) {
        const auto [a, b, c] = walk_.surface().faces[face].corners;
        return is_near(nearest_on_triangle(p, mesh_.points[a], mesh_.points[b], mesh_.points[c]),
                       p);
      });
    };
    const auto faces = walk_.faces_at(point);
    return std::all_of(faces.begin(), faces.end(), [&](int face) {
      const auto [a, b, c] = walk_.surface().faces[face].corners;
      return all_samples(walk_.home(a), walk_.home(b), walk_.home(c), [&](const Vec3& p) {
        return is_near_faces_at(p, point) ||
               std::any_of(ring_.begin(), ring_.end(),
                           [&](int other) { return is_near_faces_at(p, other); });
      });
    });
  }

  static bool is_near(const Vec3& a, const Vec3& b) {
    return (a - b).squaredNorm() <= kTolerance_mm * kTolerance_mm;
  }

  template <typename Test>
  static bool all_samples(const Vec3& a, const Vec3& b, const Vec3& c, const Test& test) {
    return test(a) && test(b) && test(c) && test((a + b) / 2) && test((b + c) / 2) &&
           test((c + a) / 2) && test((a + b + c) / 3) && test((4 * a + b + c) / 6) &&
           test((a + 4 * b + c) / 6) && test((a + b + 4 * c) / 6);
  }

  TetMesh& mesh_;
  Stars stars_;
  SurfaceWalk walk_;
  std::vector<int>
      face_of_;  // the face of the surface as it was that a boundary point lies on, or -1
  std::vector<double> least_volumes_;
  double gain_limit_mm3_ = 0;
  double gained_mm3_ = 0;  // by the moves so far: the surface is not flat
  std::vector<int> ring_;
};

}  // namespace

double cut_roughness(const TetMesh& mesh, const Segments& segments) {
  double sum = 0;
  int count = 0;
  for (const FaceSide side : {FaceSide::kOutside, FaceSide::kCavity}) {
    std::vector<std::array<int, 2>> ends;  // point, the other end
    for (const auto& [a, b] : cut_edges(mesh, segments, side)) {
      ends.push_back({a, b});
      ends.push_back({b, a});
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 0, next = 0; i < ends.size(); i = next) {
      while (next < ends.size() && ends[next][0] == ends[i][0]) ++next;
      if (next - i != 2) continue;
      const Vec3 in = mesh.points[ends[i][0]] - mesh.points[ends[i][1]];
      const Vec3 out = mesh.points[ends[i + 1][1]] - mesh.points[ends[i][0]];
      sum += std::atan2(in.cross(out).norm(), in.dot(out));
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

CutRoughness smooth_cuts(TetMesh& mesh, Segments& segments, const ShapeSettings& settings,
                         const Progress& progress) {
  CutRoughness roughness{cut_roughness(mesh, segments), 0};
  straighten_cuts(mesh, segments, progress);
  const CutNet net = cut_net(mesh, segments);
  Smoother smoother(mesh);
  for (int round = 0; round < settings.smooth_rounds; ++round) {
    progress.report("smoothing cuts", static_cast<double>(round) / settings.smooth_rounds);
    for (std::size_t i = 0; i < net.points.size(); ++i) {
      Vec3 mean = Vec3::Zero();
      for (const int other : net.neighbours[i]) mean += mesh.points[other];
      smoother.move(net.points[i], mean / static_cast<double>(net.neighbours[i].size()));
    }
  }
  roughness.after_rad = cut_roughness(mesh, segments);
  return roughness;
}

}  // namespace packmerger
