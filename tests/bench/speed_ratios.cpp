#include "bench/speed_ratios.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "bench/fast_packing.h"
#include "bench/kernels.h"
#include "bench/packing_table/summary.h"
#include "bench/reference_problem.h"
#include "bench/reference_search.h"
#include "bench/stopwatch.h"
#include "pack/search/search.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPackingGrid_mm = 2;
constexpr double kPackingStep_deg = 60;
constexpr double kSearchGrid_mm = 4;
constexpr double kSearchStep_deg = 90;
constexpr std::size_t kMostSearched = 12;  // parts: more take the reference hours
constexpr int kMostSeeds = 10;
constexpr int kRepetitions = 5;  // the median counts; the reference's search is run once

void require_same(const ReferencePacking& expected, const ReferencePacking& found) {
  const auto same = [](const ReferencePlacement& a, const ReferencePlacement& b) {
    return a.part == b.part && a.rotation == b.rotation && a.x == b.x && a.y == b.y && a.z == b.z &&
           a.cost == b.cost;
  };
  if (!std::equal(expected.placed.begin(), expected.placed.end(), found.placed.begin(),
                  found.placed.end(), same) ||
      expected.cost != found.cost)
    throw Error(Fault::kInternal, "The packer's placements are not the reference's",
                "Report this model.");
}

// The first items, and the edges and enclosures among them.
void keep_first(PackProblem& problem, std::size_t count) {
  if (problem.items.size() <= count) return;
  problem.items.resize(count);
  const int end = static_cast<int>(count);
  std::erase_if(problem.edges,
                [end](const SegmentEdge& edge) { return edge.a >= end || edge.b >= end; });
  std::erase_if(problem.enclosures, [end](const std::vector<int>& items) {
    return std::any_of(items.begin(), items.end(), [end](int item) { return item >= end; });
  });
}

// Seconds from the problem to a layout that costs no more than `cost` on the search's grid: the
// parts' ways up, all maps and the search, with another seed where it ends before.
double seconds_to_reach(PackProblem problem, double cost, double& reached) {
  const Stopwatch watch;
  std::atomic<bool> enough = false;
  const Progress progress({}, &enough);
  Pace pace(progress, 0);
  const TraySpec spec{
      problem.build_mm,
      {problem.search_grid_mm, height_unit_mm(problem.build_mm.z()), problem.gap_mm, false},
      &problem.cost};
  PartMaker maker(problem, spec.grid, [&pace] { pace.tick(); });
  const Layouter layouter(spec);
  double seconds = 0;
  try {
    parallel_for(problem.items.size(),
                 [&maker](std::size_t i) { maker.make({static_cast<int>(i)}); });
    for (int i = 0; i < kMostSeeds; ++i, ++problem.seed)
      search(problem, layouter, maker, pace, [&](double found) {
        if (enough || found > cost) return;
        seconds = watch.seconds();
        reached = found;
        enough = true;
      });
  } catch (const Error& error) {
    if (error.fault() != Fault::kInterrupted) throw;
  }
  if (!enough)
    throw Error(Fault::kInternal, "The packer's search did not reach the reference's cost",
                "Report this model.");
  return seconds;
}

}  // namespace

void measure_one_packing(PackProblem problem, Json& told) {
  problem.grid_mm = kPackingGrid_mm;
  problem.rotation_step = radians(kPackingStep_deg);
  ReferencePacker reference(problem, Ties::kLowestTop);
  const FastPacker fast(problem, reference.unit_mm());
  const DrawnParts drawn = draw_items(problem, reference);
  std::vector<std::vector<RotatedPart>> parts;
  std::size_t rotations = 0;
  for (const std::vector<ReferenceMaps>& maps : drawn.maps) {
    parts.push_back(fast.laid_out(maps));
    rotations += maps.size();
  }
  Order order(parts.size());
  std::iota(order.begin(), order.end(), 0);

  std::vector<double> reference_s;
  std::vector<double> fast_s;
  ReferencePacking expected;
  for (int i = 0; i < kRepetitions; ++i) {
    const Stopwatch watch;
    expected = reference.pack(drawn.maps, drawn.volumes_mm3, order);
    reference_s.push_back(watch.seconds());
    const Stopwatch fast_watch;
    const ReferencePacking found = fast.pack(parts, drawn.volumes_mm3, order);
    fast_s.push_back(fast_watch.seconds());
    require_same(expected, found);
  }
  told["one_packing_ratio"] = median(reference_s) / median(fast_s);
  told["one_packing"] = {
      {"parts", parts.size()},
      {"rotations", rotations},
      {"cost", expected.cost},
      {"reference_s", median(reference_s)},
      {"fast_s", median(fast_s)},
      {"reference_gcells_per_s", reference.cells() / kRepetitions / median(reference_s) / 1e9}};
}

void measure_search(PackProblem problem, Json& told) {
  keep_first(problem, kMostSearched);
  problem.grid_mm = kSearchGrid_mm;
  problem.search_grid_mm = kSearchGrid_mm;
  problem.rotation_step = radians(kSearchStep_deg);
  ReferencePacker packer(problem);
  const Stopwatch watch;
  const ReferenceAnswer reference = reference_search(problem, packer);
  const double reference_s = watch.seconds();
  told["search"] = {{"parts", problem.items.size()},
                    {"reference_cost", reference.cost},
                    {"reference_parts", reference.parts.size()},
                    {"reference_packings", reference.packings},
                    {"reference_s", reference_s}};
  const auto against = [&](const std::string& name) {
    std::vector<double> fast_s;
    double reached = 0;
    for (int i = 0; i < kRepetitions; ++i)
      fast_s.push_back(seconds_to_reach(problem, reference.cost, reached));
    told[name + "_ratio"] = reference_s / median(fast_s);
    told[name]["fast_cost"] = reached;
    told[name]["fast_s"] = median(fast_s);
  };
  // With room for the gap in its samples, which the reference's never leave: a harder aim.
  against("search_with_gap");
  problem.gap_mm = 0;  // both sample centres
  against("search");
}

void measure_kernel(Json& told) {
  const FallRates rates = measured_fall_rates();
  told["kernel_fraction"] = rates.ours / rates.bare;
  told["kernel"] = {{"gcells_per_s", rates.ours}, {"bare_gcells_per_s", rates.bare}};
}

}  // namespace packmerger::bench
