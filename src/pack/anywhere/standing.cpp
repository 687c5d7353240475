#include "pack/anywhere/standing.h"

#include <cmath>

#include "pack/maps/rotations.h"

namespace packmerger {
namespace {

constexpr double kTolerance = 1e-7;  // of a cell, and of a unit
constexpr std::size_t kMostSpans = 12'000'000;

Box3 box_of(const std::vector<Mesh>& surfaces, const Mat3& rotation) {
  Box3 box;
  for (const Mesh& surface : surfaces)
    for (const Vec3& point : surface.points()) box.extend(Vec3(rotation * point));
  return box;
}

}  // namespace

SolidMaker::SolidMaker(const PackProblem& problem, const std::vector<std::vector<int>>& parts,
                       const SolidGrid& coarse, const SolidGrid& fine)
    : coarse_(coarse),
      fine_(fine),
      ratio_(static_cast<int>(std::lround(coarse.cell_mm / fine.cell_mm))) {
  for (const std::vector<int>& items : parts) {
    shapes_.emplace_back();
    for (const int item : items)
      shapes_.back().push_back(problem.items[static_cast<std::size_t>(item)].surface);
  }
}

std::shared_ptr<const Attitude> SolidMaker::attitude(int part, const Mat3& rotation) {
  const std::pair key(part, key_of(rotation));
  {
    const std::lock_guard lock(mutex_);
    const auto known = attitudes_.find(key);
    if (known != attitudes_.end()) return known->second;
  }
  const Box3 box = box_of(shapes_[static_cast<std::size_t>(part)], rotation);
  auto made = std::make_shared<const Attitude>(Attitude{rotation, -box.min()});
  const std::lock_guard lock(mutex_);
  return attitudes_.emplace(key, std::move(made)).first->second;
}

StandingPart SolidMaker::standing(int part, const Pose& pose) const {
  const Box3 box = box_of(shapes_[static_cast<std::size_t>(part)], pose.linear());
  const Vec3 corner = box.min() + pose.translation();
  const int x = static_cast<int>(std::floor(corner.x() / fine_.cell_mm + kTolerance));
  const int y = static_cast<int>(std::floor(corner.y() / fine_.cell_mm + kTolerance));
  const int z = static_cast<int>(std::ceil(corner.z() / fine_.unit_mm - kTolerance));
  Attitude attitude{pose.linear(), pose.translation()};
  attitude.shift -= Vec3(x * fine_.cell_mm, y * fine_.cell_mm, 0);
  attitude.shift.z() = -box.min().z();
  return {part, std::make_shared<const Attitude>(attitude), x, y, z};
}

Pose SolidMaker::pose(const StandingPart& standing) const {
  Pose pose = Pose::Identity();
  pose.linear() = standing.attitude->rotation;
  pose.translation() =
      standing.attitude->shift +
      Vec3(standing.x * fine_.cell_mm, standing.y * fine_.cell_mm, standing.z * fine_.unit_mm);
  return pose;
}

std::shared_ptr<const SolidPart> SolidMaker::fine(int part,
                                                  const std::shared_ptr<const Attitude>& attitude) {
  return drawn(part, attitude, {attitude.get(), -1, 0, 0}, fine_, Vec3::Zero());
}

std::shared_ptr<const SolidPart> SolidMaker::coarse(int part,
                                                    const std::shared_ptr<const Attitude>& attitude,
                                                    int fine_x, int fine_y) {
  return drawn(part, attitude, {attitude.get(), 0, fine_x, fine_y}, coarse_,
               Vec3(fine_x * fine_.cell_mm, fine_y * fine_.cell_mm, 0));
}

std::shared_ptr<const SolidPart> SolidMaker::drawn(int part,
                                                   const std::shared_ptr<const Attitude>& attitude,
                                                   const Key& key, const SolidGrid& grid,
                                                   const Vec3& moved) {
  {
    const std::lock_guard lock(mutex_);
    const auto known = drawings_.find(key);
    if (known != drawings_.end()) return known->second.part;
  }
  std::vector<Mesh> turned = shapes_[static_cast<std::size_t>(part)];
  for (Mesh& surface : turned) {
    std::vector<Vec3> points = surface.points();
    for (Vec3& point : points) point = attitude->rotation * point + attitude->shift + moved;
    surface = surface.with_points(std::move(points));
  }
  auto made = std::make_shared<const SolidPart>(solid_part(turned, grid));
  const std::lock_guard lock(mutex_);
  spans_ += made->matter.size() + made->reach.size() + made->centres.size();
  return drawings_.emplace(key, Drawing{attitude, std::move(made)}).first->second.part;
}

void SolidMaker::forget_some() {
  if (spans_ < kMostSpans) return;
  spans_ = 0;
  drawings_.clear();
  attitudes_.clear();
}

}  // namespace packmerger
