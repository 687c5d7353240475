#include "shape/cut/cut_plans.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/random.h"
#include "shape/cut/cut_recipes.h"
#include "shape/cut/cut_starts.h"
#include "shape/cut/cut_state.h"
#include "shape/divide/manifold_parts.h"

namespace packmerger {

struct CutHistory {
  CutTree tree;
  std::shared_ptr<const MatterSamples> samples;
  double least_volume_mm3 = 0;
};

namespace {

constexpr double kLeastPiece = 0.002;  // of V_o, where the settings allow any
constexpr double kSameSupport = 1e-3;  // relative: candidates nearer than that are the same one

// Pieces that share links with a piece.
std::vector<int> neighbours_of(const MatterSamples& samples, const CutState& state, int piece) {
  std::vector<char> is_beside(state.pieces.size(), 0);
  for (const int sample : state.pieces[piece]->shape.samples)
    for (const int other : samples.linked_to(sample)) is_beside[state.piece_of_sample[other]] = 1;
  std::vector<int> found;
  for (int i = 0; i < state.count(); ++i)
    if (i != piece && is_beside[i]) found.push_back(i);
  return found;
}

// A piece, more often one that needs much support, with up to two neighbours.
std::vector<int> random_group(const MatterSamples& samples, const CutState& state, Random& random) {
  double at = random.unit() * state.support_mm3();
  int piece = 0;
  while (piece + 1 < state.count() && (at -= state.pieces[piece]->standing.support_mm3) > 0)
    ++piece;
  std::vector<int> group{piece};
  const std::size_t more = random.below(3);
  while (group.size() <= more) {
    std::vector<int> beside = neighbours_of(samples, state, group[random.below(group.size())]);
    std::erase_if(beside,
                  [&](int i) { return std::find(group.begin(), group.end(), i) != group.end(); });
    if (beside.empty()) break;
    group.push_back(beside[random.below(beside.size())]);
  }
  return group;
}

struct Chain {
  Start start;
  int most_parts;
  double part_price_mm3;
};

// Large neighbourhood search from one start. A slightly worse division is accepted now and then,
// less and less.
Start improved(const MatterSamples& samples, CutRules rules, const FitTest& fit, const Chain& chain,
               int tries, Random random, const Progress& progress) {
  rules.part_price_mm3 = chain.part_price_mm3;
  CutBench bench(samples, rules, fit);
  CutState current = chain.start.state;
  CutState best = current;
  for (int i = 0; i < tries; ++i) {
    progress.check();
    const std::vector<int> group = random_group(samples, current, random);
    CutRecipe recipe;
    if (group.size() < 2 || random.below(8) > 0) {
      std::vector<int> region;
      std::vector<Plane> planes;
      for (const int piece : group) {
        const PieceShape& shape = current.pieces[piece]->shape;
        region.insert(region.end(), shape.samples.begin(), shape.samples.end());
        planes.insert(planes.end(), shape.planes.begin(), shape.planes.end());
      }
      recipe = random_recipe(
          samples, region, planes,
          chain.most_parts - current.count() + static_cast<int>(group.size()) - 1, random);
    }
    std::optional<CutState> next = bench.recut(current, group, recipe, chain.most_parts);
    if (!next) continue;
    const double heat = 0.01 * (1 - static_cast<double>(i) / tries);
    if (cost_of(*next, rules) > (1 + heat * random.unit()) * cost_of(current, rules)) continue;
    current = std::move(*next);
    if (cost_of(current, rules) < cost_of(best, rules)) best = current;
  }
  return {chain.start.construction, std::move(best)};
}

// The cheapest start with at most so many parts that is not taken yet.
std::optional<std::size_t> cheapest(const std::vector<Start>& starts, const CutRules& rules,
                                    int most_parts, const std::vector<std::string>& taken) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (starts[i].state.count() > most_parts) continue;
    if (std::find(taken.begin(), taken.end(), starts[i].construction) != taken.end()) continue;
    if (!best || cost_of(starts[i].state, rules) < cost_of(starts[*best].state, rules)) best = i;
  }
  return best;
}

// What is worth improving: for the whole number of parts the best of every construction, for fewer
// the best.
std::vector<Chain> chains_from(const std::vector<Start>& starts, const CutRules& rules) {
  std::vector<Chain> chains;
  std::vector<std::string> taken;
  while (const auto index = cheapest(starts, rules, rules.most_parts, taken)) {
    taken.push_back(starts[*index].construction);
    chains.push_back({starts[*index], rules.most_parts, rules.part_price_mm3});
  }
  for (const double share : {0.8, 0.6}) {
    const int fewer = static_cast<int>(share * rules.most_parts);
    if (const auto index = cheapest(starts, rules, fewer, {}))
      chains.push_back({starts[*index], fewer, rules.part_price_mm3});
  }
  return chains;
}

}  // namespace

std::vector<CutPlan> cut_plans(const TetMesh& mesh, const ShapeSettings& settings,
                               const BuildVolume& build, const CutSearch& search,
                               std::uint64_t seed, const Progress& progress) {
  progress.report("planning cuts", 0);
  const auto samples = std::make_shared<const MatterSamples>(sample_matter(mesh, search.samples));
  const FitTest fit(build);
  CutRules rules;
  rules.support_angle = search.support_angle;
  rules.least_volume_mm3 =
      std::max(kLeastPiece, settings.min_volume_fraction) * samples->volume_mm3;
  rules.least_glue_mm2 = settings.min_glue_area_mm2;
  rules.part_price_mm3 = search.part_price_mm3;
  rules.most_parts = settings.parts;

  const std::vector<Start> starts = cut_starts(*samples, rules, fit, seed, progress);
  progress.report("planning cuts", 0.4);
  std::vector<Chain> chains = chains_from(starts, rules);
  CutRules many = rules;
  many.part_price_mm3 = search.least_price_mm3;
  const auto of_many = cheapest(starts, many, rules.most_parts, {});
  const bool seeks_many = of_many && search.least_price_mm3 < search.part_price_mm3;
  if (seeks_many) chains.push_back({starts[*of_many], rules.most_parts, search.least_price_mm3});
  std::vector<Start> found(chains.size());
  parallel_tasks(chains.size(), [&](std::size_t i) {
    const int tries = search.effort / static_cast<int>(chains.size());
    found[i] =
        improved(*samples, rules, fit, chains[i], tries, Random(seed + 1000 * (i + 1)), progress);
  });

  const auto ranked_end = found.end() - (seeks_many ? 1 : 0);
  std::stable_sort(found.begin(), ranked_end, [&](const Start& a, const Start& b) {
    return cost_of(a.state, rules) < cost_of(b.state, rules);
  });
  // The division of many parts is told second, whatever it costs here.
  if (seeks_many && found.size() > 2) std::rotate(found.begin() + 1, ranked_end, found.end());
  std::vector<CutPlan> plans;
  for (Start& one : found) {
    const double support = one.state.support_mm3();
    const bool known = std::any_of(plans.begin(), plans.end(), [&](const CutPlan& plan) {
      return plan.parts == one.state.count() &&
             std::abs(plan.support_mm3 - support) <= kSameSupport * support;
    });
    if (known || one.state.count() < 2 || !one.state.is_usable()) continue;
    plans.push_back({one.construction, one.state.count(), support,
                     std::make_shared<const CutHistory>(
                         CutHistory{std::move(one.state.tree), samples, rules.least_volume_mm3})});
  }
  progress.report("planning cuts", 1);
  return plans;
}

Segments cut_as_planned(TetMesh& mesh, const CutPlan& plan, const Progress& progress) {
  progress.report("cutting", 0);
  const CutHistory& history = *plan.history;
  // Half of what a part must hold: the exact cut of the smallest may come out a little smaller.
  Segments segments =
      cut_apart(mesh, history.tree, *history.samples, history.least_volume_mm3 / 2, progress);
  make_manifold(mesh, segments, progress);
  progress.report("cutting", 1);
  return segments;
}

}  // namespace packmerger
