#include "pack/separate/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace packmerger {
namespace {

constexpr double kLeastPitch_mm = 0.5;
constexpr double kCellsAcross = 60;
constexpr double kSpacing_mm = 2;    // of the samples
constexpr double kThinning = 0.7;    // of the spacing: no two samples share a cell of that size
constexpr double kLeastBall_mm = 4;  // across
constexpr double kBallsAcross = 8;
constexpr std::size_t kFewPoints = 3000;
constexpr int kDirections = 4000;

using Cell = std::array<int, 3>;

Cell cell_of(const Vec3& point, double size) {
  return {static_cast<int>(std::floor(point.x() / size)),
          static_cast<int>(std::floor(point.y() / size)),
          static_cast<int>(std::floor(point.z() / size))};
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

// The vertices first, since they decide most, then a lattice over every triangle.
std::vector<Vec3> surface_samples(const Mesh& mesh) {
  std::set<Cell> taken;
  std::vector<Vec3> samples;
  const auto offer = [&](const Vec3& point) {
    if (taken.insert(cell_of(point, kThinning * kSpacing_mm)).second) samples.push_back(point);
  };
  for (const Vec3& point : mesh.points()) offer(point);
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const double longest = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
    const int steps = static_cast<int>(std::ceil(longest / kSpacing_mm));
    for (int u = 0; u <= steps; ++u)
      for (int v = 0; u + v <= steps; ++v)
        offer(a + (b - a) * (static_cast<double>(u) / steps) +
              (c - a) * (static_cast<double>(v) / steps));
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

std::vector<Vec3> outermost_of(const Mesh& mesh) {
  if (mesh.n_points() <= kFewPoints) return mesh.points();
  std::set<std::size_t> chosen;
  for (const Vec3& direction : spread_directions(kDirections)) {
    std::size_t furthest = 0;
    for (std::size_t i = 1; i < mesh.n_points(); ++i)
      if (mesh.points()[i].dot(direction) > mesh.points()[furthest].dot(direction)) furthest = i;
    chosen.insert(furthest);
  }
  std::vector<Vec3> points;
  for (const std::size_t i : chosen) points.push_back(mesh.points()[i]);
  return points;
}

double pitch_for(const Mesh& mesh) {
  return std::max(kLeastPitch_mm, bounding_box(mesh).sizes().maxCoeff() / kCellsAcross);
}

}  // namespace

Shape::Shape(const Mesh& from, double reach_mm)
    : centre(bounding_box(from).center()),
      mesh(about_its_centre(from, centre)),
      volume_mm3(packmerger::volume_mm3(mesh)),
      radius_mm(radius_of(mesh)),
      surface(mesh),
      distances(mesh, pitch_for(mesh), reach_mm),
      balls(balls_of(surface_samples(mesh), radius_mm)),
      outermost(outermost_of(mesh)) {}

}  // namespace packmerger
