#include "pack/rearrange.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "base/parallel.h"
#include "base/random.h"
#include "pack/removal_plan.h"
#include "pack/solid_place.h"
#include "pack/standing.h"

namespace packmerger {
namespace {

constexpr std::size_t kRotationsTried = 24;
constexpr std::size_t kBetterWays = 8;  // by what the part costs alone: tried half of the time
constexpr std::size_t kMostTakenOut = 3;
constexpr double kSampling = 0.005;       // of a cost: what two grids may differ in support
constexpr std::size_t kCoveredTried = 4;  // places below something, for each part put back

struct Arranged {
  std::vector<Standing> parts;
  double cost = 0;
  double unrest = 0;  // of equal costs the lesser is better: how far up matter lies
};

// One tray.
class Rearranger {
 public:
  Rearranger(const PackProblem& problem, const std::vector<const Part*>& parts, SolidMaker& solids,
             const SolidGrid& coarse, const SolidGrid& fine, Pace& pace)
      : problem_(problem),
        parts_(parts),
        solids_(solids),
        coarse_(coarse),
        fine_(fine),
        rotations_(rotation_set(problem.rotation_step)),
        pace_(pace) {}

  Arranged run(std::vector<Standing> standing, std::uint64_t seed, double until) {
    Random random(seed);
    Arranged current = rated(std::move(standing));
    int rounds_without_better = 0;
    while (rounds_without_better < patience() && pace_.passed() < until) {
      pace_.tick();
      solids_.forget_some();
      const auto tries = static_cast<std::size_t>(std::max(1, problem_.tabu_samples));
      std::vector<std::uint64_t> seeds(tries);
      for (std::uint64_t& one : seeds) one = random.bits();
      std::vector<std::optional<Arranged>> found(tries);
      parallel_for(tries, [&](std::size_t i) { found[i] = attempt(current, Random(seeds[i])); });
      const auto better = [](const Arranged& a, const Arranged& b) {
        return std::tie(a.cost, a.unrest) < std::tie(b.cost, b.unrest);
      };
      const Arranged* best = nullptr;
      for (const auto& one : found)
        if (one && (best == nullptr || better(*one, *best))) best = &*one;
      ++rounds_without_better;
      if (getenv("DBG")) {
        static int n = 0;
        int ok = 0;
        for (auto& o : found) ok += o.has_value();
        fprintf(stderr, "%d t=%.3f ok=%d cost=%.3f unrest=%.0f best=%.3f %.0f\n", n++,
                pace_.passed(), ok, current.cost, current.unrest, best ? best->cost : -1,
                best ? best->unrest : -1);
      }
      if (best == nullptr || !better(*best, current)) continue;
      if (best->cost < current.cost) rounds_without_better = 0;
      current = *best;
    }
    return current;
  }

 private:
  int patience() const {
    return problem_.budget_s > 0 ? std::numeric_limits<int>::max() : problem_.tabu_patience;
  }

  double volume(int part) const { return parts_[static_cast<std::size_t>(part)]->volume_mm3; }

  // Drawings are kept alive by the caller's list.
  using Drawings = std::vector<std::shared_ptr<const SolidPart>>;

  std::vector<SolidPlace> fine_places(const std::vector<Standing>& parts, Drawings& drawings) {
    std::vector<SolidPlace> places;
    for (const Standing& one : parts) {
      drawings.push_back(solids_.fine(one.part, one.attitude));
      places.push_back({drawings.back().get(), one.x, one.y, one.z});
    }
    return places;
  }

  std::vector<SolidPlace> coarse_places(const std::vector<Standing>& parts, Drawings& drawings) {
    std::vector<SolidPlace> places;
    for (const Standing& one : parts) {
      drawings.push_back(coarse_of(one));
      places.push_back(
          {drawings.back().get(), one.x / solids_.ratio(), one.y / solids_.ratio(), one.z});
    }
    return places;
  }

  std::shared_ptr<const SolidPart> coarse_of(const Standing& one) {
    return solids_.coarse(one.part, one.attitude, one.x % solids_.ratio(), one.y % solids_.ratio());
  }

  TrayMeasure measure(const SolidTray& tray, const std::vector<Standing>& parts) const {
    TrayMeasure measure;
    if (parts.empty()) return measure;
    const Vec3 size = tray.contents().sizes();
    measure.size_mm = Vec3(size.x(), size.y(), tray.contents().max().z());
    measure.support_mm3 = tray.support_mm3();
    for (const Standing& one : parts) measure.material_mm3 += volume(one.part);
    measure.parts = static_cast<int>(parts.size());
    return measure;
  }

  Arranged rated(std::vector<Standing> parts) {
    Arranged arranged;
    Drawings drawings;
    const SolidTray tray(coarse_, coarse_places(parts, drawings));
    arranged.cost = problem_.cost.evaluate(measure(tray, parts));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double top = (parts[i].z + drawings[i]->rise) * coarse_.unit_mm;
      arranged.unrest += volume(parts[i].part) * top * top;
    }
    arranged.parts = std::move(parts);
    return arranged;
  }

  // Takes some parts out and puts them back one after the other.
  std::optional<Arranged> attempt(const Arranged& from, Random random) {
    std::vector<Standing> rest = from.parts;
    const std::vector<Standing> taken = taken_out(rest, random);
    bool same = true;
    for (const Standing& part : taken) {
      pace_.tick();
      const std::optional<Standing> put = put_back(from, rest, part, random);
      if (!put) return std::nullopt;
      same = same && put->attitude == part.attitude && put->x == part.x && put->y == part.y &&
             put->z == part.z;
      rest.push_back(*put);
    }
    if (same) return std::nullopt;
    return rated(std::move(rest));
  }

  // The highest part half of the time, and others at random.
  std::vector<Standing> taken_out(std::vector<Standing>& rest, Random& random) {
    std::vector<Standing> taken;
    const std::size_t count = std::min(rest.size(), 1 + random.below(kMostTakenOut));
    while (taken.size() < count) {
      std::size_t chosen = random.below(rest.size());
      if (taken.empty() && random.below(2) == 0) chosen = highest(rest);
      taken.push_back(rest[chosen]);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
    random.shuffle(taken);
    return taken;
  }

  std::size_t highest(const std::vector<Standing>& parts) {
    std::size_t found = 0;
    int top = -1;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const int here = parts[i].z + coarse_of(parts[i])->rise;
      if (here > top) {
        top = here;
        found = i;
      }
    }
    return found;
  }

  std::vector<std::shared_ptr<const Attitude>> attitudes(const Standing& part, Random& random) {
    std::vector<std::shared_ptr<const Attitude>> chosen{part.attitude};
    const std::vector<WayUp>& ways = parts_[static_cast<std::size_t>(part.part)]->ways;
    for (std::size_t i = 1; i < kRotationsTried; ++i) {
      const std::size_t among =
          random.below(2) == 0 ? ways.size() : std::min(ways.size(), kBetterWays);
      const WayUp& way = ways[random.below(among)];
      const double turn = way.turn + rotations_.turns[random.below(rotations_.turns.size())];
      auto attitude = solids_.attitude(part.part, turn_about_z(turn) * way.base);
      if (std::find(chosen.begin(), chosen.end(), attitude) == chosen.end())
        chosen.push_back(std::move(attitude));
    }
    return chosen;
  }

  std::optional<Standing> put_back(const Arranged& from, const std::vector<Standing>& rest,
                                   const Standing& part, Random& random) {
    const std::vector<std::shared_ptr<const Attitude>> tried = attitudes(part, random);
    Drawings drawings;
    const SolidTray coarse(coarse_, coarse_places(rest, drawings));
    std::vector<const SolidPart*> rotations;
    for (const auto& attitude : tried) {
      drawings.push_back(solids_.coarse(part.part, attitude, 0, 0));
      rotations.push_back(drawings.back().get());
    }
    SolidRules rules;
    rules.give_up_above = from.cost;
    rules.most = kCoveredTried;
    const TrayMeasure before = measure(coarse, rest);
    const std::vector<SolidSpot> spots =
        solid_spots(coarse, before, rotations, volume(part.part), problem_.cost, rules);
    if (spots.empty()) return std::nullopt;
    const std::vector<SolidPlace> places = fine_places(rest, drawings);
    for (const SolidSpot& spot : spots) {
      const auto& attitude = tried[static_cast<std::size_t>(spot.rotation)];
      const auto put = settled(from, before, part.part, attitude, spot, places);
      if (put) return put;
    }
    return std::nullopt;
  }

  // The best place on the fine grid near one that was found on the coarse grid.
  std::optional<Standing> settled(const Arranged& from, const TrayMeasure& before, int part,
                                  const std::shared_ptr<const Attitude>& attitude,
                                  const SolidSpot& spot, const std::vector<SolidPlace>& rest) {
    const int ratio = solids_.ratio();
    const std::shared_ptr<const SolidPart> drawing = solids_.fine(part, attitude);
    SolidRules rules;
    rules.x = {(spot.x - 1) * ratio, (spot.x + 1) * ratio};
    rules.y = {(spot.y - 1) * ratio, (spot.y + 1) * ratio};
    rules.give_up_above = from.cost + kSampling * std::abs(from.cost);
    const auto window = [&](const Range& positions, int axis) {
      const int stands_out = fine_.growth() + 1;
      return Range{
          positions.first - stands_out,
          positions.last + stands_out + static_cast<int>(drawing->box.max()[axis] / fine_.cell_mm)};
    };
    const SolidTray fine(fine_, rest, {window(rules.x, 0), window(rules.y, 1)});
    const std::array<const SolidPart*, 1> one{drawing.get()};
    for (const SolidSpot& found :
         solid_spots(fine, before, one, volume(part), problem_.cost, rules)) {
      if (!found.open) {
        std::vector<SolidPlace> all = rest;
        all.push_back({drawing.get(), found.x, found.y, found.z});
        if (!removal_plan(fine_, all)) continue;
      }
      return Standing{part, attitude, found.x, found.y, found.z};
    }
    return std::nullopt;
  }

  const PackProblem& problem_;
  const std::vector<const Part*>& parts_;
  SolidMaker& solids_;
  const SolidGrid& coarse_;
  const SolidGrid& fine_;
  RotationSet rotations_;
  Pace& pace_;
};

SolidGrid solid_grid(const PackProblem& problem, double cell_mm, bool bounds) {
  return {problem.build_mm,      cell_mm, height_unit_mm(problem.build_mm.z()), problem.gap_mm,
          problem.support_angle, bounds};
}

}  // namespace

Packing rearranged(const PackProblem& problem, Packing packing, double finest_mm, PartMaker& maker,
                   Pace& pace, double until) {
  const int ratio = std::max(1, static_cast<int>(std::lround(problem.grid_mm / finest_mm)));
  const SolidGrid coarse = solid_grid(problem, finest_mm * ratio, false);
  const SolidGrid fine = solid_grid(problem, finest_mm, true);
  std::vector<const Part*> parts;
  std::vector<std::vector<int>> items;
  for (const PlacedPart& placed : packing.parts) {
    items.push_back(placed.items);
    parts.push_back(maker.make(placed.items));
  }
  SolidMaker solids(problem, items, coarse, fine);
  Rearranger rearranger(problem, parts, solids, coarse, fine, pace);
  Random random(problem.seed);
  packing.removal_order.clear();
  packing.removal_paths.assign(packing.parts.size(), {});
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    std::vector<Standing> standing;
    for (std::size_t i = 0; i < packing.parts.size(); ++i)
      if (packing.parts[i].tray == tray)
        standing.push_back(solids.standing(static_cast<int>(i), packing.parts[i].pose));
    if (standing.size() > 1)
      standing = rearranger.run(std::move(standing), random.bits(), until).parts;
    std::vector<std::shared_ptr<const SolidPart>> drawings;
    std::vector<SolidPlace> places;
    for (const Standing& one : standing) {
      drawings.push_back(solids.fine(one.part, one.attitude));
      places.push_back({drawings.back().get(), one.x, one.y, one.z});
      packing.parts[static_cast<std::size_t>(one.part)].pose = solids.pose(one);
    }
    const std::optional<RemovalPlan> plan = removal_plan(fine, places);
    if (!plan) throw Error(Fault::kInternal, "A tray cannot be taken apart", "Report this model.");
    for (const int index : plan->order) {
      const auto part = static_cast<std::size_t>(standing[static_cast<std::size_t>(index)].part);
      packing.removal_order.push_back(static_cast<int>(part));
      packing.removal_paths[part] = plan->paths[static_cast<std::size_t>(index)];
    }
  }
  return packing;
}

}  // namespace packmerger
