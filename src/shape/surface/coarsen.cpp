#include "shape/surface/coarsen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace packmerger {
namespace {

constexpr double kMaxAspectRatio = 8;  // longest side over its height
constexpr double kLeastCosine = 0.5;   // of how far a collapse may turn a triangle
// Where the surface is flat every collapse costs nothing; then short edges go first.
constexpr double kLengthCost = 1e-5;
constexpr int kCollapsesBetweenChecks = 1000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Triangle = std::array<int, 3>;

// Sum of areas times squared distances from planes, as a function of a point.
class Quadric {
 public:
  void add(const Vec3& normal, double offset, double weight) {
    const double a = normal.x(), b = normal.y(), c = normal.z();
    const std::array<double, 10> products{a * a, a * b,      a * c, a * offset, b * b,
                                          b * c, b * offset, c * c, c * offset, offset * offset};
    for (std::size_t i = 0; i < terms_.size(); ++i) terms_[i] += weight * products[i];
  }
  void add(const Quadric& other) {
    for (std::size_t i = 0; i < terms_.size(); ++i) terms_[i] += other.terms_[i];
  }
  double at(const Vec3& p) const {
    const auto& [xx, xy, xz, x, yy, yz, y, zz, z, one] = terms_;
    return p.x() * (xx * p.x() + 2 * (xy * p.y() + xz * p.z() + x)) +
           p.y() * (yy * p.y() + 2 * (yz * p.z() + y)) + p.z() * (zz * p.z() + 2 * z) + one;
  }

 private:
  std::array<double, 10> terms_{};  // of the symmetric matrix, upper half, row by row
};

struct Limits {
  double error = 0;  // of a quadric
  double squared_mm2 = 0;
};

class Decimater {
 public:
  Decimater(const Mesh& mesh, const Limits& limits)
      : limits_(limits),
        points_(mesh.points()),
        triangles_(mesh.triangles().begin(), mesh.triangles().end()),
        is_gone_(triangles_.size(), 0),
        around_(points_.size()),
        quadrics_(points_.size()),
        versions_(points_.size(), 0) {
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      const auto& [a, b, c] = triangles_[at(t)];
      const Vec3 area = (point(b) - point(a)).cross(point(c) - point(a)) / 2;
      const double size = area.norm();
      const Vec3 normal = size > 0 ? Vec3(area / size) : Vec3(0, 0, 0);
      for (const int corner : triangles_[at(t)]) {
        around_[at(corner)].push_back(t);
        quadrics_[at(corner)].add(normal, -normal.dot(point(a)), size);
      }
    }
  }

  void run(const Progress& progress) {
    for (int v = 0; v < static_cast<int>(points_.size()); ++v) enqueue(v);
    for (int done = 0; !queue_.empty();) {
      const auto [cost, from, version, to] = queue_.top();
      queue_.pop();
      if (version != versions_[at(from)]) continue;
      if (++done % kCollapsesBetweenChecks == 0) progress.check();
      // What happened beyond the other point since then may have made it dearer, or forbids it.
      if (cost_of(from, to).value_or(kInfinity) > cost || !is_allowed(from, to))
        enqueue(from);
      else
        collapse(from, to);
    }
  }

  TriangleSoup result() const {
    TriangleSoup soup;
    std::vector<int> place(points_.size(), -1);
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (around_[v].empty()) continue;
      place[v] = static_cast<int>(soup.points.size());
      soup.points.push_back(points_[v]);
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (is_gone_[t] == 0)
        soup.triangles.push_back({place[at(triangles_[t][0])], place[at(triangles_[t][1])],
                                  place[at(triangles_[t][2])]});
    return soup;
  }

 private:
  // What it costs, which point goes, its version, and onto which point. Of equal costs the first
  // point goes first, so that the order does not depend on the heap.
  using Candidate = std::tuple<double, int, std::uint32_t, int>;

  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  const Vec3& point(int v) const { return points_[at(v)]; }

  std::vector<int> neighbours(int v) const {
    std::vector<int> found;
    found.reserve(2 * around_[at(v)].size());
    for (const int t : around_[at(v)])
      for (const int corner : triangles_[at(t)])
        if (corner != v) found.push_back(corner);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  // Empty where the edge is too long, or the error too large.
  std::optional<double> cost_of(int from, int to) const {
    const double squared = (point(to) - point(from)).squaredNorm();
    if (squared > limits_.squared_mm2) return std::nullopt;
    // Rounding makes the error of flat places slightly negative.
    const double error =
        std::max(0.0, quadrics_[at(from)].at(point(to)) + quadrics_[at(to)].at(point(to)));
    if (error > limits_.error) return std::nullopt;
    return error + kLengthCost * squared * squared;
  }

  bool is_allowed(int from, int to) const {
    return keeps_topology(from, to) && keeps_shape(from, to);
  }

  // Puts the point's cheapest collapse that is allowed into the queue; what was there of it before
  // no longer counts.
  void enqueue(int from) {
    const std::uint32_t version = ++versions_[at(from)];
    std::vector<std::pair<double, int>> ranked;
    for (const int to : neighbours(from))
      if (const auto cost = cost_of(from, to)) ranked.emplace_back(*cost, to);
    std::sort(ranked.begin(), ranked.end());
    for (const auto& [cost, to] : ranked)
      if (is_allowed(from, to)) {
        queue_.emplace(cost, from, version, to);
        return;
      }
  }

  // The link condition of closed surfaces: the two ends of the edge share its two opposite points
  // and no other, and are not two corners of a tetrahedron.
  bool keeps_topology(int from, int to) const {
    const std::vector<int> beside_from = neighbours(from);
    const std::vector<int> beside_to = neighbours(to);
    if (beside_from.size() == 3 && beside_to.size() == 3) return false;
    int shared = 0;
    for (const int v : beside_to)
      shared += std::binary_search(beside_from.begin(), beside_from.end(), v) ? 1 : 0;
    return shared == 2;
  }

  // No triangle turns too far, or becomes a sliver worse than there was one.
  bool keeps_shape(int from, int to) const {
    double worst_before = 0, worst_after = 0;
    for (const int t : around_[at(from)]) {
      const Triangle& corners = triangles_[at(t)];
      const bool goes = std::find(corners.begin(), corners.end(), to) != corners.end();
      std::array<const Vec3*, 3> p{};
      for (std::size_t i = 0; i < 3; ++i) p[i] = &point(corners[i]);
      const Vec3 before = (*p[1] - *p[0]).cross(*p[2] - *p[0]);
      worst_before = std::max(worst_before, aspect(p, before.norm()));
      if (goes) continue;
      for (std::size_t i = 0; i < 3; ++i)
        if (corners[i] == from) p[i] = &point(to);
      const Vec3 after = (*p[1] - *p[0]).cross(*p[2] - *p[0]);
      const double area2 = after.norm();
      if (!(area2 > 0) || before.dot(after) < kLeastCosine * before.norm() * area2) return false;
      worst_after = std::max(worst_after, aspect(p, area2));
    }
    return worst_after < std::max(worst_before, kMaxAspectRatio);
  }

  // area2: twice its area.
  static double aspect(const std::array<const Vec3*, 3>& p, double area2) {
    const double longest2 = std::max({(*p[1] - *p[0]).squaredNorm(), (*p[2] - *p[1]).squaredNorm(),
                                      (*p[0] - *p[2]).squaredNorm()});
    return longest2 / area2;
  }

  void collapse(int from, int to) {
    const std::vector<int> touched = neighbours(from);
    for (const int t : around_[at(from)]) {
      Triangle& corners = triangles_[at(t)];
      const bool goes = std::find(corners.begin(), corners.end(), to) != corners.end();
      if (goes) {
        is_gone_[at(t)] = 1;
        for (const int corner : corners)
          if (corner != from) std::erase(around_[at(corner)], t);
      } else {
        std::replace(corners.begin(), corners.end(), from, to);
        around_[at(to)].push_back(t);
      }
    }
    around_[at(from)].clear();
    quadrics_[at(to)].add(quadrics_[at(from)]);
    ++versions_[at(from)];
    for (const int v : touched) enqueue(v);
  }

  Limits limits_;
  std::vector<Vec3> points_;
  std::vector<Triangle> triangles_;
  std::vector<char> is_gone_;
  std::vector<std::vector<int>> around_;  // by point: triangles
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> versions_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace

Mesh coarsened(const Mesh& mesh, double tolerance_mm, double max_edge_mm,
               const Progress& progress) {
  progress.check();
  // A quadric sums area times squared distance, each triangle three times.
  const double patch_mm2 = max_edge_mm * max_edge_mm / 2;
  Decimater decimater(mesh,
                      {3 * patch_mm2 * tolerance_mm * tolerance_mm, max_edge_mm * max_edge_mm});
  decimater.run(progress);
  return closed_mesh(decimater.result());
}

}  // namespace packmerger
