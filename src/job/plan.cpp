#include "job/plan.h"

#include <algorithm>
#include <atomic>
#include <memory>

#include "base/parallel.h"
#include "job/comparison_key.h"
#include "job/plan_steps.h"
#include "job/timings.h"
#include "printers/estimate.h"
#include "printers/slice.h"

namespace packmerger {
namespace {

std::optional<Estimate> estimate_of(const std::optional<Arrangement>& way, const Profile& profile,
                                    const Progress& progress) {
  if (!way) return std::nullopt;
  const std::vector<Tray> trays = trays_of(*way);
  return profile.is_sliced() ? estimate_by_slicer(profile, trays, assembly_of(*way), progress)
                             : estimate(profile, trays, assembly_of(*way), progress);
}

// Takes the other way of standing the same pieces where it is known to cost less, and says whether
// it did.
bool prefer_cheaper(std::optional<Arrangement>& way, std::optional<Estimate>& estimate,
                    const std::optional<Arrangement>& other_way,
                    const std::optional<Estimate>& other) {
  if (!estimate || !other || estimate->cost <= other->cost || other_way->trays > way->trays)
    return false;
  way = other_way;
  estimate = other;
  return true;
}

bool same_poses(const Arrangement& a, const Arrangement& b) {
  return std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(),
                    [](const JobPart& one, const JobPart& other) {
                      return one.tray == other.tray && one.pose.matrix() == other.pose.matrix();
                    });
}

// Each way is estimated by itself, several at once: a slicer works on one core most of its time.
void compare_ways(Plan& plan, const std::optional<Arrangement>& as_is, WholePieces pieces,
                  const Profile& profile, const Progress& progress) {
  struct Way {
    const std::optional<Arrangement>& way;
    std::optional<Estimate>& estimate;
  };
  Comparison& comparison = plan.job.estimates;
  const bool stands_best = as_is && plan.solid && same_poses(*as_is, *plan.solid);
  std::vector<Way> ways{{plan.packed, comparison.packed},
                        {plan.hollow, comparison.hollow},
                        {plan.solid, comparison.solid}};
  if (!stands_best) ways.push_back({as_is, comparison.as_is});
  std::atomic<int> done{0};
  parallel_tasks(ways.size(), [&](std::size_t i) {
    ways[i].estimate = estimate_of(ways[i].way, profile, progress);
    progress.report("estimating", 0.2 + 0.8 * ++done / static_cast<double>(ways.size()));
  });
  if (stands_best) comparison.as_is = comparison.solid;
  // The slicer need not agree with the ranking of the six ways up, of which the file's own is one,
  // nor with the packer.
  ComparedWays& compared = plan.job.compared;
  compared.solid_as_is = prefer_cheaper(plan.solid, comparison.solid, as_is, comparison.as_is);
  if (pieces == WholePieces::kSolid)
    compared.packed_apart =
        prefer_cheaper(plan.packed, comparison.packed, plan.solid, comparison.solid);
  if (pieces == WholePieces::kHollow)
    compared.packed_apart =
        prefer_cheaper(plan.packed, comparison.packed, plan.hollow, comparison.hollow);
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
  Beside beside;
  beside.run([&] { plan.solid = stand_best(surfaces_of(loaded), profile, silent); });
  const DividedModels models = timed(
      times, "divide", [&] { return divide_all(loaded, profile, options, warnings, progress); });
  record(plan.job, loaded, models);
  shells = shells_of(models, profile, options, warnings, progress);
  beside.run([&] { plan.hollow = stand_best(shells, profile, silent); });
  timed(times, "pack", [&] { pack_into(plan, models, profile, options, progress); });
  timed(times, "estimate", [&] {
    progress.report("estimating", 0);
    beside.wait();
    compare_ways(plan, stand_as_is(surfaces_of(loaded), profile), whole_pieces(models, options),
                 profile, progress);
  });

  drop_repeated(warnings);
  plan.job.compared.sha256 = comparison_sha256(profile, options, plan.job.inputs);
  plan.job.compared.warnings = warnings;
  return plan;
}

}  // namespace packmerger
