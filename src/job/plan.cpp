#include "job/plan.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "base/parallel.h"
#include "job/comparison_key.h"
#include "job/plan_steps.h"
#include "job/powder.h"
#include "job/timings.h"
#include "printers/estimate/estimate.h"
#include "printers/slice/slice.h"

namespace packmerger {
namespace {

std::optional<Estimate> estimate_of(const std::optional<Arrangement>& way, const Profile& profile,
                                    const Progress& progress) {
  if (!way) return std::nullopt;
  const std::vector<Tray> trays = trays_of(*way);
  return profile.is_sliced() ? estimate_by_slicer(profile, trays, assembly_of(*way), progress)
                             : estimate(profile, trays, assembly_of(*way), progress);
}

// A way that cannot be made is no end of the comparison where others can. What is said of a bug, of
// the settings or of a missing program holds for all of them, and is thrown.
template <typename Make>
std::optional<Refusal> refusal_of(const Make& make) {
  try {
    make();
    return std::nullopt;
  } catch (const Error& error) {
    if (error.fault() != Fault::kBadInput) throw;
    return Refusal{error.what(), error.hint()};
  }
}

struct ComparedWay {
  std::string name;
  std::optional<Arrangement>& way;
  std::optional<Estimate>& estimate;
};

// Takes the other way of standing the same pieces where it is known to cost less, or this one
// cannot be made, and says whether it did.
bool prefer_cheaper(const ComparedWay& one, const std::optional<Arrangement>& other_way,
                    const std::optional<Estimate>& other, Comparison& comparison) {
  const bool is_refused = comparison.refused.contains(one.name);
  if (!other || (!one.estimate && !is_refused)) return false;
  if (one.estimate && (one.estimate->cost <= other->cost || other_way->trays > one.way->trays))
    return false;
  one.way = other_way;
  one.estimate = other;
  comparison.refused.erase(one.name);
  return true;
}

bool same_poses(const Arrangement& a, const Arrangement& b) {
  return std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(),
                    [](const JobPart& one, const JobPart& other) {
                      return one.tray == other.tray && one.pose.matrix() == other.pose.matrix();
                    });
}

// Each way is estimated by itself, several at once: a slicer works on one core most of its time.
void compare_ways(Plan& plan, std::optional<Arrangement> as_is, WholePieces pieces,
                  const Profile& profile, const Progress& progress) {
  Comparison& comparison = plan.job.estimates;
  const bool stands_best = as_is && plan.solid && same_poses(*as_is, *plan.solid);
  const ComparedWay packed{"packed", plan.packed, comparison.packed};
  const ComparedWay hollow{"hollow", plan.hollow, comparison.hollow};
  const ComparedWay solid{"solid", plan.solid, comparison.solid};
  std::vector<ComparedWay> ways{packed, hollow, solid};
  if (!stands_best) ways.push_back({"as_is", as_is, comparison.as_is});
  std::vector<std::optional<Refusal>> refusals(ways.size());
  std::atomic<int> done{0};
  parallel_tasks(ways.size(), [&](std::size_t i) {
    refusals[i] =
        refusal_of([&] { ways[i].estimate = estimate_of(ways[i].way, profile, progress); });
    progress.report("estimating", 0.2 + 0.8 * ++done / static_cast<double>(ways.size()));
  });
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (!refusals[i]) continue;
    comparison.refused[ways[i].name] = *refusals[i];
    ways[i].way.reset();
  }
  if (stands_best) {
    comparison.as_is = comparison.solid;
    if (comparison.refused.contains("solid"))
      comparison.refused["as_is"] = comparison.refused["solid"];
  }
  // The slicer need not agree with the ranking of the six ways up, of which the file's own is one,
  // nor with the packer.
  ComparedWays& compared = plan.job.compared;
  compared.solid_as_is = prefer_cheaper(solid, as_is, comparison.as_is, comparison);
  if (pieces == WholePieces::kSolid)
    compared.packed_apart = prefer_cheaper(packed, plan.solid, comparison.solid, comparison);
  if (pieces == WholePieces::kHollow)
    compared.packed_apart = prefer_cheaper(packed, plan.hollow, comparison.hollow, comparison);
}

// Why, where every way is refused: there is nothing to compare.
std::optional<Refusal> none_can_be_made(const Plan& plan) {
  const Comparison& ways = plan.job.estimates;
  if (ways.refused.empty() || ways.as_is || ways.solid || ways.hollow || ways.packed)
    return std::nullopt;
  const auto solid = ways.refused.find("solid");
  return (solid == ways.refused.end() ? ways.refused.begin() : solid)->second;
}

void drop_repeated(Warnings& warnings) {
  Warnings once;
  for (const Warning& warning : warnings) {
    const bool known = std::any_of(once.begin(), once.end(), [&](const Warning& other) {
      return other.code == warning.code && other.text == warning.text;
    });
    if (!known) once.push_back(warning);
  }
  warnings = std::move(once);
}

void record(Job& job, const std::vector<LoadedModel>& loaded, const DividedModels& models) {
  record_inputs(job, loaded);
  for (const auto& model : models) {
    job.shell_volume_mm3 += model->shell.volume_mm3;
    job.tetrahedra += model->tets.count();
    job.clusters += model->clusters;
    job.after_premerge += model->segments.count;
  }
  job.resample_tolerance_mm = resample_tolerance_mm(models);
}

}  // namespace

Plan plan(const Profile& profile, const PlanOptions& options, const Progress& progress) {
  Plan plan;
  plan.job.profile = profile;
  plan.job.seed = options.seed;
  Warnings& warnings = plan.job.warnings;
  StageTimes& times = plan.job.timings_s;

  const std::vector<LoadedModel> loaded = timed(times, "load", [&] {
    return load_models(options.models, options.sizing, warnings, progress);
  });
  // Dividing and packing work on one core some of the time; the other ways up are tried beside
  // them.
  const Progress silent({}, progress.cancelled());
  WholeModels shells;
  DividedModels models;
  std::map<std::string, Refusal, std::less<>>& refused = plan.job.estimates.refused;
  const auto keeps_powder =
      refusal_of([&] { require_openings(surfaces_of(loaded), profile, progress); });
  Beside beside;
  if (keeps_powder)
    refused["as_is"] = refused["solid"] = *keeps_powder;
  else
    beside.run([&] { plan.solid = stand_best(surfaces_of(loaded), profile, silent); });
  const auto undivided = timed(times, "divide", [&] {
    return refusal_of([&] { models = divide_all(loaded, profile, options, warnings, progress); });
  });
  record(plan.job, loaded, models);
  const auto not_hollow = undivided ? undivided : refusal_of([&] {
    shells = shells_of(models, profile, options, warnings, progress);
    require_openings(shells, profile, progress);
  });
  if (not_hollow)
    refused["hollow"] = *not_hollow;
  else
    beside.run([&] { plan.hollow = stand_best(shells, profile, silent); });
  const auto not_packed = undivided ? undivided : timed(times, "pack", [&] {
    return refusal_of([&] { pack_into(plan, models, profile, options, progress); });
  });
  if (not_packed) {
    refused["packed"] = *not_packed;
    plan.packed.reset();
  }
  timed(times, "estimate", [&] {
    progress.report("estimating", 0);
    beside.wait();
    compare_ways(plan, keeps_powder ? std::nullopt : stand_as_is(surfaces_of(loaded), profile),
                 whole_pieces(models, options), profile, progress);
  });

  if (const auto none = none_can_be_made(plan))
    throw Error(Fault::kBadInput, none->what, none->hint);

  drop_repeated(warnings);
  plan.job.compared.sha256 = comparison_sha256(profile, options, plan.job.inputs);
  plan.job.compared.warnings = warnings;
  return plan;
}

}  // namespace packmerger
