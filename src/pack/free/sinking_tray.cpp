#include "pack/free/sinking_tray.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "pack/exact/exact_figures.h"
#include "pack/exact/exact_removal.h"
#include "pack/free/part_shapes.h"
#include "pack/separate/separation.h"
#include "pack/separate/sinking.h"

namespace packmerger {
namespace {

constexpr int kFailuresOfShake = 2;
constexpr double kShake_mm = 0.6;
constexpr double kShakeAngle = 0.04;    // radians
constexpr double kSqueeze = 0.01;       // of what the contents measure along an axis
constexpr double kWallRoom_mm = 0.022;  // the hairs that parts keep from two walls
constexpr int kSeparationSteps = 200;
constexpr double kWorthIt = 0.9995;  // of the cost
constexpr double kHopeless = 1.01;   // of the least cost, after a first fall
constexpr int kPatienceOfSettling = 2;

}  // namespace

SinkingTray::SinkingTray(const PackProblem& problem, const std::vector<PlacedPart>& parts,
                         std::vector<std::shared_ptr<const Shape>> shapes,
                         const TrayMeasure& figures, std::uint64_t seed,
                         std::function<bool()> is_over, IsAccepted is_accepted)
    : problem_(problem),
      shapes_(std::move(shapes)),
      material_mm3_(figures.material_mm3),
      random_(seed),
      is_over_(std::move(is_over)),
      is_accepted_(std::move(is_accepted)),
      least_(problem.cost.evaluate(figures)) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    pointers_.push_back(shapes_[i].get());
    poses_.push_back(own_frame(parts[i].pose, *shapes_[i]));
  }
}

double SinkingTray::height_mm() const { return contents(poses_).max().z(); }

Pose SinkingTray::pose(std::size_t part) const { return part_frame(poses_[part], *shapes_[part]); }

double SinkingTray::apart_mm() const { return std::max(problem_.gap_mm, kLeastApart_mm); }

std::vector<Mesh> SinkingTray::placed(const std::vector<Pose>& poses) const {
  std::vector<Mesh> placed;
  for (std::size_t i = 0; i < poses.size(); ++i)
    placed.push_back(transformed(shapes_[i]->mesh, poses[i]));
  return placed;
}

Box3 SinkingTray::contents(const std::vector<Pose>& poses) const {
  Box3 box;
  for (std::size_t i = 0; i < poses.size(); ++i) box.extend(shapes_[i]->surface.box(poses[i]));
  return box;
}

void SinkingTray::sink(std::vector<Pose> here, double raise_mm, int patience) {
  double cost = raise_mm > 0 ? std::numeric_limits<double>::infinity() : least_;
  TrayMeasure figures = measured(problem_, placed(here), material_mm3_);
  const std::vector<int> axes = squeezable(figures);
  for (int failures = 0; failures < patience && !is_over_(); ++failures) {
    std::vector<Pose> trial = here;
    if (failures >= kFailuresOfShake) shake(trial, kShake_mm, kShakeAngle, random_);
    const bool squeezes = failures % 2 == 1 && !axes.empty();
    const int axis = squeezes ? axes[static_cast<std::size_t>(failures / 2) % axes.size()] : -1;
    if (!fall(trial, figures, axis, raise_mm)) continue;
    const std::vector<Mesh> meshes = placed(trial);
    const TrayMeasure now = measured(problem_, meshes, material_mm3_);
    const double now_costs = problem_.cost.evaluate(now);
    if (now_costs >= cost * kWorthIt || (now_costs < least_ && !is_accepted_(meshes))) continue;
    failures = -1;
    raise_mm = 0;
    here = std::move(trial);
    cost = now_costs;
    figures = now;
    if (cost > kHopeless * least_) return;
    if (cost >= least_) continue;
    least_ = cost;
    poses_ = here;
    is_cheaper_ = true;
  }
}

// squeezed: an axis, or -1.
bool SinkingTray::fall(std::vector<Pose>& poses, const TrayMeasure& figures, int squeezed,
                       double raise_mm) {
  Vec3 box = room_at_no_cost(figures);
  box.z() += raise_mm;
  if (problem_.plate.is_whole()) {
    const Vec3 corner = contents(poses).min();
    for (Pose& pose : poses) pose.translation().head<2>() -= corner.head<2>();
  }
  if (squeezed >= 0) {
    box[squeezed] = std::min(box[squeezed], figures.size_mm[squeezed]) * (1 - kSqueeze);
    for (Pose& pose : poses) pose.translation()[squeezed] *= 1 - kSqueeze;
  }
  box += Vec3::Constant(kWallRoom_mm);
  box = box.cwiseMin(problem_.build_mm);
  packmerger::sink(pointers_, poses, {box, apart_mm(), problem_.grid_mm, problem_.support_angle},
                   problem_.plate, is_over_);
  const Separation separation(pointers_, box.head<2>(), problem_.gap_mm, is_over_, problem_.plate);
  if (!separation.separate(poses, box.z(), kSeparationSteps)) return false;
  let_down(poses, shapes_);
  return true;
}

// The axes along which a smaller tray is cheaper at once, the height first.
std::vector<int> SinkingTray::squeezable(const TrayMeasure& figures) const {
  std::vector<int> axes;
  for (const int axis : {2, 1, 0}) {
    TrayMeasure smaller = figures;
    smaller.size_mm[axis] *= 1 - kSqueeze;
    if (problem_.cost.evaluate(smaller) < problem_.cost.evaluate(figures)) axes.push_back(axis);
  }
  return axes;
}

// How far the contents may reach along each axis before the tray becomes dearer.
Vec3 SinkingTray::room_at_no_cost(const TrayMeasure& figures) const {
  Vec3 room = figures.size_mm;
  const double now = problem_.cost.evaluate(figures);
  for (int axis = 0; axis < 2; ++axis) {
    const auto costs_more = [&](double size_mm) {
      TrayMeasure larger = figures;
      larger.size_mm[axis] = size_mm;
      return problem_.cost.evaluate(larger) > now;
    };
    double dear = problem_.build_mm[axis];
    // Walls stand where they are: contents beside them are not moved to the corner.
    if (!problem_.plate.is_whole() || !costs_more(dear)) {
      room[axis] = dear;
      continue;
    }
    while (dear - room[axis] > kWallRoom_mm) {
      const double middle = (dear + room[axis]) / 2;
      (costs_more(middle) ? dear : room[axis]) = middle;
    }
    room[axis] = std::max(figures.size_mm[axis], room[axis] - kWallRoom_mm);
  }
  return room;
}

std::optional<Packing> sunk(const PackProblem& problem, Packing packing, Pace& pace) {
  bool found = false;
  Random random(problem.seed);
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    const TrayParts here = parts_of(packing, tray);
    const std::uint64_t seed = random.bits();
    auto shapes = shapes_of(problem, here.parts, pace);
    if (shapes.empty()) continue;
    SinkingTray sinking(
        problem, here.parts, std::move(shapes), packing.trays[static_cast<std::size_t>(tray)], seed,
        [&pace] {
          pace.tick();
          return pace.passed() >= 1;
        },
        [&](const std::vector<Mesh>& placed) {
          return !first_obstacle(placed, here.order, {}, pace.progress());
        });
    sinking.sink(kPatienceOfSettling);
    if (!sinking.is_cheaper()) continue;
    found = true;
    for (std::size_t i = 0; i < here.parts.size(); ++i)
      packing.parts[here.indices[i]].pose = sinking.pose(i);
  }
  if (!found) return std::nullopt;
  return packing;
}

}  // namespace packmerger
