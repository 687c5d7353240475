#include "pack/fill.h"

namespace packmerger {
namespace {

constexpr std::size_t kManyParts = 40;

}  // namespace

Filler::Filler(const PackProblem& problem, const PartMaker& maker, const std::vector<Part>& parts)
    : problem_(problem), maker_(maker), parts_(parts) {
  rules_.build_mm = problem.build_mm;
  rules_.grid_mm = problem.grid_mm;
  rules_.cost = &problem.cost;
  // With many parts most trays are full, and to make sure of that each time would take too long.
  rules_.thorough = parts.size() <= kManyParts;
}

bool Filler::add_to(Filling& filling, int tray, int part) const {
  TrayState& state = filling.trays[static_cast<std::size_t>(tray)];
  const Part& what = parts_[static_cast<std::size_t>(part)];
  const std::optional<Spot> spot = best_spot(state, what, rules_);
  if (!spot) return false;
  put(state, what, *spot, problem_.grid_mm);
  filling.placed.push_back({part, tray, *spot, false, Pose::Identity()});
  return true;
}

void Filler::add(Filling& filling, int part) const {
  for (int tray = 0; tray < static_cast<int>(filling.trays.size()); ++tray)
    if (add_to(filling, tray, part)) return;
  filling.trays.emplace_back(problem_.build_mm, problem_.grid_mm, maker_.coarse(), maker_.growth());
  if (!add_to(filling, static_cast<int>(filling.trays.size()) - 1, part))
    add_off_grid(filling, part);
}

// A part that fills the tray to within a cell may fit between the grid's positions only. It gets
// its tray for itself.
void Filler::add_off_grid(Filling& filling, int part) const {
  const Part& what = parts_[static_cast<std::size_t>(part)];
  const RotatedPart& rotated = what.rotations->front();
  TrayState& state = filling.trays.back();
  state.closed = true;
  state.contents = Box3(Vec3(0, 0, 0), Vec3(rotated.box.sizes()));
  state.support_mm3 = what.ways.front().support_mm3;
  state.material_mm3 = what.volume_mm3;
  state.parts = 1;
  Pose pose = maker_.pose(what, rotated, 0, 0, 0);
  pose.translation() -= rotated.box.min();
  filling.placed.push_back({part, static_cast<int>(filling.trays.size()) - 1, {}, true, pose});
}

double Filler::cost(const Filling& filling) const {
  double sum = 0;
  for (const TrayState& tray : filling.trays) sum += problem_.cost.evaluate(tray.measure());
  return sum;
}

double Filler::bound(const Filling& filling) const {
  double sum = 0;
  for (const TrayState& tray : filling.trays) sum += problem_.cost.lower_bound(tray.measure());
  return sum;
}

Pose Filler::pose(const Placement& placement) const {
  if (placement.off_grid) return placement.pose;
  const Part& part = parts_[static_cast<std::size_t>(placement.part)];
  const Spot& spot = placement.spot;
  return maker_.pose(part, (*part.rotations)[static_cast<std::size_t>(spot.rotation)], spot.x,
                     spot.y, spot.z);
}

}  // namespace packmerger
