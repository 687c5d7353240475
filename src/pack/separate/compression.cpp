#include "pack/separate/compression.h"

#include <algorithm>

namespace packmerger {
namespace {

constexpr double kFirstStep = 0.004;  // of the height
constexpr double kLongestStep = 0.006;
constexpr double kLeastStep = 0.0005;
constexpr int kMostSteps = 200;  // of a separation
constexpr int kFailuresOfShake = 2;
constexpr double kShake_mm = 0.6;
constexpr double kShakeAngle = 0.04;  // radians
constexpr double kJudged_mm = 0.3;

}  // namespace

void compress(const Separation& separation, std::vector<Pose>& poses, int patience,
              const std::function<bool()>& is_over, const IsAccepted& is_accepted, Random& random) {
  std::vector<Pose> lowest = poses;
  double height = separation.height_mm(poses);
  double judged = height;
  double step = kFirstStep;
  int failures = 0;
  int rejections = 0;  // since the last layout that was accepted
  const auto judge = [&] {
    if (height >= judged) return true;
    if (is_accepted(lowest, height)) {
      poses = lowest;
      judged = height;
      rejections = 0;
      return true;
    }
    ++rejections;
    lowest = poses;
    height = judged;
    return false;
  };
  while (std::max(failures, rejections) < patience && !is_over()) {
    std::vector<Pose> trial = lowest;
    squeeze(trial, step);
    if (failures >= kFailuresOfShake) shake(trial, kShake_mm, kShakeAngle, random);
    bool succeeded = separation.separate(trial, height * (1 - step), kMostSteps);
    if (succeeded) {
      lowest = std::move(trial);
      height = separation.height_mm(lowest);
      if (height < judged - kJudged_mm) succeeded = judge();
    }
    if (succeeded) {
      failures = 0;
      step = std::min(kLongestStep, 1.2 * step);
    } else {
      ++failures;
      step = std::max(kLeastStep, 0.7 * step);
    }
  }
  judge();
}

}  // namespace packmerger
