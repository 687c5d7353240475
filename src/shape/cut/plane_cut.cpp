#include "shape/cut/plane_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shape/divide/adjacency.h"

namespace packmerger {
namespace {

constexpr double kLeastLeft = 0.2;      // of a tetrahedron's volume after a point was moved
constexpr double kFurthest = 3;         // a point moves at most this many snapping distances
constexpr double kLeastFreedom = 0.25;  // of a plane's normal within earlier planes

constexpr int kEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

std::uint64_t edge_key(int a, int b) {
  const auto [low, high] = std::minmax(a, b);
  return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
}

// What is left of `normal` for a point that has to stay on other planes.
Vec3 free_direction(const Vec3& normal, const std::vector<Vec3>& held_normals) {
  std::vector<Vec3> basis;
  Vec3 left = normal;
  for (const Vec3& held : held_normals) {
    Vec3 next = held;
    for (const Vec3& b : basis) next -= b.dot(next) * b;
    if (next.norm() < kLeastFreedom) continue;
    basis.push_back(next.normalized());
    left -= basis.back().dot(left) * basis.back();
  }
  return left;
}

}  // namespace

PlaneCutter::PlaneCutter(TetMesh& mesh, std::vector<int>& labels) : mesh_(mesh), labels_(labels) {
  for (int t = 0; t < mesh.count(); ++t) origin_.push_back(t);
}

bool PlaneCutter::may_move(const std::vector<int>& star, int point, const Vec3& to) {
  const Vec3 from = mesh_.points[point];
  std::vector<double> before;
  for (const int t : star) before.push_back(mesh_.volume_mm3(t));
  mesh_.points[point] = to;
  bool good = true;
  for (std::size_t i = 0; i < star.size(); ++i)
    good = good && mesh_.volume_mm3(star[i]) > kLeastLeft * before[i];
  mesh_.points[point] = from;
  return good;
}

void PlaneCutter::snap(const std::vector<int>& region, const Plane& plane) {
  std::map<int, std::vector<int>> stars;
  for (const int t : region)
    for (const int point : mesh_.tetrahedra[t])
      if (std::abs(plane.signedDistance(mesh_.points[point])) <= kOnPlane_mm) stars[point];
  if (stars.empty()) return;
  std::vector<char> is_near(mesh_.points.size(), 0);
  for (const auto& [point, star] : stars) is_near[point] = 1;
  for (int t = 0; t < mesh_.count(); ++t)
    for (const int point : mesh_.tetrahedra[t])
      if (is_near[point]) stars[point].push_back(t);
  const int id = static_cast<int>(planes_.size()) - 1;
  for (const auto& [point, star] : stars) {
    std::vector<int>& held = held_[point];
    std::vector<Vec3> normals;
    for (const int other : held) normals.push_back(planes_[other].normal());
    const double distance = plane.signedDistance(mesh_.points[point]);
    const Vec3 way = free_direction(plane.normal(), normals);
    if (way.norm() >= kLeastFreedom) {
      const Vec3 shift = -distance / way.squaredNorm() * way;
      const Vec3 to = mesh_.points[point] + shift;
      if (shift.norm() <= kFurthest * kOnPlane_mm && may_move(star, point, to))
        mesh_.points[point] = to;
    }
    held.push_back(id);
  }
}

int PlaneCutter::middle_of(int a, int b) const {
  const std::uint64_t key = edge_key(a, b);
  const auto found = std::lower_bound(middles_.begin(), middles_.end(), std::pair(key, -1));
  return found != middles_.end() && found->first == key ? found->second : -1;
}

void PlaneCutter::bisect(int tetrahedron) {
  // The lowest edge first, everywhere: so both sides of a face are cut the same way.
  open_.assign(1, tetrahedron);
  while (!open_.empty()) {
    const int t = open_.back();
    open_.pop_back();
    const std::array<int, 4> corners = mesh_.tetrahedra[t];
    int from = -1, to = -1, middle = -1;
    std::uint64_t lowest = 0;
    for (const auto& [i, j] : kEdges) {
      const std::uint64_t key = edge_key(corners[i], corners[j]);
      if (middle >= 0 && key >= lowest) continue;
      const int on_edge = middle_of(corners[i], corners[j]);
      if (on_edge < 0) continue;
      lowest = key;
      from = i;
      to = j;
      middle = on_edge;
    }
    if (middle < 0) continue;
    const int added = mesh_.count();
    mesh_.tetrahedra.push_back(corners);
    mesh_.sides.push_back(std::array<FaceSide, 4>(mesh_.sides[t]));
    mesh_.neighbours.push_back({-1, -1, -1, -1});
    labels_.push_back(labels_[t]);
    origin_.push_back(origin_[t]);
    mesh_.tetrahedra[t][to] = middle;
    mesh_.sides[t][from] = FaceSide::kInterior;
    mesh_.tetrahedra[added][from] = middle;
    mesh_.sides[added][to] = FaceSide::kInterior;
    open_.push_back(t);
    open_.push_back(added);
  }
}

void PlaneCutter::cut(int label, const Plane& plane, int below, int above) {
  std::vector<int> region;
  for (int t = 0; t < mesh_.count(); ++t)
    if (labels_[t] == label) region.push_back(t);
  planes_.push_back(plane);
  snap(region, plane);

  const auto height = [&](int point) { return plane.signedDistance(mesh_.points[point]); };
  middles_.clear();
  for (const int t : region)
    for (const auto& [i, j] : kEdges) {
      const double a = height(mesh_.tetrahedra[t][i]), b = height(mesh_.tetrahedra[t][j]);
      if (std::min(a, b) < -kOnPlane_mm && std::max(a, b) > kOnPlane_mm)
        middles_.emplace_back(edge_key(mesh_.tetrahedra[t][i], mesh_.tetrahedra[t][j]), -1);
    }
  std::sort(middles_.begin(), middles_.end());
  middles_.erase(std::unique(middles_.begin(), middles_.end()), middles_.end());
  std::vector<char> is_end(mesh_.points.size(), 0);
  for (auto& [key, middle] : middles_) {
    const int a = static_cast<int>(key >> 32), b = static_cast<int>(key & 0xffffffffu);
    is_end[a] = is_end[b] = 1;
    middle = static_cast<int>(mesh_.points.size());
    const double part = height(a) / (height(a) - height(b));
    mesh_.points.push_back(mesh_.points[a] + part * (mesh_.points[b] - mesh_.points[a]));
    std::vector<int>& held = held_[middle];
    const auto of_a = held_.find(a), of_b = held_.find(b);
    if (of_a != held_.end() && of_b != held_.end())
      std::set_intersection(of_a->second.begin(), of_a->second.end(), of_b->second.begin(),
                            of_b->second.end(), std::back_inserter(held));
    held.push_back(static_cast<int>(planes_.size()) - 1);
  }
  const int count = mesh_.count();
  for (int t = 0; t < count && !middles_.empty(); ++t) {
    const std::array<int, 4>& corners = mesh_.tetrahedra[t];
    if (is_end[corners[0]] + is_end[corners[1]] + is_end[corners[2]] + is_end[corners[3]] >= 2)
      bisect(t);
  }
  linked_ = linked_ && middles_.empty();

  for (int t = 0; t < mesh_.count(); ++t) {
    if (labels_[t] != label) continue;
    double furthest = 0;
    for (const int point : mesh_.tetrahedra[t])
      if (std::abs(height(point)) > std::abs(furthest)) furthest = height(point);
    labels_[t] = furthest > 0 ? above : below;
  }
}

void PlaneCutter::link() {
  if (!linked_) link_neighbours(mesh_);
  linked_ = true;
}

Segments connected_segments(const TetMesh& mesh, const std::vector<int>& labels, double least_mm3) {
  Segments pieces{std::vector<int>(labels.size(), -1), 0};
  std::vector<int> open;
  for (int start = 0; start < mesh.count(); ++start) {
    if (pieces.of_tetrahedron[start] >= 0) continue;
    const int piece = pieces.count++;
    pieces.of_tetrahedron[start] = piece;
    open.assign(1, start);
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (const int across : mesh.neighbours[t]) {
        if (across < 0 || pieces.of_tetrahedron[across] >= 0 || labels[across] != labels[t])
          continue;
        pieces.of_tetrahedron[across] = piece;
        open.push_back(across);
      }
    }
  }

  const std::vector<double> volumes = segment_volumes(mesh, pieces);
  const std::vector<SegmentEdge> joints = adjacency(mesh, pieces);
  // Fragments follow their neighbours, which may be fragments themselves, to a piece that stays.
  std::vector<int> goes_to(pieces.count, -1);
  for (int piece = 0; piece < pieces.count; ++piece)
    if (volumes[piece] >= least_mm3) goes_to[piece] = piece;
  for (bool changed = true; changed;) {
    changed = false;
    std::map<int, std::pair<double, int>> best;  // by fragment: area, receiver
    for (const SegmentEdge& joint : joints)
      for (const auto& [fragment, beside] :
           {std::pair(joint.a, joint.b), std::pair(joint.b, joint.a)}) {
        if (goes_to[fragment] >= 0 || goes_to[beside] < 0) continue;
        auto& choice = best.try_emplace(fragment, 0, -1).first->second;
        if (joint.area_mm2 > choice.first) choice = {joint.area_mm2, goes_to[beside]};
      }
    for (const auto& [fragment, choice] : best) {
      if (choice.second < 0) continue;
      goes_to[fragment] = choice.second;
      changed = true;
    }
  }
  std::map<int, int> number;
  for (int& piece : pieces.of_tetrahedron) {
    const int kept = goes_to[piece] >= 0 ? goes_to[piece] : piece;
    piece = number.try_emplace(kept, static_cast<int>(number.size())).first->second;
  }
  pieces.count = static_cast<int>(number.size());
  return pieces;
}

}  // namespace packmerger
