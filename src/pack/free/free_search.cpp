#include "pack/free/free_search.h"

#include <algorithm>
#include <memory>

#include "base/parallel.h"
#include "pack/exact/exact_disassembly.h"
#include "pack/exact/exact_figures.h"
#include "pack/exact/exact_removal.h"
#include "pack/free/limit_search.h"
#include "pack/free/tray_shapes.h"
#include "pack/maps/rotations.h"
#include "pack/separate/compression.h"

namespace packmerger {
namespace {

constexpr double kEarly = 0.2;  // of the time: only what is much lower is made exact
constexpr double kMuchLower_mm = 1;
constexpr double kSearchShare = 0.6;            // of the time, before the compression
constexpr std::size_t kRoundsOfPatience = 400;  // for each round of the height field's search
constexpr std::size_t kRoundsOfTurn = 6000;  // without a layout, before the lattice begins afresh
constexpr double kLastTurn = 0.98;           // of the time: none begins after it
constexpr int kSeparationSteps = 150;
constexpr double kRaise = 0.012;  // of the height, where separation found no room
constexpr double kMostRaised = 0.05;
constexpr double kWorthIt = 0.999;            // of the lowest height
constexpr double kWorthSeparating_mm = 0.25;  // below the lowest one
constexpr double kShake_mm = 0.3;             // of what jammed
constexpr std::size_t kMostStuckTakenOut = 2;
constexpr int kMostStuckLayouts = 10;     // one after the other: what is low there has no way out
constexpr int kCompressionPatience = 16;  // failures one after the other

std::vector<Mat3> right_angles() {
  const RotationSet set = rotation_set(radians(90));
  std::vector<Mat3> rotations;
  for (const Mat3& way : set.ways_up)
    for (const double turn : set.turns) rotations.push_back(turn_about_z(turn) * way);
  return rotations;
}

// One tray.
class FreeSearch {
 public:
  // share: of the time that is left.
  FreeSearch(const PackProblem& problem, std::vector<std::shared_ptr<const Shape>> shapes,
             const std::vector<Pose>& start, double share, std::uint64_t seed, Pace& pace)
      : problem_(problem),
        shapes_(std::move(shapes)),
        start_(start),
        pace_(pace),
        random_(seed),
        separation_(
            pointers(), problem.build_mm.head<2>(), problem.gap_mm, [this] { return is_over(1); },
            problem.plate),
        began_(pace.passed()),
        time_(share * (1 - began_)) {
    lowest_mm_ = separation_.height_mm(start);
    start_mm_ = lowest_mm_;
  }

  // Whether there is a lower layout than the start. With a budget, lattice and compression take
  // turns: what jams in the one goes on in the other.
  bool run() {
    double until = kSearchShare;
    do {
      lower_on_lattice(until);
      compress_lowest();
      until += kSearchShare * (1 - until);
    } while (pace_.has_budget() && !is_over(kLastTurn));
    return !poses_.empty();
  }

  const std::vector<Pose>& poses() const { return poses_; }
  const ExactDisassembly& plan() const { return plan_; }

 private:
  std::vector<const Shape*> pointers() const {
    std::vector<const Shape*> shapes;
    for (const auto& shape : shapes_) shapes.push_back(shape.get());
    return shapes;
  }

  // share: of the time that the tray has.
  bool is_over(double share) const {
    pace_.tick();
    return pace_.passed() >= began_ + share * time_;
  }

  void lower_on_lattice(double until) {
    if (!lattice_)
      lattice_.emplace(FreeParts{pointers(), right_angles()}, problem_.build_mm.head<2>(),
                       problem_.plate, std::max(problem_.gap_mm, kLeastApart_mm), start_, start_mm_,
                       random_.bits());
    std::size_t rounds = 0;
    int stuck_layouts = 0;
    const std::size_t patience =
        pace_.has_budget()
            ? kRoundsOfTurn
            : kRoundsOfPatience * static_cast<std::size_t>(std::max(1, problem_.tabu_patience));
    while (stuck_layouts < kMostStuckLayouts &&
           lattice_->next([&] { return is_over(until) || ++rounds > patience; })) {
      rounds = 0;
      const double lower_mm =
          pace_.has_budget() && !is_over(kEarly) ? kMuchLower_mm : kWorthSeparating_mm;
      if (lattice_->height_mm() < lowest_mm_ - lower_mm) {
        const std::vector<int> stuck = made_exact(*lattice_);
        if (!stuck.empty()) {
          ++stuck_layouts;
          lattice_->take_out(some_of(stuck));
          continue;
        }
      }
      stuck_layouts = 0;
      lattice_->lower_limit();
    }
    // The next turn begins with another layout.
    if (rounds > patience || stuck_layouts == kMostStuckLayouts) lattice_.reset();
  }

  void compress_lowest() {
    std::vector<Pose> poses = poses_.empty() ? start_ : poses_;
    compress(
        separation_, poses, kCompressionPatience, [this] { return is_over(1); },
        [this](const std::vector<Pose>& lower, double height_mm) {
          return certified(lower, height_mm).empty();
        },
        random_);
  }

  std::vector<int> some_of(const std::vector<int>& stuck) {
    std::vector<int> some;
    for (std::size_t i = 1 + random_.below(std::min(kMostStuckTakenOut, stuck.size())); i > 0; --i)
      some.push_back(stuck[random_.below(stuck.size())]);
    return some;
  }

  // Separates what the lattice found, at its height or a little above, where that is low enough.
  // Returns the parts that cannot be taken out of what came of it.
  std::vector<int> made_exact(const LimitSearch& search) {
    const double height_mm = search.height_mm();
    for (double raised = 0;
         raised < kMostRaised && height_mm * (1 + raised) < kWorthIt * lowest_mm_;
         raised += kRaise) {
      std::vector<Pose> poses = search.poses();
      if (raised > 0) {
        shake(poses, kShake_mm, 0, random_);
        squeeze(poses, -raised);
      }
      if (separation_.separate(poses, height_mm * (1 + raised), kSeparationSteps))
        return certified(poses, separation_.height_mm(poses));
      if (is_over(1)) break;
    }
    return {};
  }

  // Keeps the layout where every part has a way out; returns those that have none.
  std::vector<int> certified(const std::vector<Pose>& poses, double height_mm) {
    const Progress& progress = pace_.progress();
    std::vector<Mesh> placed;
    for (std::size_t i = 0; i < poses.size(); ++i)
      placed.push_back(transformed(shapes_[i]->mesh, poses[i]));
    if (plan_.order.empty() || first_obstacle(placed, plan_.order, plan_.paths, progress)) {
      ExactDisassembly plan =
          exact_disassembly(placed, problem_.build_mm.head<2>(), progress, problem_.plate);
      if (!plan.stuck.empty()) return plan.stuck;
      plan_ = std::move(plan);
    }
    poses_ = poses;
    lowest_mm_ = height_mm;
    return {};
  }

  const PackProblem& problem_;
  std::vector<std::shared_ptr<const Shape>> shapes_;
  const std::vector<Pose>& start_;
  Pace& pace_;
  Random random_;
  Separation separation_;
  double began_;
  double time_;
  double start_mm_ = 0;
  double lowest_mm_ = 0;
  std::optional<LimitSearch> lattice_;
  std::vector<Pose> poses_;  // the lowest that can be taken apart; empty: the start
  ExactDisassembly plan_;    // of these
};

}  // namespace

std::optional<Packing> searched_freely(const PackProblem& problem, Packing packing, Pace& pace) {
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
    const auto shapes = shapes_of(problem, parts);
    std::vector<Pose> start;
    for (std::size_t i = 0; i < parts.size(); ++i)
      start.push_back(own_frame(parts[i].pose, *shapes[i]));
    const double trays_left = static_cast<double>(packing.trays.size()) - tray;
    FreeSearch search(problem, shapes, start, 1 / trays_left, random.bits(), pace);
    if (!search.run()) {
      for (const int part : packing.removal_order)
        if (packing.parts[static_cast<std::size_t>(part)].tray == tray) order.push_back(part);
      continue;
    }
    found = true;
    std::vector<Pose> poses = search.poses();
    let_down(poses, shapes);
    for (std::size_t i = 0; i < here.size(); ++i) {
      packing.parts[here[i]].pose = poses[i] * Eigen::Translation3d(-shapes[i]->centre);
      packing.removal_paths[here[i]] = search.plan().paths[i];
    }
    for (const int part : search.plan().order)
      order.push_back(static_cast<int>(here[static_cast<std::size_t>(part)]));
  }
  if (!found) return std::nullopt;
  packing.removal_order = std::move(order);
  return packing;
}

}  // namespace packmerger
