#include "pack/free/free_search.h"

#include <algorithm>

#include "pack/exact/exact_disassembly.h"
#include "pack/exact/exact_figures.h"
#include "pack/exact/exact_removal.h"
#include "pack/free/limit_search.h"
#include "pack/free/part_shapes.h"
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
// Of work where there is no budget, for each round of the height field's patience: about what that
// spends on as many parts.
constexpr double kStepsOfPatience = 3e8;  // of all trays
constexpr double kStepsOfPart = 2e6;
constexpr double kStepsOfSecond = 1e9;  // of a budget
constexpr double kProofShare = 0.8;     // of all the work, that looking for ways out may take
constexpr double kRoomForProof = 0.1;   // of the time, at most, that is left for the last one
constexpr int kSeparationSteps = 150;
constexpr double kRaise = 0.012;  // of the height, where separation found no room
constexpr double kMostRaised = 0.05;
constexpr double kWorthIt = 0.999;            // of the lowest height
constexpr double kWorthSeparating_mm = 0.25;  // below the lowest one
constexpr double kShake_mm = 0.3;             // of what jammed
constexpr std::size_t kMostStuckTakenOut = 2;
constexpr int kMostStuckLayouts = 10;     // one after the other: what is low there has no way out
constexpr int kCompressionPatience = 16;  // failures one after the other
constexpr double kGapTolerance_mm = 1e-6;
constexpr double kGapTold_mm = 1e-3;

std::vector<Mat3> right_angles() {
  const RotationSet set = rotation_set(radians(90));
  std::vector<Mat3> rotations;
  for (const Mat3& way : set.ways_up)
    for (const double turn : set.turns) rotations.push_back(turn_about_z(turn) * way);
  return rotations;
}

// Of a tray that has such a share of all trays' work.
double most_steps(const PackProblem& problem, double share, std::size_t parts) {
  return std::max(1, problem.tabu_patience) *
         (share * kStepsOfPatience + static_cast<double>(parts) * kStepsOfPart);
}

// One tray.
class FreeSearch {
 public:
  // parts: of the tray, where they stand. share: of the time that is left, or of the work that all
  // trays may take.
  FreeSearch(const PackProblem& problem, std::vector<PlacedPart> parts,
             std::vector<std::shared_ptr<const Shape>> shapes, double share, std::uint64_t seed,
             Pace& pace)
      : problem_(problem),
        parts_(std::move(parts)),
        shapes_(std::move(shapes)),
        pace_(pace),
        random_(seed),
        separation_(
            pointers(), problem.build_mm.head<2>(), problem.gap_mm, [this] { return is_over(1); },
            problem.plate, &effort_),
        began_(pace.passed()),
        time_(share * (1 - began_)),
        most_steps_(pace.has_budget() ? time_ * problem.budget_s * kStepsOfSecond
                                      : most_steps(problem, share, parts_.size())) {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      start_.push_back(own_frame(parts_[i].pose, *shapes_[i]));
    lowest_mm_ = separation_.height_mm(start_);
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

  const std::vector<PlacedPart>& parts() const { return parts_; }
  const ExactDisassembly& plan() const { return plan_; }
  std::uint64_t spent() const { return effort_.spent(); }

 private:
  std::vector<const Shape*> pointers() const {
    std::vector<const Shape*> shapes;
    for (const auto& shape : shapes_) shapes.push_back(shape.get());
    return shapes;
  }

  // Of the time that the tray has; of the work that it may take, where there is no budget.
  double passed() const {
    return pace_.has_budget() ? (pace_.passed() - began_) / time_
                              : static_cast<double>(effort_.spent()) / most_steps_;
  }

  // Whether so large a share has passed. The end leaves room for the proof of what is found.
  bool is_over(double share) const {
    pace_.tick();
    return passed() >= std::min(share, 1 - last_proof_);
  }

  void lower_on_lattice(double until) {
    if (!lattice_)
      lattice_.emplace(
          FreeParts{pointers(), right_angles()}, problem_.build_mm.head<2>(), problem_.plate,
          std::max(problem_.gap_mm, kLeastApart_mm), start_, start_mm_, random_.bits(),
          [this] { return is_over(1); }, effort_);
    std::size_t rounds = 0;
    int stuck_layouts = 0;
    const std::size_t patience =
        pace_.has_budget()
            ? kRoundsOfTurn
            : kRoundsOfPatience * static_cast<std::size_t>(std::max(1, problem_.tabu_patience));
    while (stuck_layouts < kMostStuckLayouts &&
           lattice_->next([&] { return is_over(until) || ++rounds > patience; })) {
      rounds = 0;
      const double lower_mm = is_over(kEarly) ? kWorthSeparating_mm : kMuchLower_mm;
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
        [this](const std::vector<Pose>& lower, double) {
          std::vector<int> stuck;
          return certified(lower, stuck);
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
    std::vector<int> stuck;
    const double height_mm = search.height_mm();
    for (double raised = 0;
         raised < kMostRaised && height_mm * (1 + raised) < kWorthIt * lowest_mm_;
         raised += kRaise) {
      std::vector<Pose> poses = search.poses();
      if (raised > 0) {
        shake(poses, kShake_mm, 0, random_);
        squeeze(poses, -raised);
      }
      if (separation_.separate(poses, height_mm * (1 + raised), kSeparationSteps)) {
        certified(poses, stuck);
        break;
      }
      if (is_over(1)) break;
    }
    return stuck;
  }

  // Keeps the layout where it holds what is promised, on the poses that are its last: every part
  // has a way out, and its gap. stuck: the parts that have no way out.
  bool certified(std::vector<Pose> poses, std::vector<int>& stuck) {
    const double began = passed();
    let_down(poses, shapes_);
    std::vector<PlacedPart> parts = parts_;
    std::vector<Mesh> placed;
    std::vector<MovableSurface> surfaces;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      parts[i].pose = part_frame(poses[i], *shapes_[i]);
      keep_inside(parts[i], problem_);
      poses[i] = own_frame(parts[i].pose, *shapes_[i]);
      placed.push_back(placed_mesh(problem_, parts[i]));
      surfaces.push_back(shapes_[i]->surface);
    }
    const StandingParts standing(placed, std::move(surfaces), poses, pace_.progress());
    ExactDisassembly plan = plan_of(standing);
    effort_.spend(standing.steps());
    stuck = plan.stuck;
    const bool is_kept = stuck.empty() && least_gap_mm(placed, problem_.gap_mm + kGapTold_mm) >=
                                              problem_.gap_mm - kGapTolerance_mm;
    last_proof_ = std::min(kRoomForProof, passed() - began);
    if (!is_kept) return false;
    plan_ = std::move(plan);
    parts_ = std::move(parts);
    poses_ = std::move(poses);
    lowest_mm_ = separation_.height_mm(poses_);
    return true;
  }

  ExactDisassembly plan_of(const StandingParts& standing) const {
    return renewed(plan_, standing, problem_.build_mm.head<2>(), problem_.plate, [&] {
      pace_.tick();
      return passed() >= 1 || static_cast<double>(standing.steps()) > kProofShare * most_steps_;
    });
  }

  const PackProblem& problem_;
  std::vector<PlacedPart> parts_;  // the lowest that can be taken apart, or the start
  std::vector<std::shared_ptr<const Shape>> shapes_;
  std::vector<Pose> start_;
  Pace& pace_;
  Random random_;
  Effort effort_;
  Separation separation_;
  double began_;
  double time_;
  double most_steps_;
  double last_proof_ = 0;  // of the time
  double start_mm_ = 0;
  double lowest_mm_ = 0;
  std::optional<LimitSearch> lattice_;
  std::vector<Pose> poses_;  // of parts_; empty: the start
  ExactDisassembly plan_;    // of these
};

}  // namespace

std::optional<Packing> searched_freely(const PackProblem& problem, Packing packing, Pace& pace,
                                       Effort& effort) {
  bool found = false;
  Random random(problem.seed);
  std::vector<int> order;
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    TrayParts here = parts_of(packing, tray);
    const auto trays = static_cast<double>(packing.trays.size());
    const double share = pace.has_budget() ? 1 / (trays - tray) : 1 / trays;
    const std::uint64_t seed = random.bits();
    auto shapes = shapes_of(problem, here.parts, pace);
    std::optional<FreeSearch> search;
    if (!shapes.empty())
      search.emplace(problem, std::move(here.parts), std::move(shapes), share, seed, pace);
    const bool is_lower = search && search->run();
    if (search) effort.spend(search->spent());
    if (!is_lower) {
      for (const int part : here.order)
        order.push_back(static_cast<int>(here.indices[static_cast<std::size_t>(part)]));
      continue;
    }
    found = true;
    for (std::size_t i = 0; i < here.indices.size(); ++i) {
      packing.parts[here.indices[i]] = search->parts()[i];
      packing.removal_paths[here.indices[i]] = search->plan().paths[i];
    }
    for (const int part : search->plan().order)
      order.push_back(static_cast<int>(here.indices[static_cast<std::size_t>(part)]));
  }
  if (!found) return std::nullopt;
  packing.removal_order = std::move(order);
  return packing;
}

}  // namespace packmerger
