#include "bench/packing_table/paper_packer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "base/error.h"
#include "bench/packing_table/tray_check.h"
#include "bench/reference_problem.h"
#include "bench/reference_search.h"
#include "bench/stopwatch.h"
#include "pack/exact/exact_gap.h"

namespace packmerger::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastSearch_s = 0.1;
constexpr double kFirstRoom_mm = 0.05;
constexpr double kMoreRoom_mm = 0.05;  // than what is missing
constexpr double kUnknown_mm = 0.25;   // where parts cut into one another: how far is not known
constexpr int kMostRooms = 40;

double apart_mm(const PackProblem& problem, const Packing& packing) {
  double least = kInfinity;
  for (const std::vector<Mesh>& tray : standing_parts(problem, packing))
    least = std::min(least, least_gap_mm(tray, problem.gap_mm + kMoreRoom_mm));
  return least;
}

// The paper's packer with some room more than the gap, and what it draws with that.
struct Roomy {
  Roomy(const PackProblem& asked, double room_mm) : problem(asked) {
    problem.gap_mm += room_mm;
    packer = std::make_unique<ReferencePacker>(problem);
    drawn = draw_items(problem, *packer);
  }

  PackProblem problem;
  std::unique_ptr<ReferencePacker> packer;
  DrawnParts drawn;
};

}  // namespace

SampledAnswer paper_sampled(const PackProblem& problem, double limit_s, std::uint64_t seed,
                            Ties ties) {
  const Stopwatch watch;
  ReferencePacker packer(problem, ties);
  const DrawnParts parts = draw_items(problem, packer);
  Random random(seed);
  SampledAnswer best;
  best.cost = kInfinity;
  do {
    const OrderSearch one = search_order(parts.maps, parts.volumes_mm3, problem, packer, random,
                                         std::max(kLeastSearch_s, limit_s - watch.seconds()));
    best.cost = std::min(best.cost, one.cost);
    best.packings += one.packings;
  } while (watch.seconds() < limit_s);
  return best;
}

ApartAnswer paper_apart(const PackProblem& problem, double limit_s, std::uint64_t seed) {
  const Stopwatch watch;
  Random random(seed);
  ApartAnswer best;
  double least = kInfinity;
  double room_mm = kFirstRoom_mm;
  auto roomy = std::make_unique<Roomy>(problem, room_mm);
  int rooms = 0;
  do {
    const OrderSearch one =
        search_order(roomy->drawn.maps, roomy->drawn.volumes_mm3, roomy->problem, *roomy->packer,
                     random, std::max(kLeastSearch_s, limit_s - watch.seconds()));
    best.packings += one.packings;
    while (rooms < kMostRooms) {
      const ReferencePacking found =
          roomy->packer->pack(roomy->drawn.maps, roomy->drawn.volumes_mm3, one.order);
      if (!(found.cost < least)) break;
      const Packing packing =
          as_packing(found, roomy->drawn.maps, problem, roomy->packer->unit_mm());
      const double apart = apart_mm(problem, packing);
      if (apart > 0 && apart >= problem.gap_mm) {
        best.packing = packing;
        least = found.cost;
        break;
      }
      room_mm += kMoreRoom_mm + (apart > 0 ? problem.gap_mm - apart : kUnknown_mm);
      roomy = std::make_unique<Roomy>(problem, room_mm);
      ++rooms;
    }
  } while (watch.seconds() < limit_s);
  if (best.packing.parts.empty())
    throw Error(Fault::kBadInput, "The paper's packer found no layout whose parts are apart",
                "Give it more time.");
  best.room_mm = room_mm;
  return best;
}

Packing as_packing(const ReferencePacking& reference,
                   const std::vector<std::vector<ReferenceMaps>>& maps, const PackProblem& problem,
                   double unit_mm) {
  Packing packing;
  for (const ReferencePlacement& place : reference.placed) {
    const ReferenceMaps& drawn =
        maps[static_cast<std::size_t>(place.part)][static_cast<std::size_t>(place.rotation)];
    PlacedPart part;
    part.items = {place.part};
    part.pose.linear() = drawn.rotation;
    const Mesh turned =
        transformed(problem.items[static_cast<std::size_t>(place.part)].surface, part.pose);
    part.pose.translation() =
        Vec3(place.x * problem.grid_mm, place.y * problem.grid_mm, place.z * unit_mm) -
        bounding_box(turned).min();
    packing.parts.push_back(part);
  }
  packing.removal_order.resize(packing.parts.size());
  std::iota(packing.removal_order.rbegin(), packing.removal_order.rend(), 0);
  packing.removal_paths.resize(packing.parts.size());
  return packing;
}

}  // namespace packmerger::bench
