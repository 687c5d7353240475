#include "job/plan_known.h"

#include <algorithm>
#include <map>

#include "base/files.h"
#include "job/compare/advice.h"
#include "job/comparison_key.h"
#include "job/plan_steps.h"
#include "job/timings.h"

namespace packmerger {
namespace {

// Before anything is computed, by the files alone.
bool is_of(const KnownWays& known, const Profile& profile, const PlanOptions& options) {
  std::map<fs::path, std::string> done;
  std::vector<JobInput> inputs;
  for (const fs::path& model : options.models) {
    std::string& sha256 = done[model];
    if (sha256.empty()) sha256 = sha256_hex_of_file(model);
    inputs.push_back({model.filename().string(), sha256});
  }
  return known.compared.sha256 == comparison_sha256(profile, options, inputs);
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

// Makes the one way that is wanted, and keeps what is warned of.
class OneWay {
 public:
  OneWay(const Profile& profile, const PlanOptions& options, const KnownWays& known,
         Warnings& warnings, const Progress& progress)
      : profile_(profile),
        options_(options),
        known_(known),
        warnings_(warnings),
        progress_(progress) {}

  // False where its surface came out otherwise than when the ways were compared.
  bool make(Plan& plan, const std::vector<LoadedModel>& loaded, Variant variant) {
    if (variant == Variant::kSolid) plan.solid = solid(loaded);
    if (variant == Variant::kHollow) plan.hollow = hollow(loaded);
    if (variant == Variant::kPacked) pack(plan, loaded);
    return is_surface_as_known_;
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
    PlanOptions options = options_;
    if (options.hollow && !known_.resample_tolerance_mm) options.split = false;
    const DividedModels models = divide_each(loaded, [&](const Mesh& surface) {
      if (!options.split) return keep_whole(surface);
      return undivided(surface, profile_, options.hollow, warnings_, progress_);
    });
    if (!is_surface_as_known(models)) return std::nullopt;
    return stand_best(shells_of(models, profile_, options, warnings_, progress_), profile_,
                      progress_);
  }

  void pack(Plan& plan, const std::vector<LoadedModel>& loaded) {
    const DividedModels models = divide_all(loaded, profile_, options_, warnings_, progress_);
    if (!is_surface_as_known(models)) return;
    for (const auto& model : models) plan.job.shell_volume_mm3 += model->shell.volume_mm3;
    if (!known_.compared.packed_apart)
      pack_into(plan, models, profile_, options_, progress_);
    else
      plan.packed =
          whole_pieces(models, options_) == WholePieces::kSolid ? solid(loaded) : hollow(loaded);
  }

  bool is_surface_as_known(const DividedModels& models) {
    return is_surface_as_known_ = resample_tolerance_mm(models) == known_.resample_tolerance_mm;
  }

  const Profile& profile_;
  const PlanOptions& options_;
  const KnownWays& known_;
  Warnings& warnings_;
  const Progress& progress_;
  bool is_surface_as_known_ = true;
};

bool warns_of_anything_else(const Warnings& warnings, const Warnings& known) {
  return std::any_of(warnings.begin(), warnings.end(), [&](const Warning& warning) {
    return std::none_of(known.begin(), known.end(), [&](const Warning& other) {
      return other.code == warning.code && other.text == warning.text;
    });
  });
}

// Whether what was made is what the figures are of.
bool fits_estimate(const std::optional<Arrangement>& way, const std::optional<Estimate>& estimate) {
  if (!way || !estimate) return !way && !estimate;
  return way->trays == estimate->trays &&
         way->parts.size() == static_cast<std::size_t>(estimate->parts);
}

}  // namespace

std::optional<Plan> plan_known(const Profile& profile, const PlanOptions& options,
                               const KnownWays& known, Variant wanted, const Progress& progress) {
  const Variant variant =
      wanted == Variant::kCheapest ? cheapest(known.estimates).value_or(Variant::kPacked) : wanted;
  const bool is_timed = options.budget_s > 0 && variant == Variant::kPacked;
  // what could not be made then is tried again
  if (is_timed || !known.estimates.refused.empty() || !is_of(known, profile, options))
    return std::nullopt;
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
  OneWay way(profile, options, known, warnings, progress);
  const bool is_as_known = timed(times, "arrange", [&] { return way.make(plan, loaded, variant); });
  const std::optional<Arrangement>& made = variant == Variant::kSolid    ? plan.solid
                                           : variant == Variant::kHollow ? plan.hollow
                                                                         : plan.packed;
  if (!is_as_known || warns_of_anything_else(warnings, known.compared.warnings) ||
      !fits_estimate(made, estimate_of(known.estimates, variant)))
    return std::nullopt;
  return plan;
}

}  // namespace packmerger
