#include "pack/separate/descent.h"

#include <cmath>

#include "pack/separate/quasi_newton.h"

namespace packmerger {
namespace {

constexpr int kHalvings = 6;
constexpr double kShorter = 0.4;
constexpr double kSufficient = 1e-4;  // of the decrease that the slope promises (Armijo)
constexpr int kFreshStarts = 3;

}  // namespace

Overlap descend(const std::vector<const Shape*>& shapes, std::vector<Pose>& poses,
                const PoseEnergy& energy, const Steps& steps,
                const std::function<bool(int taken, const Overlap& here)>& goes_on) {
  const std::vector<Pose> from = poses;
  Eigen::VectorXd at = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * poses.size()));
  Overlap here = energy(poses, at);
  QuasiNewton memory;
  int fresh_starts = 0;
  for (int taken = 0; goes_on(taken, here); ++taken) {
    Eigen::VectorXd direction = memory.direction(here.gradient, steps.first);
    if (here.gradient.dot(direction) >= 0) {
      memory.forget();
      direction = -steps.first * here.gradient;
    }
    const double longest = direction.cwiseAbs().maxCoeff();
    if (!std::isfinite(longest)) break;
    if (longest > steps.longest_mm) direction *= steps.longest_mm / longest;
    const double slope = here.gradient.dot(direction);
    bool is_lower = false;
    double length = 1;
    for (int halving = 0; halving < kHalvings && !is_lower; ++halving, length *= kShorter) {
      const Eigen::VectorXd next_at = at + length * direction;
      std::vector<Pose> next_poses = moved(shapes, from, next_at);
      Overlap next = energy(next_poses, next_at);
      if (next.energy > here.energy + kSufficient * length * slope) continue;
      is_lower = true;
      memory.learn(next_at - at, next.gradient - here.gradient);
      at = next_at;
      poses = std::move(next_poses);
      here = std::move(next);
    }
    if (is_lower) continue;
    if (memory.knows_nothing() || ++fresh_starts > kFreshStarts) break;
    memory.forget();
  }
  return here;
}

}  // namespace packmerger
