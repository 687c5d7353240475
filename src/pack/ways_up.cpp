#include "pack/ways_up.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/random.h"
#include "pack/columns.h"

namespace packmerger {
namespace {

constexpr double kFitTolerance_mm = 1e-9;
constexpr int kColumnsAcross = 64;  // enough to rank; the placement measures again
constexpr int kFitSamples = 3000;
constexpr int kFitRefinements = 400;

std::vector<TriangleSoup> turned(const std::vector<TriangleSoup>& surfaces, const Mat3& rotation) {
  std::vector<TriangleSoup> result = surfaces;
  for (TriangleSoup& surface : result)
    for (Vec3& point : surface.points) point = rotation * point;
  return result;
}

Box3 box_of(const std::vector<TriangleSoup>& surfaces) {
  Box3 box;
  for (const TriangleSoup& surface : surfaces)
    for (const Vec3& point : surface.points) box.extend(point);
  return box;
}

// Sizes after turns about z, without copying the surfaces.
Vec3 size_turned(const std::vector<TriangleSoup>& surfaces, const Mat3& rotation) {
  Box3 box;
  for (const TriangleSoup& surface : surfaces)
    for (const Vec3& point : surface.points) box.extend(rotation * point);
  return box.sizes();
}

WayUp measured(const std::vector<TriangleSoup>& surfaces, const Mat3& base, double turn,
               double volume_mm3, const PackProblem& problem) {
  const std::vector<TriangleSoup> standing = turned(surfaces, turn_about_z(turn) * base);
  const Box3 box = box_of(standing);
  const double step = std::max(problem.grid_mm, box.sizes().head<2>().maxCoeff() / kColumnsAcross);
  const ColumnSupport support =
      column_support(standing, step, problem.support_angle, box.min().z());
  const TrayMeasure alone{box.sizes(), support.below + support.inside, volume_mm3, 1};
  return {base, turn, problem.cost.evaluate(alone), alone.support_mm3, support.inside};
}

// How far a size exceeds the build volume, in the worst direction; negative: room left.
double excess(const Vec3& size, const Vec3& build) { return (size - build).maxCoeff(); }

Mat3 random_rotation(Random& random) {
  // Uniform over rotations: a unit quaternion from three uniform numbers (Shoemake 1992).
  const double u = random.unit();
  const double a = 2 * std::numbers::pi * random.unit();
  const double b = 2 * std::numbers::pi * random.unit();
  return Eigen::Quaterniond(std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a),
                            std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b))
      .normalized()
      .toRotationMatrix();
}

Mat3 nudged(const Mat3& rotation, double reach, Random& random) {
  const Vec3 axis(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5);
  if (axis.norm() < 1e-6) return rotation;
  return Eigen::AngleAxisd(reach * random.unit(), axis.normalized()).toRotationMatrix() * rotation;
}

}  // namespace

bool fits(const Vec3& size_mm, const Vec3& build_mm) {
  return excess(size_mm, build_mm) <= kFitTolerance_mm;
}

std::vector<WayUp> ranked_ways_up(const std::vector<TriangleSoup>& surfaces, double volume_mm3,
                                  const RotationSet& rotations, const PackProblem& problem,
                                  const std::function<void()>& tick) {
  std::vector<WayUp> ways;
  for (const Mat3& way : rotations.ways_up) {
    tick();
    // Support hardly depends on the turn; the box does, so the cheapest box decides the turn.
    double best_cost = 0;
    std::optional<double> best;
    for (const double turn : rotations.turns) {
      const Vec3 size = size_turned(surfaces, turn_about_z(turn) * way);
      if (!fits(size, problem.build_mm)) continue;
      const double cost = problem.cost.evaluate({size, 0, volume_mm3, 1});
      if (!best || cost < best_cost - 1e-9 * std::abs(best_cost)) {
        best_cost = cost;
        best = turn;
      }
    }
    if (best) ways.push_back(measured(surfaces, way, *best, volume_mm3, problem));
  }
  std::stable_sort(ways.begin(), ways.end(),
                   [](const WayUp& a, const WayUp& b) { return a.cost < b.cost; });
  return ways;
}

std::optional<WayUp> way_up_that_fits(const std::vector<TriangleSoup>& surfaces, double volume_mm3,
                                      const PackProblem& problem) {
  Random random(0);  // of no consequence for the packing's own seed
  Mat3 best = Mat3::Identity();
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Mat3& rotation) {
    const double over = excess(size_turned(surfaces, rotation), problem.build_mm);
    if (over >= least) return;
    least = over;
    best = rotation;
  };
  for (int i = 0; i < kFitSamples; ++i) consider(random_rotation(random));
  for (int i = 0; i < kFitRefinements; ++i)
    consider(nudged(best, 0.3 * (1 - static_cast<double>(i) / kFitRefinements), random));
  if (least > kFitTolerance_mm) return std::nullopt;
  return measured(surfaces, best, 0, volume_mm3, problem);
}

}  // namespace packmerger
