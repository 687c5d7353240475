#include "pack/separate/overlap_energy.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace packmerger {
namespace {

constexpr double kWallRoom_mm = 0.0105;
constexpr double kWallWeight = 9;
const double kWallDepth = std::sqrt(kWallWeight);
// Of a pitch: by how much distances between samples of a grid may be wrong.
constexpr float kInterpolation = 0.6F;
// Of work.
constexpr std::uint64_t kStepsOfPair = 10;
constexpr std::uint64_t kStepsOfBall = 40;
constexpr std::uint64_t kStepsOfSample = 50;

// What one part's samples meet in another's distances, or at the walls: force and torque are the
// energy's derivatives by a translation of the part, and by a turn about the frame's origin.
struct Push {
  double energy = 0;
  double deepest_mm = 0;
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  std::uint64_t steps = 0;
};

void add(Push& push, double weight, double lacking, const Vec3& gradient, const Vec3& at) {
  push.energy += weight * lacking * lacking;
  const Vec3 force = -2 * weight * lacking * gradient;
  push.force += force;
  push.torque += at.cross(force);
}

// Of `one` on `other`, in the frame of `other`.
Push met(const Shape& one, const Pose& at_one, const Shape& other, const Pose& at_other,
         double room_mm) {
  const Pose relative = at_other.inverse(Eigen::Isometry) * at_one;
  const Eigen::Matrix3f turn = relative.linear().cast<float>();
  const Vec3f shift = relative.translation().cast<float>();
  const DistanceGrid& distances = other.distances;
  const auto room = static_cast<float>(room_mm);
  const float doubt = kInterpolation * static_cast<float>(distances.pitch_mm());
  Push push;
  push.steps = kStepsOfBall * one.balls.size();
  for (const SampleBall& ball : one.balls) {
    const Vec3f centre = turn * ball.centre + shift;
    if (((centre.array() + ball.radius) < distances.low().array()).any() ||
        ((centre.array() - ball.radius) > distances.high().array()).any())
      continue;
    const float there = distances.at(centre);
    if (there < DistanceGrid::kFar && there > ball.radius + room + doubt) continue;
    push.steps += kStepsOfSample * ball.samples.size();
    for (const Vec3f& sample : ball.samples) {
      const Vec3f point = turn * sample + shift;
      const float lacking = room - distances.at(point);
      if (!(lacking > 0)) continue;
      Vec3f gradient;
      distances.at(point, gradient);
      push.deepest_mm = std::max(push.deepest_mm, static_cast<double>(lacking));
      add(push, 1, lacking, gradient.cast<double>(), point.cast<double>());
    }
  }
  return push;
}

// Of the part on the walls, in the tray's frame but for the origin, which is the part's.
Push met_walls(const Shape& shape, const Pose& pose, const Vec3& box_mm, double room_mm) {
  Push push;
  const Vec3 centre = pose.translation();
  if (centre.minCoeff() - shape.radius_mm >= room_mm &&
      (box_mm - centre).minCoeff() - shape.radius_mm >= room_mm)
    return push;
  for (const Vec3& point : shape.outermost) {
    const Vec3 arm = pose.linear() * point;
    const Vec3 at = arm + centre;
    for (int axis = 0; axis < 3; ++axis) {
      const double below = room_mm - at[axis];
      const double above = at[axis] - (box_mm[axis] - room_mm);
      const double lacking = std::max(below, above);
      if (lacking <= 0) continue;
      push.deepest_mm = std::max(push.deepest_mm, kWallDepth * lacking);
      add(push, kWallWeight, lacking, (below > above ? 1 : -1) * Vec3::Unit(axis), arm);
    }
  }
  return push;
}

// Of the part on the sides of the plate's hull: what stands out tells how far.
void meet_hull(Push& push, const Shape& shape, const Pose& pose, const Plate& plate,
               double room_mm) {
  const Vec2 centre = pose.translation().head<2>();
  for (const Plate::Side& side : plate.sides()) {
    const double left_mm = side.offset - room_mm - side.outward.dot(centre);
    if (left_mm >= shape.radius_mm) continue;
    const Vec3 inward(-side.outward.x(), -side.outward.y(), 0);
    for (const Vec3& point : shape.outermost) {
      const Vec3 arm = pose.linear() * point;
      const double lacking = -inward.dot(arm) - left_mm;
      if (lacking <= 0) continue;
      push.deepest_mm = std::max(push.deepest_mm, kWallDepth * lacking);
      add(push, kWallWeight, lacking, inward, arm);
    }
  }
}

// On barred areas: these may reach into what is hollow, seen from above.
void meet_barred(Push& push, const Shape& shape, const Pose& pose, const Plate& plate,
                 double room_mm) {
  if (plate.barred().empty()) return;
  const auto clearance = [&](const Vec3& at) {
    return plate.nearest_barred(at.head<2>()).clearance_mm;
  };
  if (clearance(pose.translation()) >= shape.radius_mm + room_mm) return;
  for (const SampleBall& ball : shape.balls) {
    const Vec3 middle = pose * ball.centre.cast<double>();
    if (clearance(middle) >= static_cast<double>(ball.radius) + room_mm) continue;
    for (const Vec3f& sample : ball.samples) {
      const Vec3 arm = pose.linear() * sample.cast<double>();
      const Plate::Wall wall = plate.nearest_barred((arm + pose.translation()).head<2>());
      const double lacking = room_mm - wall.clearance_mm;
      if (lacking <= 0) continue;
      push.deepest_mm = std::max(push.deepest_mm, lacking);
      add(push, 1, lacking, Vec3(wall.away.x(), wall.away.y(), 0), arm);
    }
  }
}

struct Pair {
  std::size_t one = 0;
  std::size_t other = 0;
};

std::vector<Pair> close_pairs(const std::vector<const Shape*>& shapes,
                              const std::vector<Pose>& poses, const Rooms& rooms) {
  std::vector<Pair> pairs;
  std::vector<Vec3> half;  // of the boxes, on the tray
  for (std::size_t i = 0; i < shapes.size(); ++i)
    half.emplace_back(poses[i].linear().cwiseAbs() * shapes[i]->half_mm);
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t j = 0; j < shapes.size(); ++j) {
      if (i == j) continue;
      const Vec3 away = poses[i].translation() - poses[j].translation();
      const double room_mm = rooms.pair(i, j);
      if ((away.cwiseAbs() - half[i] - half[j]).maxCoeff() < room_mm &&
          away.norm() < shapes[i]->radius_mm + shapes[j]->radius_mm + room_mm)
        pairs.push_back({i, j});
    }
  return pairs;
}

}  // namespace

Overlap overlap(const std::vector<const Shape*>& shapes, const std::vector<Pose>& poses,
                const Vec3& box_mm, const Rooms& rooms, const Plate& plate) {
  const std::vector<Pair> pairs = close_pairs(shapes, poses, rooms);
  std::vector<Push> pushes(pairs.size());
  parallel_for(pairs.size(), [&](std::size_t k) {
    const Pair& pair = pairs[k];
    pushes[k] = met(*shapes[pair.one], poses[pair.one], *shapes[pair.other], poses[pair.other],
                    rooms.pair(pair.one, pair.other));
  });
  Overlap result;
  result.steps = kStepsOfPair * shapes.size() * shapes.size();
  result.gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * shapes.size()));
  // torque: about the part's own origin.
  const auto enter = [&](std::size_t part, const Vec3& force, const Vec3& torque) {
    const auto at = static_cast<Eigen::Index>(6 * part);
    result.gradient.segment<3>(at) += torque / shapes[part]->radius_mm;
    result.gradient.segment<3>(at + 3) += force;
  };
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Push& push = pushes[k];
    result.steps += push.steps;
    if (push.energy <= 0) continue;
    const auto [one, other] = pairs[k];
    result.energy += push.energy;
    result.deepest_mm = std::max(result.deepest_mm, push.deepest_mm);
    const Vec3 force = poses[other].linear() * push.force;
    const Vec3 torque = poses[other].linear() * push.torque;
    enter(other, -force, -torque);
    const Vec3 arm = poses[one].translation() - poses[other].translation();
    enter(one, force, torque - arm.cross(force));
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const double wall_mm = kWallRoom_mm + rooms.wall(i);
    Push push = met_walls(*shapes[i], poses[i], box_mm, wall_mm);
    meet_hull(push, *shapes[i], poses[i], plate, wall_mm);
    meet_barred(push, *shapes[i], poses[i], plate, wall_mm);
    result.energy += push.energy;
    result.deepest_mm = std::max(result.deepest_mm, push.deepest_mm);
    enter(i, push.force, push.torque);
  }
  return result;
}

std::vector<Pose> moved(const std::vector<const Shape*>& shapes, const std::vector<Pose>& poses,
                        const Eigen::VectorXd& by) {
  std::vector<Pose> result = poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(6 * i);
    const Vec3 turn = by.segment<3>(at) / shapes[i]->radius_mm;
    const double angle = turn.norm();
    if (angle > 0)
      result[i].linear() = Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle) *
                                              Eigen::Quaterniond(poses[i].linear()))
                               .normalized()
                               .toRotationMatrix();
    result[i].translation() += by.segment<3>(at + 3);
  }
  return result;
}

}  // namespace packmerger
