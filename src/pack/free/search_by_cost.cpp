#include "pack/free/search_by_cost.h"

#include <algorithm>
#include <limits>

#include "pack/exact/exact_disassembly.h"
#include "pack/exact/exact_figures.h"
#include "pack/exact/exact_removal.h"
#include "pack/free/cost_search.h"
#include "pack/free/part_shapes.h"
#include "pack/maps/rotations.h"
#include "pack/separate/separation.h"
#include "pack/separate/sinking.h"

namespace packmerger {
namespace {

constexpr int kSinkingPatience = 4;  // failures one after the other
constexpr int kFailuresOfShake = 2;
constexpr double kShake_mm = 0.6;
constexpr double kShakeAngle = 0.04;    // radians
constexpr double kSqueeze = 0.01;       // of what the contents measure along an axis
constexpr double kWallRoom_mm = 0.022;  // the hairs that parts keep from two walls
constexpr int kSeparationSteps = 200;
constexpr double kRaise_mm = 0.5;             // what the lattice found is given so much more height
constexpr double kWorthIt = 0.9995;           // of the cost
constexpr double kHopeless = 1.01;            // of the least cost, after a first fall
constexpr double kLimit = 1.1;                // of the height, for the lattice
constexpr std::size_t kWays = 6;              // up, of a part on the lattice, in all their turns
constexpr std::size_t kMostDrawn = 4000;      // ways of all parts together
constexpr std::size_t kRoundsOfPatience = 5;  // on the lattice, for each of the height field's

// One tray.
class CostedTray {
 public:
  // share: of the time that is left.
  CostedTray(const PackProblem& problem, const std::vector<PlacedPart>& parts,
             std::vector<std::shared_ptr<const Shape>> shapes, const TrayMeasure& figures,
             PartMaker& maker, double share, std::uint64_t seed, Pace& pace)
      : problem_(problem),
        shapes_(std::move(shapes)),
        material_mm3_(figures.material_mm3),
        pace_(pace),
        random_(seed),
        ends_(pace.passed() + share * (1 - pace.passed())),
        least_(problem.cost.evaluate(figures)) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      pointers_.push_back(shapes_[i].get());
      poses_.push_back(own_frame(parts[i].pose, *shapes_[i]));
      ways_.push_back(ways_of(*maker.make(parts[i].items)));
    }
  }

  // Whether the tray became cheaper.
  bool run() {
    sink_down(poses_, 0);
    while (poses_.size() > 1 && !is_over()) {
      const double limit_mm = std::min(problem_.build_mm.z(), kLimit * heights_of(poses_));
      CostSearch search(problem_, {pointers_, ways_}, poses_, limit_mm, apart_mm(), random_.bits(),
                        [this] { return is_over(); });
      search.run(kRoundsOfPatience * static_cast<std::size_t>(std::max(1, problem_.tabu_patience)));
      if (search.cost() < least_) sink_down(search.poses(), kRaise_mm);
      if (!pace_.has_budget()) break;
    }
    return is_cheaper_;
  }

  // Model → tray.
  Pose pose(std::size_t part) const { return part_frame(poses_[part], *shapes_[part]); }
  const ExactDisassembly& plan() const { return plan_; }

 private:
  double apart_mm() const { return std::max(problem_.gap_mm, kLeastApart_mm); }

  bool is_over() const {
    pace_.tick();
    return pace_.passed() >= ends_;
  }

  std::vector<Mat3> ways_of(const Part& part) const {
    const std::vector<double> turns = rotation_set(problem_.rotation_step).turns;
    const std::size_t most = std::max<std::size_t>(1, kMostDrawn / shapes_.size() / turns.size());
    std::vector<Mat3> ways;
    for (std::size_t i = 0; i < std::min({kWays, most, part.ways.size()}); ++i)
      for (const double turn : turns)
        ways.push_back(turn_about_z(part.ways[i].turn + turn) * part.ways[i].base);
    return ways;
  }

  std::vector<Mesh> placed(const std::vector<Pose>& poses) const {
    std::vector<Mesh> placed;
    for (std::size_t i = 0; i < poses.size(); ++i)
      placed.push_back(transformed(shapes_[i]->mesh, poses[i]));
    return placed;
  }

  double heights_of(const std::vector<Pose>& poses) const {
    double height_mm = 0;
    for (std::size_t i = 0; i < poses.size(); ++i)
      height_mm = std::max(height_mm, shapes_[i]->surface.box(poses[i]).max().z());
    return height_mm;
  }

  // Sinks and separates again and again, what fails shaken and squeezed; keeps what is cheaper than
  // all before and can be taken apart. raise_mm: room for the first separation.
  void sink_down(std::vector<Pose> here, double raise_mm) {
    double cost = raise_mm > 0 ? std::numeric_limits<double>::infinity() : least_;
    TrayMeasure figures = measured(problem_, placed(here), material_mm3_);
    int failures = 0;
    for (int tries = 1; failures < kSinkingPatience && !is_over(); ++tries) {
      std::vector<Pose> trial = here;
      if (failures >= kFailuresOfShake) shake(trial, kShake_mm, kShakeAngle, random_);
      if (!fall(trial, figures, failures % 2 == 0 ? -1 : failures / 2 % 3, raise_mm)) {
        ++failures;
        continue;
      }
      const std::vector<Mesh> meshes = placed(trial);
      const TrayMeasure now = measured(problem_, meshes, material_mm3_);
      const double now_costs = problem_.cost.evaluate(now);
      if (now_costs >= cost * kWorthIt || (now_costs < least_ && !is_taken_apart(meshes))) {
        ++failures;
        continue;
      }
      failures = 0;
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

  // squeezed: an axis, or none.
  bool fall(std::vector<Pose>& poses, const TrayMeasure& figures, int squeezed, double raise_mm) {
    Vec3 box = room_at_no_cost(figures);
    box.z() += raise_mm;
    if (problem_.plate.is_whole()) to_corner(poses);
    if (squeezed >= 0) {
      box[squeezed] = std::min(box[squeezed], figures.size_mm[squeezed]) * (1 - kSqueeze);
      for (Pose& pose : poses) pose.translation()[squeezed] *= 1 - kSqueeze;
    }
    box += Vec3::Constant(kWallRoom_mm);
    box = box.cwiseMin(problem_.build_mm);
    const auto over = [this] { return is_over(); };
    sink(pointers_, poses, {box, apart_mm(), problem_.grid_mm, problem_.support_angle},
         problem_.plate, over);
    const Separation separation(pointers_, box.head<2>(), problem_.gap_mm, over, problem_.plate);
    if (!separation.separate(poses, box.z(), kSeparationSteps)) return false;
    let_down(poses);
    return true;
  }

  void let_down(std::vector<Pose>& poses) const {
    double lowest = poses.front().translation().z();
    for (std::size_t i = 0; i < poses.size(); ++i)
      lowest = std::min(lowest, shapes_[i]->surface.box(poses[i]).min().z());
    for (Pose& pose : poses) pose.translation().z() -= lowest;
  }

  // How far the contents may reach along each axis before the tray becomes dearer.
  Vec3 room_at_no_cost(const TrayMeasure& figures) const {
    Vec3 room = figures.size_mm;
    for (int axis = 0; axis < 2; ++axis) {
      if (!problem_.plate.is_whole()) {
        room[axis] = problem_.build_mm[axis];
        continue;
      }
      const double now = problem_.cost.evaluate(figures);
      double dear = problem_.build_mm[axis];
      const auto costs_more = [&](double size_mm) {
        TrayMeasure larger = figures;
        larger.size_mm[axis] = size_mm;
        return problem_.cost.evaluate(larger) > now;
      };
      if (!costs_more(dear)) {
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

  void to_corner(std::vector<Pose>& poses) const {
    Box3 box;
    for (std::size_t i = 0; i < poses.size(); ++i) box.extend(shapes_[i]->surface.box(poses[i]));
    for (Pose& pose : poses) pose.translation().head<2>() -= box.min().head<2>();
  }

  bool is_taken_apart(const std::vector<Mesh>& meshes) {
    ExactDisassembly plan =
        renewed(plan_, StandingParts(meshes, pace_.progress()), problem_.build_mm.head<2>(),
                problem_.plate, [this] { return is_over(); });
    if (!plan.stuck.empty()) return false;
    plan_ = std::move(plan);
    return true;
  }

  const PackProblem& problem_;
  std::vector<std::shared_ptr<const Shape>> shapes_;
  std::vector<const Shape*> pointers_;
  std::vector<std::vector<Mat3>> ways_;  // by part
  double material_mm3_;
  Pace& pace_;
  Random random_;
  double ends_;  // of the pace's time
  double least_;
  std::vector<Pose> poses_;  // of the cheapest
  bool is_cheaper_ = false;  // than at first
  ExactDisassembly plan_;    // of these
};

}  // namespace

std::optional<Packing> searched_by_cost(const PackProblem& problem, Packing packing,
                                        PartMaker& maker, Pace& pace) {
  bool found = false;
  Random random(problem.seed);
  std::vector<int> order;
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    std::vector<std::size_t> here;
    std::vector<PlacedPart> parts;
    for (std::size_t i = 0; i < packing.parts.size(); ++i)
      if (packing.parts[i].tray == tray) {
        here.push_back(i);
        parts.push_back(packing.parts[i]);
      }
    const double trays_left = static_cast<double>(packing.trays.size()) - tray;
    const std::uint64_t seed = random.bits();
    auto shapes = shapes_of(problem, parts, pace);
    std::optional<CostedTray> costed;
    if (!shapes.empty())
      costed.emplace(problem, parts, std::move(shapes),
                     packing.trays[static_cast<std::size_t>(tray)], maker, 1 / trays_left, seed,
                     pace);
    if (!costed || !costed->run()) {
      for (const int part : packing.removal_order)
        if (packing.parts[static_cast<std::size_t>(part)].tray == tray) order.push_back(part);
      continue;
    }
    found = true;
    for (std::size_t i = 0; i < here.size(); ++i) {
      packing.parts[here[i]].pose = costed->pose(i);
      packing.removal_paths[here[i]] = costed->plan().paths[i];
    }
    for (const int part : costed->plan().order)
      order.push_back(static_cast<int>(here[static_cast<std::size_t>(part)]));
  }
  if (!found) return std::nullopt;
  packing.removal_order = std::move(order);
  return packing;
}

}  // namespace packmerger
