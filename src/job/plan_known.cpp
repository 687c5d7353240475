#include "job/plan_known.h"

#include <algorithm>
#include <map>

#include "base/files.h"
#include "job/comparison_key.h"
#include "job/pack_models.h"
#include "job/plan_steps.h"
#include "job/timings.h"

namespace packmerger {
namespace {

// Before anything is computed, by the bytes of the files alone.
bool is_of(const KnownWays& known, const Profile& profile, const PlanOptions& options) {
  std::map<fs::path, std::string> done;
  std::vector<std::string> hashes;
  for (const fs::path& model : options.models) {
    std::string& sha256 = done[model];
    if (sha256.empty()) sha256 = sha256_hex_of_file(model);
    hashes.push_back(sha256);
  }
  return known.compared.sha256 == comparison_sha256(profile, options, hashes);
}

void record_known(Job& job, const KnownWays& known) {
  job.compared = known.compared;
  job.warnings = known.compared.warnings;
  job.estimates = known.estimates;
  job.tetrahedra = known.tetrahedra;
  job.clusters = known.clusters;
  job.after_premerge = known.after_premerge;
  job.resample_tolerance_mm = known.resample_tolerance_mm;
}

// Makes the one way that is wanted. What is warned of is known.
class OneWay {
 public:
  OneWay(const Profile& profile, const PlanOptions& options, const KnownWays& known,
         const Progress& progress)
      : profile_(profile), options_(options), known_(known), progress_(progress) {}

  void make(Plan& plan, const std::vector<LoadedModel>& loaded, Variant variant) {
    if (variant == Variant::kSolid) plan.solid = solid(loaded);
    if (variant == Variant::kHollow) plan.hollow = hollow(loaded);
    if (variant == Variant::kPacked) pack(plan, loaded);
  }

 private:
  std::optional<Arrangement> solid(const std::vector<LoadedModel>& loaded) {
    const WholeModels models = surfaces_of(loaded);
    return known_.compared.solid_as_is ? stand_as_is(models, profile_)
                                       : stand_best(models, profile_, progress_);
  }

  // Only what was re-sampled for its tetrahedra needs them again: elsewhere the shell is that of
  // the surface itself.
  std::optional<Arrangement> hollow(const std::vector<LoadedModel>& loaded) {
    Warnings known;
    PlanOptions options = options_;
    if (options.hollow && !known_.resample_tolerance_mm) options.split = false;
    const DividedModels models = divide_each(loaded, [&](const Mesh& surface) {
      if (!options.split) return keep_whole(surface);
      return undivided(surface, profile_, options.hollow, known, progress_);
    });
    return stand_best(shells_of(models, profile_, options, known, progress_), profile_, progress_);
  }

  void pack(Plan& plan, const std::vector<LoadedModel>& loaded) {
    Warnings known;
    const DividedModels models = divide_all(loaded, profile_, options_, known, progress_);
    for (const auto& model : models) plan.job.shell_volume_mm3 += model->shell.volume_mm3;
    if (!known_.compared.packed_apart)
      plan.packed = pack_models(models, profile_, options_.seed, options_.budget_s, progress_);
    else
      plan.packed =
          whole_pieces(models, options_) == WholePieces::kSolid ? solid(loaded) : hollow(loaded);
  }

  const Profile& profile_;
  const PlanOptions& options_;
  const KnownWays& known_;
  const Progress& progress_;
};

}  // namespace

std::optional<Plan> plan_known(const Profile& profile, const PlanOptions& options,
                               const KnownWays& known, Variant wanted, const Progress& progress) {
  const Variant variant =
      wanted == Variant::kCheapest ? cheapest(known.estimates).value_or(Variant::kPacked) : wanted;
  const bool is_timed = options.budget_s > 0 && variant == Variant::kPacked;
  if (is_timed || !is_of(known, profile, options)) return std::nullopt;
  Plan plan;
  plan.job.profile = profile;
  plan.job.seed = options.seed;
  StageTimes& times = plan.job.timings_s;
  Warnings warnings;
  const std::vector<LoadedModel> loaded = timed(times, "load", [&] {
    return load_models(options.models, options.sizing, warnings, progress);
  });
  record_inputs(plan.job, loaded);
  record_known(plan.job, known);
  timed(times, "arrange",
        [&] { OneWay(profile, options, known, progress).make(plan, loaded, variant); });
  return plan;
}

}  // namespace packmerger
