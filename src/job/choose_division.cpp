#include "job/choose_division.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "job/pack_models.h"
#include "pack/pack.h"
#include "shape/cut/cut_plans.h"

namespace packmerger {
namespace {

constexpr std::size_t kMostPlans = 4;  // that are cut and packed
constexpr std::size_t kFinalists = 2;  // of those, and the clusters, that are searched
constexpr double kAboutEqual = 0.02;   // of the least packed cost
constexpr double kLeastPrice = 0.005;  // of V_o: what a part more must save in support at least
constexpr double kMostPrice = 0.05;    // and at most

struct Candidate {
  std::shared_ptr<Divided> model;
  Warnings warnings;
  bool is_rough = false;                                  // clusters that are not smoothed yet
  std::unique_ptr<TrialPacking> trial;                    // none where some part fits no tray
  double cost = std::numeric_limits<double>::infinity();  // packed
};

// How much support costs as much as a part more, by the profile's objective. Where the objective
// does not know parts, or not support, a little.
double part_price_mm3(const Profile& profile, double volume_mm3) {
  const double side = std::cbrt(volume_mm3);
  const Cost cost = packing_problem({}, profile, 0, 0).cost;
  TrayMeasure tray{Vec3(3 * side, 3 * side, side), volume_mm3, volume_mm3, 8};
  const double before = cost.evaluate(tray);
  ++tray.parts;
  const double of_a_part = cost.evaluate(tray) - before;
  --tray.parts;
  tray.support_mm3 += volume_mm3;
  const double of_support = (cost.evaluate(tray) - before) / volume_mm3;
  const double least = kLeastPrice * volume_mm3, most = kMostPrice * volume_mm3;
  return of_support > 0 ? std::clamp(of_a_part / of_support, least, most) : least;
}

// A short packing of this model alone, the same on any machine: no clock ends it. Empty where some
// part fits no tray: the model may still fit divided another way, and where nothing fits the packer
// says so better.
std::unique_ptr<TrialPacking> trial_of(const std::shared_ptr<const Divided>& model,
                                       const Profile& profile, std::uint64_t seed,
                                       const Progress& progress) {
  PackProblem problem = packing_problem({model}, profile, seed, 0);
  problem.edges.clear();
  try {
    return std::make_unique<TrialPacking>(problem, progress);
  } catch (const Error& error) {
    if (error.fault() != Fault::kBadInput) throw;
    return nullptr;
  }
}

// What a plan makes of the whole model; without one, what the paper's clusters do. Packed greedily.
Candidate candidate_of(const Divided& whole, const CutPlan* plan, const Profile& profile,
                       std::uint64_t seed, const Progress& progress) {
  Candidate made;
  made.model = std::make_shared<Divided>(whole);
  if (plan == nullptr) {
    cut_into_clusters(*made.model, profile, seed, progress);
    made.is_rough = true;
  } else {
    const Segments cut = cut_as_planned(made.model->tets, *plan, progress);
    made.model->clusters = cut.count;
    made.model->segments = premerge(made.model->tets, cut, profile.shape, build_volume(profile),
                                    made.warnings, progress);
  }
  made.trial = trial_of(made.model, profile, seed, progress);
  if (made.trial) made.cost = made.trial->greedy_cost();
  return made;
}

// Divided and packed as it would be kept.
void search_further(Candidate& candidate, const Profile& profile, std::uint64_t seed,
                    const Progress& progress) {
  if (candidate.is_rough) {
    smooth_clusters(*candidate.model, profile, candidate.warnings, progress);
    candidate.is_rough = false;
    candidate.trial = trial_of(candidate.model, profile, seed, progress);
  }
  candidate.cost =
      candidate.trial ? candidate.trial->searched_cost() : std::numeric_limits<double>::infinity();
}

// The best by greedy layouts, searched.
std::vector<Candidate> finalists(const Divided& whole, const Profile& profile, std::uint64_t seed,
                                 const Progress& progress) {
  CutSearch search;
  search.support_angle = radians(profile.support_angle_deg);
  const double volume_mm3 = total_volume_mm3(whole.tets);
  search.part_price_mm3 = part_price_mm3(profile, volume_mm3);
  search.least_price_mm3 = kLeastPrice * volume_mm3;
  std::vector<CutPlan> plans =
      cut_plans(whole.tets, profile.shape, build_volume(profile), search, seed, progress);
  plans.resize(std::min(plans.size(), kMostPlans));
  std::vector<Candidate> candidates(1 + plans.size());
  const Progress silent({}, progress.cancelled());  // several report at once
  std::atomic<std::size_t> ready = 0;
  progress.report("choosing a division", 0);
  parallel_tasks(candidates.size(), [&](std::size_t i) {
    candidates[i] = candidate_of(whole, i == 0 ? nullptr : &plans[i - 1], profile, seed, silent);
    progress.report("choosing a division",
                    0.8 * static_cast<double>(++ready) / static_cast<double>(candidates.size()));
  });
  // The order by greedy layouts is near that by searched ones, at a third of the time.
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  candidates.resize(std::min(candidates.size(), kFinalists));
  parallel_tasks(candidates.size(),
                 [&](std::size_t i) { search_further(candidates[i], profile, seed, silent); });
  return candidates;
}

}  // namespace

Divided choose_division(const Mesh& surface, const Profile& profile, bool hollow_it,
                        std::uint64_t seed, Warnings& warnings, const Progress& progress) {
  if (profile.shape.segmentation == Segmentation::kPaper)
    return divide(surface, profile, hollow_it, seed, warnings, progress);
  const Divided whole = undivided(surface, profile, hollow_it, warnings, progress);
  std::vector<Candidate> candidates = finalists(whole, profile, seed, progress);
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : candidates) least = std::min(least, candidate.cost);
  const Candidate* best = &candidates.front();
  if (std::isfinite(least)) {
    const auto rank = [&](const Candidate& c) {
      return std::tuple(c.cost > (1 + kAboutEqual) * least, c.model->segments.count, c.cost);
    };
    best = &*std::min_element(
        candidates.begin(), candidates.end(),
        [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); });
  }
  warnings.insert(warnings.end(), best->warnings.begin(), best->warnings.end());
  return std::move(*best->model);
}

}  // namespace packmerger
