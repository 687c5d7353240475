#include "pack/separate/separation.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "pack/separate/descent.h"

namespace packmerger {
namespace {

constexpr double kNearly_mm = 0.03;     // what may be lacking at the end of a minimisation
constexpr double kStillNear_mm = 0.07;  // of a later one, that is worth another exact look
constexpr int kExactLooks = 12;
constexpr double kWidenBy_mm = 0.03;  // at least
constexpr double kMostWidened_mm = 0.4;
constexpr int kStepsOfLook = 25;  // after so many, one that gains too little is given up
constexpr double kWorthGoingOn = 0.9;
constexpr double kTold_mm = 0.1;  // beyond what is asked for

}  // namespace

Separation::Separation(std::vector<const Shape*> shapes, const Vec2& base_mm, double gap_mm,
                       std::function<bool()> is_over, Plate plate, Effort* effort)
    : shapes_(std::move(shapes)),
      base_mm_(base_mm),
      plate_(std::move(plate)),
      apart_mm_(std::max(gap_mm, kLeastApart_mm)),
      is_over_(std::move(is_over)),
      effort_(effort) {}

void Separation::spend(std::uint64_t steps) const {
  if (effort_ != nullptr) effort_->spend(steps);
}

bool Separation::separate(std::vector<Pose>& poses, double height_mm, int most_steps) const {
  const Vec3 box_mm(base_mm_.x(), base_mm_.y(), height_mm);
  Rooms rooms(poses.size(), apart_mm_ + kMargin_mm);
  std::vector<Pose> trial = poses;
  if (minimise(trial, box_mm, rooms, most_steps) > kNearly_mm) return false;
  for (int look = 0; look < kExactLooks; ++look) {
    if (!widen_where_close(trial, box_mm, rooms)) {
      poses = std::move(trial);
      return true;
    }
    if (is_over_() || minimise(trial, box_mm, rooms, most_steps) > kStillNear_mm) return false;
  }
  return false;
}

// Returns what is lacking most.
double Separation::minimise(std::vector<Pose>& poses, const Vec3& box_mm, const Rooms& rooms,
                            int most_steps) const {
  double looked_at = std::numeric_limits<double>::infinity();
  return descend(
             shapes_, poses,
             [&](const std::vector<Pose>& at, const Eigen::VectorXd&) {
               Overlap here = overlap(shapes_, at, box_mm, rooms, plate_);
               spend(here.steps);
               return here;
             },
             {},
             [&](int steps, const Overlap& here) {
               if (steps % kStepsOfLook == 0) {
                 if (here.energy > kWorthGoingOn * looked_at && here.deepest_mm > 3 * kNearly_mm)
                   return false;
                 looked_at = here.energy;
               }
               return steps < most_steps && here.deepest_mm > kNearly_mm && !is_over_();
             })
      .deepest_mm;
}

// Whether anything is too close to another part or to a wall.
bool Separation::widen_where_close(const std::vector<Pose>& poses, const Vec3& box_mm,
                                   Rooms& rooms) const {
  bool close = false;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  std::vector<Box3> boxes;
  for (std::size_t i = 0; i < poses.size(); ++i) boxes.push_back(shapes_[i]->surface.box(poses[i]));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Box3& box = boxes[i];
    double outside = std::max(-box.min().minCoeff(), (box.max() - box_mm).maxCoeff());
    if (!plate_.surely_clear(box))
      outside = std::max(outside, plate_.breach_mm(shapes_[i]->mesh, poses[i]));
    if (outside > 0) {
      rooms.widen_wall(i, outside + kWidenBy_mm / 3);
      close = true;
    }
    for (std::size_t j = i + 1; j < poses.size(); ++j)
      if (box.exteriorDistance(boxes[j]) < apart_mm_) pairs.emplace_back(i, j);
  }
  spend(kStepsOfDistance * pairs.size());
  std::vector<double> gaps(pairs.size());
  parallel_tasks(pairs.size(), [&](std::size_t k) {
    const auto i = pairs[k].first;
    const auto j = pairs[k].second;
    gaps[k] = surface_distance_mm(shapes_[i]->surface, poses[i], shapes_[j]->surface, poses[j],
                                  apart_mm_ + kTold_mm);
  });
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (gaps[k] >= apart_mm_) continue;
    close = true;
    const auto i = pairs[k].first;
    const auto j = pairs[k].second;
    const double widened = rooms.pair(i, j) - apart_mm_ - kMargin_mm;
    // Surfaces that meet do not tell how deep.
    const double lacking = gaps[k] > 0 ? apart_mm_ - gaps[k] + kWidenBy_mm / 3 : 0;
    rooms.widen(i, j, std::min(std::max(kWidenBy_mm, lacking), kMostWidened_mm - widened));
  }
  return close;
}

double Separation::height_mm(const std::vector<Pose>& poses) const {
  double height = 0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    height = std::max(height, shapes_[i]->surface.box(poses[i]).max().z());
  return height;
}

void shake(std::vector<Pose>& poses, double shift_mm, double angle, Random& random) {
  const auto about_zero = [&random] { return random.unit() - 0.5; };
  for (Pose& pose : poses) {
    Vec3 shift;
    Vec3 axis;
    for (int k = 0; k < 3; ++k) {
      shift[k] = shift_mm * about_zero();
      axis[k] = about_zero();
    }
    pose.translation() += shift;
    if (axis.norm() > 0)
      pose.linear() = Eigen::AngleAxisd(angle * about_zero(), axis.normalized()) * pose.linear();
  }
}

void squeeze(std::vector<Pose>& poses, double share) {
  for (Pose& pose : poses) pose.translation().z() *= 1 - share;
}

}  // namespace packmerger
