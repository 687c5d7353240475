#include "pack/maps/ways_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "base/random.h"

namespace packmerger {
namespace {

constexpr double kFitTolerance_mm = 1e-9;
constexpr double kBins = 50;         // a bin is about a degree wide
constexpr double kFlatShare = 0.01;  // of the surface: facets of one direction that count as flat
constexpr int kFitSamples = 3000;
constexpr int kFitRefinements = 400;

// Sizes after turns about z, without copying the surfaces.
Vec3 size_turned(const std::vector<Mesh>& surfaces, const Mat3& rotation) {
  Box3 box;
  for (const Mesh& surface : surfaces)
    for (const Vec3& point : surface.points()) box.extend(rotation * point);
  return box.sizes();
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

Mesh united(const std::vector<Mesh>& surfaces) {
  std::vector<const Mesh*> members;
  for (const Mesh& surface : surfaces) members.push_back(&surface);
  return united(members);
}

}  // namespace

std::optional<Vec2> spot_on(const PackProblem& problem, const Mesh& standing) {
  return problem.plate.spot_for(standing, problem.build_mm.head<2>());
}

bool fits(const Vec3& size_mm, const Vec3& build_mm) {
  return excess(size_mm, build_mm) <= kFitTolerance_mm;
}

std::vector<Box3> turned_boxes(const Mesh& standing, const std::vector<double>& turns) {
  Box3 box;
  const auto count = static_cast<Eigen::Index>(standing.points().size());
  Eigen::ArrayXd xs(count);
  Eigen::ArrayXd ys(count);
  Eigen::Index next = 0;
  for (const Vec3& point : standing.points()) {
    box.extend(point);
    xs[next] = point.x();
    ys[next++] = point.y();
  }
  std::vector<Box3> boxes(turns.size());
  if (count == 0) return boxes;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Mat3 about_z = turn_about_z(turns[i]);
    const Eigen::ArrayXd along_x = about_z(0, 0) * xs - about_z(1, 0) * ys;
    const Eigen::ArrayXd along_y = about_z(1, 0) * xs + about_z(0, 0) * ys;
    boxes[i] = Box3(Vec3(along_x.minCoeff(), along_y.minCoeff(), box.min().z()),
                    Vec3(along_x.maxCoeff(), along_y.maxCoeff(), box.max().z()));
  }
  return boxes;
}

std::optional<Turn> best_turn(const std::vector<Box3>& boxes, const std::vector<double>& turns,
                              const std::function<std::vector<Mesh>()>& standing,
                              const PackProblem& problem) {
  Mesh whole;  // all surfaces, where a plate needs them
  const auto stands_clear = [&](double turn) {
    if (problem.plate.is_whole()) return true;
    if (whole.empty()) whole = united(standing());
    return spot_on(problem, transformed(whole, Pose(turn_about_z(turn)))).has_value();
  };
  // Support hardly depends on the turn; the box does, so the cheapest box decides.
  std::optional<Turn> best;
  double least = 0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Vec3 size = boxes[i].isEmpty() ? Vec3(0, 0, 0) : Vec3(boxes[i].sizes());
    if (!fits(size, problem.build_mm)) continue;
    const double cost = problem.cost.evaluate({size, 0, 0, 1});
    if (best && cost >= least - 1e-9 * std::abs(least)) continue;
    if (!stands_clear(turns[i])) continue;
    least = cost;
    best = Turn{turns[i], size};
  }
  return best;
}

std::optional<FittingWay> way_up_that_fits(const std::vector<Mesh>& surfaces,
                                           const PackProblem& problem) {
  Random random(0);  // of no consequence for the packing's own seed
  Mat3 best = Mat3::Identity();
  double least = std::numeric_limits<double>::infinity();
  // Whether it is the answer: where the plate has walls, the first that stands clear of them.
  const auto consider = [&](const Mat3& rotation) {
    const double over = excess(size_turned(surfaces, rotation), problem.build_mm);
    if (over < least) {
      least = over;
      best = rotation;
    }
    if (problem.plate.is_whole() || over > kFitTolerance_mm) return false;
    const bool clear = spot_on(problem, transformed(united(surfaces), Pose(rotation))).has_value();
    if (clear) best = rotation;
    return clear;
  };
  bool found = false;
  for (int i = 0; i < kFitSamples && !found; ++i) found = consider(random_rotation(random));
  for (int i = 0; i < kFitRefinements && !found; ++i)
    found = consider(nudged(best, 0.3 * (1 - static_cast<double>(i) / kFitRefinements), random));
  if (problem.plate.is_whole()) found = least <= kFitTolerance_mm;
  if (!found) return std::nullopt;
  return FittingWay{best, size_turned(surfaces, best)};
}

std::vector<Vec3> flat_facets(const std::vector<Mesh>& surfaces) {
  // Areas summed by direction, on a lattice fine enough that facets of one plane share a bin or lie
  // in neighbouring ones.
  std::map<std::array<long, 3>, Vec3> bins;  // area-weighted normals
  double total = 0;
  for (const Mesh& surface : surfaces)
    for (const auto& [a, b, c] : surface.triangles()) {
      const Vec3& p = surface.points()[static_cast<std::size_t>(a)];
      const Vec3 area = (surface.points()[static_cast<std::size_t>(b)] - p)
                            .cross(surface.points()[static_cast<std::size_t>(c)] - p) /
                        2;
      if (!(area.norm() > 0)) continue;
      const Vec3 normal = area.normalized();
      total += area.norm();
      std::array<long, 3> bin{};
      for (int i = 0; i < 3; ++i) bin[static_cast<std::size_t>(i)] = std::lround(normal[i] * kBins);
      const auto [place, is_new] = bins.emplace(bin, area);
      if (!is_new) place->second += area;
    }
  std::vector<Vec3> flats;
  for (const auto& [bin, area] : bins)
    if (area.norm() > kFlatShare * total) flats.push_back(area);
  std::stable_sort(flats.begin(), flats.end(),
                   [](const Vec3& a, const Vec3& b) { return a.norm() > b.norm(); });
  return flats;
}

std::vector<Mat3> ways_on_flat_facets(const std::vector<Mesh>& surfaces, std::size_t most) {
  const std::vector<Vec3> flats = flat_facets(surfaces);
  std::vector<Mat3> ways;
  for (std::size_t i = 0; i < std::min(most, flats.size()); ++i)
    ways.push_back(turn_between(flats[i], -Vec3::UnitZ()));
  return ways;
}

}  // namespace packmerger
