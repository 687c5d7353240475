#include "pack/anywhere/rearrange.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "base/parallel.h"
#include "base/random.h"
#include "pack/anywhere/disassembly_order.h"
#include "pack/anywhere/put_back.h"
#include "pack/anywhere/standing.h"

namespace packmerger {
namespace {

constexpr std::size_t kRotationsTried = 24;
constexpr std::size_t kBetterWays = 8;  // by what the part costs alone: tried half of the time
constexpr std::size_t kMostTakenOut = 3;
constexpr std::size_t kShakeOneIn = 8;  // tries

bool better(const Arranged& a, const Arranged& b) {
  return std::tie(a.cost, a.unrest) < std::tie(b.cost, b.unrest);
}

bool same_place(const StandingPart& a, const StandingPart& b) {
  return a.attitude == b.attitude && a.x == b.x && a.y == b.y && a.z == b.z;
}

// One tray.
class Rearranger {
 public:
  Rearranger(const PackProblem& problem, const std::vector<const Part*>& parts, SolidMaker& solids,
             PutBack& put_back, Pace& pace)
      : problem_(problem),
        parts_(parts),
        solids_(solids),
        put_back_(put_back),
        rotations_(rotation_set(problem.rotation_step)),
        pace_(pace) {}

  std::vector<StandingPart> run(std::vector<StandingPart> standing, std::uint64_t seed) {
    Random random(seed);
    Arranged current = put_back_.rated(std::move(standing));
    int rounds_without_better = 0;
    while (pace_.passed() < 1 &&
           (problem_.budget_s > 0 || rounds_without_better < problem_.tabu_patience)) {
      pace_.tick();
      solids_.forget_some();
      std::vector<std::optional<Arranged>> found = round(current, random);
      std::optional<Arranged>* best = nullptr;
      for (auto& one : found)
        if (one && (best == nullptr || better(*one, **best))) best = &one;
      ++rounds_without_better;
      if (best == nullptr || !better(**best, current)) continue;
      if ((*best)->cost < current.cost) rounds_without_better = 0;
      current = std::move(**best);
    }
    return current.parts;
  }

 private:
  std::vector<std::optional<Arranged>> round(const Arranged& current, Random& random) {
    const auto tries = static_cast<std::size_t>(std::max(1, problem_.tabu_samples));
    std::vector<std::uint64_t> seeds(tries);
    for (std::uint64_t& one : seeds) one = random.bits();
    std::vector<std::optional<Arranged>> found(tries);
    parallel_tasks(tries, [&](std::size_t i) {
      Random own(seeds[i]);
      found[i] = own.below(kShakeOneIn) == 0 ? shaken(current) : moved(current, own);
    });
    return found;
  }

  // Takes some parts out and puts them back one after the other.
  std::optional<Arranged> moved(const Arranged& from, Random& random) {
    std::vector<StandingPart> rest = from.parts;
    const std::vector<StandingPart> taken = taken_out(rest, random);
    bool same = true;
    for (const StandingPart& part : taken) {
      pace_.tick();
      const auto put = put_back_.anywhere(rest, part.part, attitudes(part, random), from.cost);
      if (!put) return std::nullopt;
      same = same && same_place(*put, part);
      rest.push_back(*put);
    }
    if (same) return std::nullopt;
    return put_back_.rated(std::move(rest));
  }

  // Every part looks for a better place close to its own, from the lowest up.
  std::optional<Arranged> shaken(const Arranged& from) {
    std::vector<StandingPart> parts = from.parts;
    std::stable_sort(parts.begin(), parts.end(),
                     [](const StandingPart& a, const StandingPart& b) { return a.z < b.z; });
    bool same = true;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      pace_.tick();
      const StandingPart part = parts.front();
      parts.erase(parts.begin());
      const StandingPart put = put_back_.nearby(parts, part, from.cost).value_or(part);
      same = same && same_place(put, part);
      parts.push_back(put);
    }
    if (same) return std::nullopt;
    return put_back_.rated(std::move(parts));
  }

  // The highest part half of the time, and others at random.
  std::vector<StandingPart> taken_out(std::vector<StandingPart>& rest, Random& random) {
    std::vector<StandingPart> taken;
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

  std::size_t highest(const std::vector<StandingPart>& parts) {
    const auto found = std::max_element(parts.begin(), parts.end(),
                                        [&](const StandingPart& a, const StandingPart& b) {
                                          return put_back_.top(a) < put_back_.top(b);
                                        });
    return static_cast<std::size_t>(found - parts.begin());
  }

  std::vector<std::shared_ptr<const Attitude>> attitudes(const StandingPart& part, Random& random) {
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

  const PackProblem& problem_;
  const std::vector<const Part*>& parts_;
  SolidMaker& solids_;
  PutBack& put_back_;
  RotationSet rotations_;
  Pace& pace_;
};

SolidGrid solid_grid(const PackProblem& problem, double cell_mm, bool bounds) {
  return {problem.build_mm,
          cell_mm,
          height_unit_mm(problem.build_mm.z()),
          problem.gap_mm,
          problem.support_angle,
          bounds,
          PlateMask(problem.plate, problem.build_mm, cell_mm, bounds)};
}

}  // namespace

std::optional<Packing> rearranged(const PackProblem& problem, Packing packing, double finest_mm,
                                  PartMaker& maker, Pace& pace) {
  const int ratio = std::max(
      1,
      static_cast<int>(std::lround(std::max(problem.grid_mm, problem.search_grid_mm) / finest_mm)));
  const SolidGrid coarse = solid_grid(problem, finest_mm * ratio, false);
  const SolidGrid fine = solid_grid(problem, finest_mm, true);
  std::vector<const Part*> parts;
  std::vector<double> volumes;
  std::vector<std::vector<int>> items;
  for (const PlacedPart& placed : packing.parts) {
    items.push_back(placed.items);
    parts.push_back(maker.make(placed.items));
    volumes.push_back(parts.back()->volume_mm3);
  }
  SolidMaker solids(problem, items, coarse, fine);
  PutBack put_back(problem, volumes, solids, coarse, fine);
  Rearranger rearranger(problem, parts, solids, put_back, pace);
  Random random(problem.seed);
  packing.removal_order.clear();
  packing.removal_paths.assign(packing.parts.size(), {});
  for (int tray = 0; tray < static_cast<int>(packing.trays.size()); ++tray) {
    std::vector<StandingPart> standing;
    for (std::size_t i = 0; i < packing.parts.size(); ++i)
      if (packing.parts[i].tray == tray)
        standing.push_back(solids.standing(static_cast<int>(i), packing.parts[i].pose));
    if (standing.size() > 1) standing = rearranger.run(std::move(standing), random.bits());
    std::vector<std::shared_ptr<const SolidPart>> drawings;
    std::vector<SolidPlace> places;
    for (const StandingPart& one : standing) {
      drawings.push_back(solids.fine(one.part, one.attitude));
      places.push_back({drawings.back().get(), one.x, one.y, one.z});
      packing.parts[static_cast<std::size_t>(one.part)].pose = solids.pose(one);
    }
    const std::optional<DisassemblyOrder> plan = disassembly_order(fine, places);
    if (!plan) return std::nullopt;
    for (const int index : plan->order) {
      const auto part = static_cast<std::size_t>(standing[static_cast<std::size_t>(index)].part);
      packing.removal_order.push_back(static_cast<int>(part));
      packing.removal_paths[part] = plan->paths[static_cast<std::size_t>(index)];
    }
  }
  return packing;
}

}  // namespace packmerger
