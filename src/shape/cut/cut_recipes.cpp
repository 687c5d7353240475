#include "shape/cut/cut_recipes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace packmerger {
namespace {

constexpr std::size_t kLooked = 500;  // samples of a region looked at for quantiles and axes

Vec3 random_direction(Random& random) {
  const double z = 2 * random.unit() - 1;
  const double turn = 2 * std::numbers::pi * random.unit();
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// Positions along a direction below which the given share of the region lies.
class Quantiles {
 public:
  Quantiles(const MatterSamples& samples, const std::vector<int>& region, const Vec3& direction) {
    const std::size_t stride = std::max<std::size_t>(1, region.size() / kLooked);
    for (std::size_t i = 0; i < region.size(); i += stride)
      sorted_.push_back(direction.dot(samples.points[region[i]]));
    std::sort(sorted_.begin(), sorted_.end());
  }
  double at(double share) const {
    return sorted_[static_cast<std::size_t>(share * static_cast<double>(sorted_.size() - 1))];
  }

 private:
  std::vector<double> sorted_;
};

Plane plane_at(const Vec3& normal, double position) { return {normal, -position}; }

// Any direction, one of the region's axes, or that of an earlier cut; the last two at times tilted.
Vec3 random_normal(const RegionFrame& frame, const std::vector<Plane>& planes, Random& random) {
  Vec3 normal;
  switch (random.below(planes.empty() ? 2 : 3)) {
    case 0:
      return random_direction(random);
    case 1:
      normal = frame.axes.col(static_cast<int>(random.below(3)));
      break;
    default:
      normal = planes[random.below(planes.size())].normal();
      break;
  }
  if (random.below(2) == 0) normal = (normal + 0.3 * random_direction(random)).normalized();
  return normal;
}

}  // namespace

RegionFrame frame_of(const MatterSamples& samples, const std::vector<int>& region) {
  RegionFrame frame;
  const std::size_t stride = std::max<std::size_t>(1, region.size() / kLooked);
  double count = 0;
  for (std::size_t i = 0; i < region.size(); i += stride, ++count)
    frame.middle += samples.points[region[i]];
  frame.middle /= count;
  Mat3 moments = Mat3::Zero();
  for (std::size_t i = 0; i < region.size(); i += stride) {
    const Vec3 arm = samples.points[region[i]] - frame.middle;
    moments += arm * arm.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(moments);
  for (int i = 0; i < 3; ++i) frame.axes.col(i) = solver.eigenvectors().col(2 - i).normalized();
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int sample : region) {
    const Vec3 at = frame.axes.transpose() * samples.points[sample];
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  frame.half_mm = (high - low) / 2;
  return frame;
}

CutRecipe wedges(const Vec3& point, const Vec3& axis, int count) {
  const Vec3 x = axis.unitOrthogonal(), y = axis.cross(x);
  const auto plane = [&](double angle) {
    const Vec3 normal = std::cos(angle) * y - std::sin(angle) * x;
    return Plane(normal, point);
  };
  CutRecipe recipe;
  recipe.push_back({0, plane(0)});  // cell 1 holds the angles from 0 to π
  int last = 1;
  for (const auto& [in_half, start] : {std::pair((count + 1) / 2, 1), std::pair(count / 2, 0)}) {
    int cell = start;
    for (int i = 1; i < in_half; ++i) {
      const double angle = (start == 1 ? 0 : std::numbers::pi) + std::numbers::pi * i / in_half;
      recipe.push_back({cell, plane(angle)});
      cell = ++last;  // what lies beyond the angle is above its plane
    }
  }
  return recipe;
}

CutRecipe slabs(const MatterSamples& samples, const std::vector<int>& region, const Vec3& normal,
                int count) {
  const Quantiles quantiles(samples, region, normal);
  CutRecipe recipe;
  for (int i = 1; i < count; ++i)
    recipe.push_back({i - 1, plane_at(normal, quantiles.at(static_cast<double>(i) / count))});
  return recipe;
}

CutRecipe ring(const Vec3& middle, const Vec3& axis, const Vec3& across, double band_half_mm,
               double strip_half_mm, bool halve) {
  CutRecipe recipe;
  const auto at = [&](const Vec3& normal, double distance) {
    return Plane(normal, middle + distance * normal);
  };
  // cell 1: the cap above; cell 2: the band; cell 0: the cap below
  recipe.push_back({0, at(axis, band_half_mm)});
  recipe.push_back({0, at(axis, -band_half_mm)});
  const Vec3 along = axis.cross(across);
  int last = 2;
  for (const int cap : {0, 1}) {
    recipe.push_back({cap, at(across, strip_half_mm)});
    const int lens = ++last;
    recipe.push_back({cap, at(across, -strip_half_mm)});
    ++last;
    if (!halve) continue;
    for (const int one : {lens, cap}) {
      recipe.push_back({one, at(along, 0)});
      ++last;
    }
  }
  return recipe;
}

CutRecipe random_recipe(const MatterSamples& samples, const std::vector<int>& region,
                        const std::vector<Plane>& planes, int most_steps, Random& random) {
  const RegionFrame frame = frame_of(samples, region);
  const Vec3 normal = random_normal(frame, planes, random);
  const Quantiles quantiles(samples, region, normal);
  CutRecipe recipe;
  const std::size_t kind = most_steps < 2 ? 0 : random.below(4);
  if (kind <= 1) {
    recipe.push_back({0, plane_at(normal, quantiles.at(0.12 + 0.76 * random.unit()))});
    if (kind == 1 && random.below(2) == 0) {
      // across the first: a T
      Vec3 other = normal.cross(random_normal(frame, planes, random));
      if (other.norm() > 0.1) {
        other.normalize();
        const Quantiles along(samples, region, other);
        recipe.push_back({static_cast<int>(random.below(2)),
                          plane_at(other, along.at(0.25 + 0.5 * random.unit()))});
      }
    }
  } else if (kind == 2) {
    const double low = 0.1 + 0.5 * random.unit();
    const double high = low + (0.9 - low) * (0.3 + 0.7 * random.unit());
    recipe.push_back({0, plane_at(normal, quantiles.at(high))});
    recipe.push_back({0, plane_at(normal, quantiles.at(low))});
  } else {
    // wedges: planes through a line across the region
    const Vec3 point =
        frame.middle +
        (quantiles.at(0.1 + 0.8 * random.unit()) - normal.dot(frame.middle)) * normal;
    Vec3 axis = normal.cross(random_direction(random));
    if (axis.norm() < 0.1) axis = normal.unitOrthogonal();
    return wedges(point, axis.normalized(),
                  std::min(most_steps + 1, 2 + static_cast<int>(random.below(3))));
  }
  return recipe;
}

}  // namespace packmerger
