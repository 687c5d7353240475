#include "pack/exact/exact_disassembly.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <queue>
#include <set>

#include "base/parallel.h"
#include "pack/exact/exact_removal.h"

namespace packmerger {
namespace {

// Searches for a path, one after the other: what comes out easily is soon found, wide steps get
// through large cavities, and at last many places are looked at.
struct Flood {
  double step_mm;
  std::size_t most_places;
};
constexpr std::array<Flood, 3> kFloods{{{0.5, 300}, {2, 300}, {0.5, 1500}}};
constexpr double kLook_mm = 0.25;                 // between two looks along a step
constexpr double kTold = 3;                       // steps: of the room round a place
constexpr double kRoom_mm = 1.2 * kLeastRoom_mm;  // at the places that are looked at
constexpr std::size_t kPlacesOfLift = 40;  // between two looks whether it can be lifted from here

using Lattice = std::array<int, 3>;

Vec3 moved_mm(const Lattice& at, const Flood& flood) {
  return flood.step_mm * Vec3(at[0], at[1], at[2]);
}

class Dismantler {
 public:
  // All must outlive it.
  Dismantler(const StandingParts& parts, const Vec2& base_mm, const Plate& plate,
             const std::function<bool()>& is_over)
      : parts_(parts), base_mm_(base_mm), plate_(plate), is_over_(is_over) {
    there_.resize(static_cast<std::size_t>(parts.size()));
    std::iota(there_.begin(), there_.end(), 0);
    std::stable_sort(there_.begin(), there_.end(), [this](int a, int b) {
      return parts_.box(a).max().z() > parts_.box(b).max().z();
    });
    plan_.paths.resize(there_.size());
    blockers_.resize(there_.size());
    find_who_is_under_whom();
  }

  ExactDisassembly run() {
    while (!there_.empty() && !is_over() && (lift_one() || lead_one_out()))
      ;
    plan_.stuck = there_;
    std::sort(plan_.stuck.begin(), plan_.stuck.end());
    return std::move(plan_);
  }

 private:
  struct Place {
    Lattice at{};
    int parent = -1;
    double room_mm = 0;  // to the other parts, at least
  };

  // What was in a part's way in a search for its path.
  using Blockers = std::set<int>;

  bool is_over() const { return is_over_ && is_over_(); }

  void find_who_is_under_whom() {
    const std::size_t count = there_.size();
    under_.assign(count, std::vector<char>(count, 0));
    parallel_tasks(count, [&](std::size_t i) {
      for (std::size_t j = 0; j < count; ++j)
        if (i != j)
          under_[i][j] =
              parts_.is_under(static_cast<int>(i), Vec3::Zero(), static_cast<int>(j)) ? 1 : 0;
    });
  }

  void take_out(int part) {
    plan_.order.push_back(part);
    there_.erase(std::find(there_.begin(), there_.end(), part));
  }

  bool lift_one() {
    const auto lifted = std::find_if(there_.begin(), there_.end(), [this](int part) {
      return std::none_of(there_.begin(), there_.end(), [&](int other) {
        return under_[static_cast<std::size_t>(part)][static_cast<std::size_t>(other)] != 0;
      });
    });
    if (lifted == there_.end()) return false;
    take_out(*lifted);
    return true;
  }

  bool lead_one_out() {
    for (std::size_t k = 0; k < kFloods.size(); ++k)
      for (const int part : there_) {
        auto& blockers = blockers_[static_cast<std::size_t>(part)][k];
        if (are_there(blockers)) continue;
        blockers.emplace();
        auto path = path_of(part, kFloods[k], *blockers);
        if (!path) continue;
        plan_.paths[static_cast<std::size_t>(part)] = std::move(*path);
        take_out(part);
        return true;
      }
    return false;
  }

  // A search that failed fails again while everything that was in its way is there.
  bool are_there(const std::optional<Blockers>& blockers) const {
    return blockers && std::all_of(blockers->begin(), blockers->end(), [this](int other) {
             return std::find(there_.begin(), there_.end(), other) != there_.end();
           });
  }

  static bool is_in_the_way(int other, Blockers& blockers) {
    blockers.insert(other);
    return true;
  }

  bool comes_off(int part, const Vec3& moved, Blockers& blockers) const {
    return std::none_of(there_.begin(), there_.end(), [&](int other) {
      return other != part && parts_.is_under(part, moved, other) && is_in_the_way(other, blockers);
    });
  }

  // To the other parts; told up to `enough`, mm.
  double room_mm(int part, const Vec3& moved, double enough) const {
    const Box3 there = parts_.box(part).translated(moved);
    double room = enough;
    for (const int other : there_)
      if (other != part && there.exteriorDistance(parts_.box(other)) < room)
        room = parts_.distance_mm(part, moved, other, room);
    return room;
  }

  // Whether a step stays over the base and clear of the plate's walls.
  bool is_over_plate(int part, const Vec3& from, const Vec3& to) const {
    if (!is_over_base(parts_.box(part), to, base_mm_)) return false;
    Box3 swept = parts_.box(part).translated(from);
    swept.extend(parts_.box(part).translated(to));
    return plate_.surely_clear(swept) || all_looks(from, to, [&](const Vec3& moved) {
             return plate_.breach_mm(parts_.mesh(part), Pose(Eigen::Translation3d(moved))) <=
                    kWallTolerance_mm;
           });
  }

  bool is_free(int part, const Vec3& moved, Blockers& blockers) const {
    const Box3 there = parts_.box(part).translated(moved);
    return std::none_of(there_.begin(), there_.end(), [&](int other) {
      return other != part && there.exteriorDistance(parts_.box(other)) < kRoom_mm &&
             parts_.distance_mm(part, moved, other, kRoom_mm) < kRoom_mm &&
             is_in_the_way(other, blockers);
    });
  }

  bool is_free_between(int part, const Vec3& from, const Vec3& to, Blockers& blockers) const {
    return all_looks(from, to, [&](const Vec3& moved) { return is_free(part, moved, blockers); });
  }

  static bool all_looks(const Vec3& from, const Vec3& to,
                        const std::function<bool(const Vec3& moved)>& is_good) {
    const int looks = static_cast<int>(std::lround((to - from).norm() / kLook_mm));
    for (int look = 1; look <= looks; ++look)
      if (!is_good(from + (to - from) * (static_cast<double>(look) / looks))) return false;
    return true;
  }

  // Best first: the highest place, of several the one that was found first.
  std::optional<std::vector<Vec3>> path_of(int part, const Flood& flood, Blockers& blockers) {
    const double near_mm = flood.step_mm + kRoom_mm;
    std::vector<Place> places{{}};
    std::set<Lattice> seen{Lattice{}};
    using Open = std::pair<int, int>;  // height, and less the index of the place
    std::priority_queue<Open> open;
    open.push({0, 0});
    int highest = 0;
    for (std::size_t looked = 1; !open.empty() && looked <= flood.most_places && !is_over();
         ++looked) {
      parts_.progress().check();
      const int index = -open.top().second;
      open.pop();
      const Lattice at = places[static_cast<std::size_t>(index)].at;
      if (at[2] > highest || looked % kPlacesOfLift == 0) {
        highest = std::max(highest, at[2]);
        if (comes_off(part, moved_mm(at, flood), blockers))
          return swept(part, flood, places, index, blockers);
      }
      double room = places[static_cast<std::size_t>(index)].room_mm;
      if (room < near_mm) room = room_mm(part, moved_mm(at, flood), kTold * flood.step_mm);
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int sign : {1, -1}) {
          Lattice next = at;
          next[axis] += sign;
          if (!seen.insert(next).second) continue;
          const Vec3 end = moved_mm(next, flood);
          if (!is_over_plate(part, moved_mm(at, flood), end)) continue;
          if (room < near_mm && !is_free_between(part, moved_mm(at, flood), end, blockers))
            continue;
          open.push({next[2], -static_cast<int>(places.size())});
          places.push_back({next, index, room - flood.step_mm});
        }
    }
    return std::nullopt;
  }

  // The steps to a place, where nothing is met between the places that were looked at either.
  std::optional<std::vector<Vec3>> swept(int part, const Flood& flood,
                                         const std::vector<Place>& places, int end,
                                         Blockers& blockers) const {
    std::vector<Vec3> steps;
    for (int at = end; places[static_cast<std::size_t>(at)].parent >= 0;) {
      const Place& here = places[static_cast<std::size_t>(at)];
      const Vec3 step = moved_mm(here.at, flood) -
                        moved_mm(places[static_cast<std::size_t>(here.parent)].at, flood);
      if (!steps.empty() && steps.back().normalized().isApprox(step.normalized()))
        steps.back() += step;
      else
        steps.push_back(step);
      at = here.parent;
    }
    std::reverse(steps.begin(), steps.end());
    std::vector<int> others = there_;
    others.erase(std::find(others.begin(), others.end(), part));
    if (const auto other = parts_.met_on_path(part, others, steps)) {
      is_in_the_way(*other, blockers);
      return std::nullopt;
    }
    return steps;
  }

  const StandingParts& parts_;
  Vec2 base_mm_;
  const Plate& plate_;
  const std::function<bool()>& is_over_;
  // By part: what was in the way of the searches that failed.
  std::vector<std::array<std::optional<Blockers>, kFloods.size()>> blockers_;
  std::vector<std::vector<char>> under_;  // [i][j]: i cannot be lifted before j
  std::vector<int> there_;                // the highest first
  ExactDisassembly plan_;
};

}  // namespace

ExactDisassembly exact_disassembly(const StandingParts& parts, const Vec2& base_mm,
                                   const Plate& plate, const std::function<bool()>& is_over) {
  return Dismantler(parts, base_mm, plate, is_over).run();
}

ExactDisassembly renewed(const ExactDisassembly& known, const StandingParts& parts,
                         const Vec2& base_mm, const Plate& plate,
                         const std::function<bool()>& is_over) {
  const bool is_lifting = std::all_of(known.paths.begin(), known.paths.end(),
                                      [](const auto& path) { return path.empty(); });
  const bool holds = !known.order.empty() && (plate.is_whole() || is_lifting) &&
                     stay_over_base(parts, known.paths, base_mm) &&
                     !first_obstacle(parts, known.order, known.paths);
  return holds ? known : exact_disassembly(parts, base_mm, plate, is_over);
}

ExactDisassembly exact_disassembly(const std::vector<Mesh>& parts, const Vec2& base_mm,
                                   const Progress& progress, const Plate& plate) {
  return exact_disassembly(StandingParts(parts, progress), base_mm, plate, {});
}

}  // namespace packmerger
