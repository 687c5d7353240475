#include "pack/separate/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace packmerger {
namespace {

constexpr double kLeastPitch_mm = 0.5;
constexpr double kCellsAcross = 60;      // of the shape
constexpr double kMostCellsAcross = 76;  // of the grid, with what it reaches beyond the shape
constexpr double kSpacing_mm = 2;        // of the samples
constexpr double kThinning = 0.7;        // of the spacing: no two samples share a cell of that size
constexpr double kLeastBall_mm = 4;      // across
constexpr double kBallsAcross = 8;
constexpr std::size_t kFewPoints = 3000;
constexpr int kDirections = 4000;
constexpr double kGroupsAcross = 24;

using Cell = std::array<int, 3>;

Cell cell_of(const Vec3& point, double size) {
  return {static_cast<int>(std::floor(point.x() / size)),
          static_cast<int>(std::floor(point.y() / size)),
          static_cast<int>(std::floor(point.z() / size))};
}

// The surfaces that bound the matter from outside. Nothing gets into a closed chamber, so that it
// is as good as matter to other parts; its walls are those bodies that are turned inside out.
Mesh without_chambers(const Mesh& mesh) {
  TriangleSoup kept;
  kept.points = mesh.points();
  std::vector<char> seen(mesh.n_triangles(), 0);
  for (std::size_t first = 0; first < mesh.n_triangles(); ++first) {
    if (seen[first] != 0) continue;
    std::vector<std::size_t> body{first};
    seen[first] = 1;
    double volume = 0;  // times six
    for (std::size_t k = 0; k < body.size(); ++k) {
      const auto [a, b, c] = mesh.corners(body[k]);
      volume += a.dot(b.cross(c));
      for (const int beside : mesh.neighbours()[body[k]])
        if (beside >= 0 && seen[static_cast<std::size_t>(beside)] == 0) {
          seen[static_cast<std::size_t>(beside)] = 1;
          body.push_back(static_cast<std::size_t>(beside));
        }
    }
    if (volume < 0) continue;
    for (const std::size_t i : body) kept.triangles.push_back(mesh.triangles()[i]);
  }
  if (kept.triangles.size() == mesh.n_triangles()) return mesh;
  return closed_mesh(std::move(kept));
}

Mesh about_its_centre(const Mesh& mesh, const Vec3& centre) {
  Pose pose = Pose::Identity();
  pose.translation() = -centre;
  return transformed(mesh, pose);
}

double radius_of(const Mesh& mesh) {
  double squared = 0;
  for (const Vec3& point : mesh.points()) squared = std::max(squared, point.squaredNorm());
  return std::sqrt(squared);
}

// The vertices first, since they decide most, then rows of points along the longest side of every
// triangle.
std::vector<Vec3> surface_samples(const Mesh& mesh) {
  std::set<Cell> taken;
  std::vector<Vec3> samples;
  const auto offer = [&](const Vec3& point) {
    if (taken.insert(cell_of(point, kThinning * kSpacing_mm)).second) samples.push_back(point);
  };
  const auto steps_over = [](double length_mm) {
    return std::max(1, static_cast<int>(std::ceil(length_mm / kSpacing_mm)));
  };
  for (const Vec3& point : mesh.points()) offer(point);
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
    std::array<Vec3, 3> corner = mesh.corners(i);
    const auto side = [&corner](std::size_t k) { return (corner[(k + 1) % 3] - corner[k]).norm(); };
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (side(k) > side(longest)) longest = k;
    const Vec3 from = corner[longest];
    const Vec3 to = corner[(longest + 1) % 3];
    const Vec3 tip = corner[(longest + 2) % 3];
    const double length = side(longest);
    if (!(length > 0)) continue;
    const int rows = steps_over((to - from).cross(tip - from).norm() / length);
    for (int row = 0; row <= rows; ++row) {
      const double up = static_cast<double>(row) / rows;
      const int steps = steps_over(length * (1 - up));
      for (int step = 0; step <= steps; ++step) {
        const double along = (1 - up) * step / steps;
        offer(from + (to - from) * along + (tip - from) * up);
      }
    }
  }
  return samples;
}

std::vector<SampleBall> balls_of(const std::vector<Vec3>& samples, double radius_mm) {
  const double size = std::max(kLeastBall_mm, 2 * radius_mm / kBallsAcross);
  std::map<Cell, SampleBall> by_cell;
  for (const Vec3& sample : samples)
    by_cell[cell_of(sample, size)].samples.push_back(sample.cast<float>());
  std::vector<SampleBall> balls;
  for (auto& [cell, ball] : by_cell) {
    Eigen::AlignedBox3f box;
    for (const Vec3f& sample : ball.samples) box.extend(sample);
    ball.centre = box.center();
    for (const Vec3f& sample : ball.samples)
      ball.radius = std::max(ball.radius, (sample - ball.centre).norm());
    balls.push_back(std::move(ball));
  }
  return balls;
}

// Points are looked at in groups, and only in those whose box reaches far enough.
std::vector<Vec3> outermost_of(const Mesh& mesh) {
  if (mesh.n_points() <= kFewPoints) return mesh.points();
  struct Group {
    Box3 box;
    std::vector<std::size_t> points;
  };
  const double size = bounding_box(mesh).sizes().maxCoeff() / kGroupsAcross;
  std::map<Cell, Group> by_cell;
  for (std::size_t i = 0; i < mesh.n_points(); ++i) {
    Group& group = by_cell[cell_of(mesh.points()[i], size)];
    group.box.extend(mesh.points()[i]);
    group.points.push_back(i);
  }
  std::set<std::size_t> chosen;
  std::size_t furthest = 0;
  for (const Vec3& direction : spread_directions(kDirections)) {
    double reached = mesh.points()[furthest].dot(direction);
    for (const auto& [cell, group] : by_cell) {
      const double most =
          group.box.center().dot(direction) + group.box.sizes().dot(direction.cwiseAbs()) / 2;
      if (most <= reached) continue;
      for (const std::size_t i : group.points)
        if (mesh.points()[i].dot(direction) > reached) {
          reached = mesh.points()[i].dot(direction);
          furthest = i;
        }
    }
    chosen.insert(furthest);
  }
  std::vector<Vec3> points;
  for (const std::size_t i : chosen) points.push_back(mesh.points()[i]);
  return points;
}

// Coarser where the distances reach far: what parts keep apart there decides less than their form.
double pitch_for(const Mesh& mesh, double reach_mm) {
  const double across = bounding_box(mesh).sizes().maxCoeff();
  return std::max(
      {kLeastPitch_mm, across / kCellsAcross, (across + 2 * reach_mm) / kMostCellsAcross});
}

}  // namespace

Shape::Shape(const Mesh& from, double reach_mm)
    : centre(bounding_box(from).center()),
      mesh(about_its_centre(from, centre)),
      volume_mm3(packmerger::volume_mm3(mesh)),
      radius_mm(radius_of(mesh)),
      half_mm(bounding_box(mesh).sizes() / 2),
      surface(mesh),
      outside(without_chambers(mesh)),
      distances(outside, pitch_for(mesh, reach_mm), reach_mm),
      balls(balls_of(surface_samples(outside), radius_mm)),
      outermost(outermost_of(outside)) {}

}  // namespace packmerger
