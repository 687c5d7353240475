#include "pack/exact/settle.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "pack/exact/exact_figures.h"
#include "pack/exact/exact_gap.h"

namespace packmerger {
namespace {

constexpr double kFirstStep_mm = 0.25;
constexpr double kLeastStep_mm = 0.005;
constexpr std::array<double, 3> kSideways_mm{0.2, 0.1, 0.05};
constexpr int kTriesEach = 3;             // of a sideways step, while it helps
constexpr double kWorthMoving_mm = 0.01;  // sunk deeper
// Kept where no gap is asked for: at 0 a touch is not told from a cut.
constexpr double kLeastApart_mm = 1e-4;
constexpr double kOfTheRoom = 0.99;  // what a step may take of it

struct Body {
  Body(const PackProblem& problem, const PlacedPart& part) : Body(part_mesh(problem, part), part) {}
  Body(Mesh own_mesh, const PlacedPart& part)
      : mesh(std::move(own_mesh)),
        surface(mesh),
        pose(part.pose),
        box(surface.box(part.pose)),
        tray(part.tray) {}

  Mesh mesh;  // model coordinates
  MovableSurface surface;
  Pose pose;
  Box3 box;
  int tray;
};

// A pose that was tried, the box there and the least distance to another part, as far as it is
// told.
struct Tried {
  Pose pose;
  Box3 box;
  double room_mm = 0;
};

class Settler {
 public:
  Settler(const PackProblem& problem, const Packing& packing, Pace& pace)
      : problem_(problem),
        pace_(pace),
        gap_mm_(std::max(problem.gap_mm, kLeastApart_mm)),
        sideways_mm_(problem.gap_mm / 2 - kLeastStep_mm) {
    std::vector<std::optional<Body>> made(packing.parts.size());
    parallel_tasks(made.size(), [&](std::size_t i) { made[i].emplace(problem, packing.parts[i]); });
    for (std::optional<Body>& body : made) bodies_.push_back(std::move(*body));
  }

  // Lowers a part, then moves it about while it sinks deeper. Returns where it ends.
  Pose settle(std::size_t index) {
    Body& body = bodies_[index];
    Tried here{body.pose, body.box};
    is_clear(index, here);
    here = lowered(index, std::move(here));
    double left_mm = sideways_mm_;
    for (const double step : kSideways_mm)
      for (int i = 0; i < kTriesEach && step <= left_mm && may_sink(here); ++i) {
        std::optional<Tried> deeper = moved_about(index, here, step);
        if (!deeper) break;
        here = std::move(*deeper);
        left_mm -= step;
      }
    body.pose = here.pose;
    body.box = here.box;
    return here.pose;
  }

 private:
  bool may_sink(const Tried& at) const {
    return at.box.min().z() > kLeastStep_mm && pace_.passed() < 1;
  }

  // Enters the room, too, where it is at least the gap.
  bool is_clear(std::size_t index, Tried& at) const {
    at.room_mm = 0;
    if (at.box.min().minCoeff() < 0 || (problem_.build_mm - at.box.max()).minCoeff() < 0)
      return false;
    const Body& body = bodies_[index];
    if (!problem_.plate.surely_clear(at.box) &&
        problem_.plate.breach_mm(body.mesh, at.pose) > kWallTolerance_mm)
      return false;
    double room = std::max(gap_mm_, kFirstStep_mm);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Body& other = bodies_[i];
      if (i == index || other.tray != body.tray) continue;
      if (at.box.exteriorDistance(other.box) >= room) continue;
      pace_.tick();
      room = surface_distance_mm(body.surface, at.pose, other.surface, other.pose, room);
      if (room < gap_mm_) return false;
    }
    at.room_mm = room;
    return true;
  }

  static Tried shifted(const Tried& from, const Vec3& by) {
    return {Eigen::Translation3d(by) * from.pose, from.box.translated(by), 0};
  }

  // Straight down, by steps that are halved where the way is barred. None is longer than the room
  // before it and the gap after it together, so that none leads past what stands out of another
  // part.
  Tried lowered(std::size_t index, Tried at) const {
    double step = kFirstStep_mm;
    while (may_sink(at)) {
      const double free_mm = kOfTheRoom * (at.room_mm + gap_mm_);
      const double by_mm = std::min({step, free_mm, at.box.min().z()});
      if (std::min(step, free_mm) <= kLeastStep_mm) break;
      Tried next = shifted(at, Vec3(0, 0, -by_mm));
      if (is_clear(index, next))
        at = std::move(next);
      else
        step /= 2;
    }
    return at;
  }

  // Moved by at most step_mm at any point, and raised by that much, then lowered: the deepest.
  std::optional<Tried> moved_about(std::size_t index, const Tried& from, double step_mm) const {
    const double angle = step_mm / (from.box.sizes().norm() / 2);
    std::vector<Pose> motions;
    for (const double sign : {1.0, -1.0}) {
      for (const int axis : {0, 1})
        motions.emplace_back(Eigen::Translation3d(sign * step_mm * Vec3::Unit(axis)));
      for (const int axis : {0, 1, 2})
        motions.emplace_back(Eigen::Translation3d(from.box.center()) *
                             Eigen::AngleAxisd(sign * angle, Vec3::Unit(axis)) *
                             Eigen::Translation3d(-from.box.center()));
    }
    std::vector<std::optional<Tried>> found(motions.size());
    parallel_tasks(motions.size(), [&](std::size_t i) {
      Tried moved{Eigen::Translation3d(0, 0, step_mm) * motions[i] * from.pose, {}, 0};
      moved.box = bodies_[index].surface.box(moved.pose);
      if (is_clear(index, moved)) found[i] = lowered(index, std::move(moved));
    });
    std::optional<Tried> deepest;
    double top = from.box.max().z() - kWorthMoving_mm;
    for (std::optional<Tried>& one : found) {
      if (!one || one->box.max().z() >= top) continue;
      top = one->box.max().z();
      deepest = std::move(one);
    }
    return deepest;
  }

  const PackProblem& problem_;
  Pace& pace_;
  double gap_mm_;
  double sideways_mm_;
  std::vector<Body> bodies_;
};

}  // namespace

Packing settled(const PackProblem& problem, Packing packing, Pace& pace) {
  Settler settler(problem, packing, pace);
  for (std::size_t i = 0; i < packing.parts.size(); ++i) {
    packing.parts[i].pose = settler.settle(i);
    keep_inside(packing.parts[i], problem);
  }
  return packing;
}

}  // namespace packmerger
