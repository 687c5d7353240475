#include "shape/cut/cut_starts.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "shape/cut/cut_recipes.h"

namespace packmerger {
namespace {

constexpr int kTriesPerCut = 16;
constexpr double kOvercut = 1.5;

// Cuts the piece that needs most support until there are `count` pieces; each time the recipe that
// saves most per piece.
std::vector<CutState> cut_greedily(CutBench& bench, const MatterSamples& samples,
                                   const CutRules& rules, int count, Random& random,
                                   const Progress& progress) {
  std::vector<CutState> path{bench.whole()};
  while (path.back().count() < count) {
    progress.check();
    const CutState& state = path.back();
    std::vector<int> order;
    for (int i = 0; i < state.count(); ++i) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      const auto rank = [&](int i) {
        const CutPiece& piece = *state.pieces[i];
        return std::pair(piece.fits ? 1 : 0, -piece.standing.support_mm3);
      };
      return rank(a) < rank(b);
    });
    std::optional<CutState> best;
    double best_saving = 0;
    for (std::size_t i = 0; i < order.size() && !best; ++i) {
      const PieceShape& shape = state.pieces[order[i]]->shape;
      for (int n = 0; n < kTriesPerCut; ++n) {
        const CutRecipe recipe =
            random_recipe(samples, shape.samples, shape.planes, count - state.count(), random);
        auto next = bench.recut(state, {order[i]}, recipe, count);
        if (!next || next->count() == state.count()) continue;
        const double saving =
            (cost_of(state, rules) - cost_of(*next, rules)) / (next->count() - state.count());
        if (best && saving <= best_saving) continue;
        best = std::move(next);
        best_saving = saving;
      }
    }
    if (!best) break;
    path.push_back(std::move(*best));
  }
  return path;
}

// Merges the two neighbours whose union costs least, until `count` pieces are left or none may
// merge.
std::vector<CutState> merge_back(CutBench& bench, const MatterSamples& samples, CutState state,
                                 int count, const Progress& progress) {
  std::vector<CutState> path;
  while (state.count() > count) {
    progress.check();
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < samples.count(); ++i)
      for (const int j : samples.linked_to(i)) {
        const auto pair = std::pair(state.piece_of_sample[i], state.piece_of_sample[j]);
        if (pair.first < pair.second) pairs.push_back(pair);
      }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    std::optional<CutState> best;
    for (const auto& [a, b] : pairs) {
      auto next = bench.recut(state, {a, b}, {}, state.count());
      if (next && (!best || next->support_mm3() < best->support_mm3())) best = std::move(next);
    }
    if (!best) break;
    state = std::move(*best);
    path.push_back(state);
  }
  return path;
}

}  // namespace

std::vector<Start> cut_starts(const MatterSamples& samples, const CutRules& rules,
                              const FitTest& fit, std::uint64_t seed, const Progress& progress) {
  const int most = rules.most_parts;
  const CutState whole = CutBench(samples, rules, fit).whole();
  const RegionFrame frame = frame_of(samples, whole.pieces[0]->shape.samples);

  using Maker = std::function<std::vector<Start>(CutBench&)>;
  std::vector<Maker> makers;
  const auto named = [](const std::string& name, std::vector<CutState> states) {
    std::vector<Start> starts;
    for (CutState& state : states) starts.push_back({name, std::move(state)});
    return starts;
  };
  makers.emplace_back([&](CutBench& bench) {
    Random random(seed + 1);
    return named("cuts", cut_greedily(bench, samples, rules, most, random, progress));
  });
  makers.emplace_back([&](CutBench& bench) {
    Random random(seed + 2);
    const int many = static_cast<int>(kOvercut * most);
    const CutState cut = cut_greedily(bench, samples, rules, many, random, progress).back();
    std::vector<CutState> merged = merge_back(bench, samples, cut, most / 2, progress);
    if (cut.count() <= most) merged.push_back(cut);
    return named("overcut", std::move(merged));
  });
  const auto by_recipe = [&](const std::string& name, const CutRecipe& recipe) {
    makers.emplace_back([&, name, recipe](CutBench& bench) {
      progress.check();
      std::vector<Start> starts;
      if (auto state = bench.recut(whole, {0}, recipe, most))
        starts.push_back({name, std::move(*state)});
      return starts;
    });
  };
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 up = frame.axes.col(axis);
    for (const int count : {most, most * 3 / 4, most / 2})
      by_recipe("slabs", slabs(samples, whole.pieces[0]->shape.samples, up, count));
    for (const double width : {0.28, 0.36})
      for (const bool halve : {false, true}) {
        const int other = (axis + 1) % 3;
        by_recipe("rings", ring(frame.middle, up, frame.axes.col(other),
                                width * frame.half_mm[axis], width * frame.half_mm[other], halve));
      }
  }

  std::vector<std::vector<Start>> made(makers.size());
  parallel_tasks(makers.size(), [&](std::size_t i) {
    CutBench bench(samples, rules, fit);
    made[i] = makers[i](bench);
  });
  std::vector<Start> starts;
  for (std::vector<Start>& some : made)
    for (Start& one : some)
      if (one.state.count() > 1 && one.state.count() <= most) starts.push_back(std::move(one));
  return starts;
}

}  // namespace packmerger
