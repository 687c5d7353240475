#include "pack/pack.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "base/parallel.h"
#include "pack/exact/exact_figures.h"
#include "pack/exact/settle.h"
#include "pack/free/free_search.h"
#include "pack/free/search_by_cost.h"
#include "pack/free/sinking_tray.h"
#include "pack/maps/ways_up.h"
#include "pack/search/refine.h"
#include "pack/search/search.h"

namespace packmerger {
namespace {

constexpr double kGapTolerance_mm = 1e-6;
constexpr int kRepairs = 6;
constexpr double kTrialRotation = std::numbers::pi / 3;  // at least: parts have their own ways up
constexpr int kTrialPatience = 3;
constexpr double kFinestShare = 0.25;       // of grid_mm: the grid of the last refinement
constexpr double kMostCells = 4e6;          // of a tray
constexpr double kMostCellsAcross = 15000;  // HeightCell counts them in 16 bits
constexpr int kFinestPasses = 3;
constexpr double kCellsOfItem = 10;           // along an item on average, at least
constexpr double kDroppingShare = 0.4;        // of the budget: for layouts of dropped parts
constexpr double kDroppingShareOfFree = 0.1;  // where they are but where a free search begins
constexpr std::size_t kMostSunk = 60;         // parts: the distances round more take much memory
constexpr double kInTime = 0.97;              // of the budget: room for the last measurement
constexpr double kAboutEqual = 1.005;         // costs: the layout of fewest parts is taken
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The last refinement's, coarser on a tray so large that it would take too much memory.
double finest_cell_mm(const PackProblem& problem) {
  return std::max(problem.grid_mm * kFinestShare,
                  std::sqrt(problem.build_mm.x() * problem.build_mm.y() / kMostCells));
}

// Whether nothing but the height of a tray makes it dear.
bool height_alone_counts(const PackProblem& problem) {
  TrayMeasure narrow;
  narrow.size_mm = problem.build_mm / 2;
  TrayMeasure wide = narrow;
  wide.size_mm.head<2>() = problem.build_mm.head<2>();
  wide.support_mm3 = problem.build_mm.prod();
  return problem.cost.evaluate(wide) == problem.cost.evaluate(narrow);
}

void check_settings(const PackProblem& problem) {
  const auto refuse = [](const std::string& what, const char* hint) {
    throw Error(Fault::kUsage, what, hint);
  };
  if (problem.items.empty()) refuse("There is nothing to pack", "Give a model.");
  if (!(problem.grid_mm > 0) || !(problem.search_grid_mm > 0))
    refuse("The packer's grid must be above 0 mm", "Set grid_mm and search_grid_mm to 1 or so.");
  if (!(problem.gap_mm >= 0)) refuse("The gap must not be negative", "Set gap_mm to 0 or more.");
  if (!(problem.build_mm.minCoeff() > 0))
    refuse("The build volume is empty", "Set build_mm to the printer's size.");
  const double cell_mm = finest_cell_mm(problem);
  const double widest_mm = problem.build_mm.head<2>().maxCoeff();
  if (cell_mm > problem.grid_mm || widest_mm / cell_mm > kMostCellsAcross)
    refuse("The packer's grid is too fine for this build volume", "Set a larger grid_mm.");
  for (const PackItem& item : problem.items) {
    const Vec3 size = bounding_box(item.surface).sizes();
    if (size.norm() / cell_mm > kMostCellsAcross)
      throw Error(Fault::kBadInput,
                  "A part measures " + std::to_string(std::lround(size.maxCoeff())) +
                      " mm, more than the packer's grid can hold",
                  "Check the model's unit, or set a larger grid_mm.");
  }
}

// Stands in the tray's corner, or where a plate with walls has room for it.
Pose corner_pose(const PackProblem& problem, const Part& part) {
  const WayUp& way = part.ways.front();
  PlacedPart placed{part.items, Pose::Identity(), 0};
  placed.pose.linear() = turn_about_z(way.turn) * way.base;
  const Mesh standing = placed_mesh(problem, placed);
  placed.pose.translation() = -bounding_box(standing).min();
  if (problem.plate.is_whole()) return placed.pose;
  const std::optional<Vec2> spot = spot_on(problem, standing);
  if (!spot) throw Error(Fault::kInternal, "A part lost its place on the plate", "");
  placed.pose.translation().head<2>() = *spot;
  return placed.pose;
}

// Parts come tray by tray, each tray's in the order they were dropped; lifting them in the reverse
// order, nothing lies above the part that is next.
Packing packing_of(const Layout& layout, const PartMaker& maker, const PackProblem& problem) {
  Packing packing;
  for (std::size_t tray = 0; tray < layout.trays.size(); ++tray)
    for (const Placed& placed : layout.trays[tray]->placed) {
      const Pose pose = placed.off_grid ? corner_pose(problem, *placed.part)
                                        : maker.pose(*placed.rotated, placed.x, placed.y, placed.z);
      packing.parts.push_back({placed.part->items, pose, static_cast<int>(tray)});
      keep_inside(packing.parts.back(), problem);
    }
  packing.removal_order.resize(packing.parts.size());
  std::iota(packing.removal_order.rbegin(), packing.removal_order.rend(), 0);
  packing.removal_paths.resize(packing.parts.size());
  measure(problem, packing);
  return packing;
}

Grid grid_of(const PackProblem& problem, double cell_mm, bool bounds, double margin_mm = 0) {
  return {cell_mm, height_unit_mm(problem.build_mm.z()), problem.gap_mm + margin_mm, bounds};
}

// Cells as coarse as the parts allow: on few cells of a small part a layout tells little of what a
// finer grid makes of it.
Grid search_grid(const PackProblem& problem) {
  double longest_mm = 0;
  for (const PackItem& item : problem.items)
    longest_mm += bounding_box(item.surface).sizes().maxCoeff();
  const double cell_mm = longest_mm / static_cast<double>(problem.items.size()) / kCellsOfItem;
  return grid_of(problem, std::max(problem.grid_mm, std::min(cell_mm, problem.search_grid_mm)),
                 false);
}

// A maker and the trays of one grid.
struct Workshop {
  Workshop(const PackProblem& problem, const Grid& grid, Pace& pace)
      : spec{problem.build_mm, grid, &problem.cost},
        maker(problem, spec.grid, [&pace] { pace.tick(); }),
        layouter(spec) {}

  TraySpec spec;
  PartMaker maker;
  Layouter layouter;
};

// Takes what the search found on its grid over to the answer's grid and to the finest. Layouts
// share what was drawn for them. Thread-safe.
class Finisher {
 public:
  // margin_mm is added to the gap. All must outlive it.
  Finisher(const PackProblem& problem, const Grid& found_on, double margin_mm, Pace& pace)
      : problem_(problem),
        found_on_(found_on),
        placing_(problem, grid_of(problem, problem.grid_mm, true, margin_mm), pace),
        finest_(problem, grid_of(problem, finest_cell_mm(problem), true, margin_mm), pace) {}

  // With exact gaps parts need more room than the search gave them, which adds up over a row: where
  // a short reach piles them up, they are all placed anew. Where that loses a row's last place, the
  // finest grid still has it.
  Packing finished(const Layout& found) {
    const double cell_mm = found_on_.cell_mm;
    const Layout placed = refined(found, found_on_, placing_.layouter, placing_.maker,
                                  {0, cell_mm, 4 * cell_mm, kInfinity}, false);
    const Layout by_way = to_finest(placed);
    const Layout direct =
        refined(found, found_on_, finest_.layouter, finest_.maker, {0, cell_mm, 2 * cell_mm}, true);
    return on_finest(is_better(direct, by_way) ? direct : by_way);
  }

  // Each part alone on the plate, the best way up.
  Packing side_by_side() {
    Random unused(0);
    Moves moves(problem_, placing_.maker);
    const RotationChoice best_alone = [&moves](const Part& part) {
      return moves.good_rotations(part, 1);
    };
    return on_finest(to_finest(
        *placing_.layouter.carried_out(moves.start(true, unused), best_alone, kInfinity, true)));
  }

 private:
  Layout to_finest(const Layout& placed) {
    return refined(placed, placing_.spec.grid, finest_.layouter, finest_.maker,
                   {0, problem_.grid_mm}, true);
  }

  Packing on_finest(Layout layout) {
    const double reach_mm = problem_.grid_mm;
    for (int pass = 1; pass < kFinestPasses; ++pass) {
      Layout again = refined(layout, finest_.spec.grid, finest_.layouter, finest_.maker,
                             {0, reach_mm / 2}, true);
      if (!is_better(again, layout)) break;
      layout = std::move(again);
    }
    return packing_of(layout, finest_.maker, problem_);
  }

  const PackProblem& problem_;
  const Grid& found_on_;
  Workshop placing_;
  Workshop finest_;
};

// Settled, or sunk where support counts too and parts are few, where that is cheaper.
Packing closer(const PackProblem& problem, Packing packing, Pace& pace) {
  std::optional<Packing> close;
  if (height_alone_counts(problem) || packing.parts.size() > kMostSunk)
    close = settled(problem, packing, pace);
  else
    close = sunk(problem, packing, pace);
  if (!close) return packing;
  for (PlacedPart& part : close->parts) keep_inside(part, problem);
  measure(problem, *close);
  return close->cost < packing.cost ? *close : packing;
}

// The answer, its gaps checked on the meshes. The maps bound those, so there is nothing to repair
// but where rounding lost more than was allowed for; then the layout is finished again with that
// much more room.
Packing with_gaps_kept(const std::function<Packing(Finisher&)>& finish, const Grid& grid,
                       Packing packing, const PackProblem& problem, Pace& pace) {
  double margin = 0;
  for (int repair = 0; repair < kRepairs; ++repair) {
    Packing close = closer(problem, packing, pace);
    const double missing = problem.gap_mm - least_gap_mm(close, problem);
    if (missing <= kGapTolerance_mm) return close;
    margin += 1.5 * missing + 0.01;
    Finisher roomier(problem, grid, margin, pace);
    packing = finish(roomier);
  }
  throw Error(Fault::kInternal,
              fmt::format("The parts could not be kept {} mm apart", problem.gap_mm),
              "Set a smaller grid_mm or a larger gap_mm, and report this model.");
}

bool keeps_off_walls(const Packing& packing, const PackProblem& problem) {
  if (problem.plate.is_whole()) return true;
  return std::all_of(packing.parts.begin(), packing.parts.end(), [&](const PlacedPart& part) {
    return problem.plate.breach_mm(part_mesh(problem, part), part.pose) <= kWallTolerance_mm;
  });
}

// With parts in cavities and under overhangs too, where that is cheaper on the exact meshes.
Packing put_under(const PackProblem& problem, Packing settled, PartMaker& maker, Pace& pace) {
  Effort effort;
  std::optional<Packing> better = height_alone_counts(problem)
                                      ? searched_freely(problem, settled, pace, effort)
                                      : searched_by_cost(problem, settled, maker, pace);
  if (!better) return settled;
  for (PlacedPart& part : better->parts) keep_inside(part, problem);
  measure(problem, *better);
  const bool kept = problem.gap_mm - least_gap_mm(*better, problem) <= kGapTolerance_mm &&
                    keeps_off_walls(*better, problem);
  return kept && better->cost < settled.cost ? *better : settled;
}

[[noreturn]] void refuse(const PackItem& item, std::size_t number, const PackProblem& problem) {
  const Vec3 size = bounding_box(item.surface).sizes();
  const Vec3& build = problem.build_mm;
  throw Error(
      Fault::kBadInput,
      fmt::format("Part {} of model {} measures {:.1f} × {:.1f} × {:.1f} mm and fits the "
                  "build volume of {:.1f} × {:.1f} × {:.1f} mm{} in no rotation",
                  number, item.model + 1, size.x(), size.y(), size.z(), build.x(), build.y(),
                  build.z(), problem.plate.is_whole() ? "" : " with the walls of its plate"),
      "Scale the model down, let it be divided into more parts, or choose a larger printer.");
}

void make_items(const PackProblem& problem, PartMaker& maker) {
  parallel_tasks(problem.items.size(), [&](std::size_t i) {
    if (!maker.make({static_cast<int>(i)})) refuse(problem.items[i], i + 1, problem);
  });
}

// On the fewest trays, with no more parts than asked for, the cheapest; of about equal ones that of
// the fewest parts, if it is no dearer than the last, which is every part alone.
std::size_t best_of(const std::vector<Packing>& packings, std::size_t most_parts) {
  const auto rank = [&](std::size_t i) {
    const std::size_t parts = packings[i].parts.size();
    const std::size_t too_many = parts > most_parts ? parts - most_parts : 0;
    return std::tuple(packings[i].trays.size(), too_many, packings[i].cost);
  };
  std::size_t cheapest = 0;
  for (std::size_t i = 1; i < packings.size(); ++i)
    if (rank(i) < rank(cheapest)) cheapest = i;
  double limit = kAboutEqual * packings[cheapest].cost;
  if (packings.back().trays.size() == packings[cheapest].trays.size())
    limit = std::min(limit, packings.back().cost);
  std::size_t best = cheapest;
  for (std::size_t i = 0; i < packings.size(); ++i)
    if (packings[i].trays.size() == packings[cheapest].trays.size() && packings[i].cost <= limit &&
        packings[i].parts.size() < packings[best].parts.size())
      best = i;
  return best;
}

}  // namespace

struct TrialPacking::Bench {
  Bench(const PackProblem& problem, const Progress& progress)
      : trial(shortened(problem)),
        silent({}, progress.cancelled()),
        pace(silent, 0),
        searching(trial, search_grid(trial), pace) {
    make_items(trial, searching.maker);
  }

  static PackProblem shortened(PackProblem problem) {
    check_settings(problem);
    problem.rotation_step = std::max(problem.rotation_step, kTrialRotation);
    problem.tabu_patience = std::min(problem.tabu_patience, kTrialPatience);
    problem.tabu_restarts = 0;
    return problem;
  }

  PackProblem trial;
  Progress silent;
  Pace pace;
  Workshop searching;
};

TrialPacking::TrialPacking(const PackProblem& problem, const Progress& progress)
    : bench_(std::make_unique<Bench>(problem, progress)) {}

TrialPacking::~TrialPacking() = default;

double TrialPacking::greedy_cost() {
  return first_layout(bench_->trial, bench_->searching.layouter, bench_->searching.maker).cost;
}

double TrialPacking::searched_cost() {
  Bench& bench = *bench_;
  return search(bench.trial, bench.searching.layouter, bench.searching.maker, bench.pace)
      .front()
      .cost;
}

Packing pack(const PackProblem& problem, const Progress& progress) {
  check_settings(problem);
  Pace pace(progress, problem.budget_s);
  Workshop searching(problem, search_grid(problem), pace);
  make_items(problem, searching.maker);
  pace.set_share(!problem.anywhere              ? 1
                 : height_alone_counts(problem) ? kDroppingShareOfFree
                                                : kDroppingShare);
  const std::vector<Layout> layouts = search(problem, searching.layouter, searching.maker, pace);
  pace.set_share(kInTime);

  std::vector<std::function<Packing(Finisher&)>> ways;
  for (const Layout& layout : layouts)
    ways.emplace_back([&layout](Finisher& finisher) { return finisher.finished(layout); });
  ways.emplace_back([](Finisher& finisher) { return finisher.side_by_side(); });
  Finisher finisher(problem, searching.spec.grid, 0, pace);
  std::vector<Packing> packings(ways.size());
  std::atomic<std::size_t> ready = 0;
  parallel_tasks(ways.size(), [&](std::size_t i) {
    packings[i] = ways[i](finisher);
    pace.reached(0.8 + 0.15 * static_cast<double>(++ready) / static_cast<double>(ways.size()));
  });
  const std::size_t chosen =
      best_of(packings, problem.most_parts > 0 ? static_cast<std::size_t>(problem.most_parts)
                                               : problem.items.size());
  Packing best = with_gaps_kept(ways[chosen], searching.spec.grid, packings[chosen], problem, pace);
  if (problem.anywhere) best = put_under(problem, std::move(best), searching.maker, pace);
  progress.report("packing", 1);
  return best;
}

}  // namespace packmerger
