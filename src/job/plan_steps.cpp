#include "job/plan_steps.h"

#include <algorithm>
#include <map>

#include "job/choose_division.h"
#include "job/pack_models.h"
#include "job/powder.h"
#include "shape/solid/hollow.h"

namespace packmerger {

DividedModels divide_each(const std::vector<LoadedModel>& loaded,
                          const std::function<Divided(const Mesh&)>& divide) {
  std::map<const Mesh*, std::shared_ptr<const Divided>> done;
  DividedModels models;
  for (const LoadedModel& model : loaded) {
    std::shared_ptr<const Divided>& divided = done[model.surface.get()];
    if (!divided) divided = std::make_shared<const Divided>(divide(*model.surface));
    models.push_back(divided);
  }
  return models;
}

DividedModels divide_all(const std::vector<LoadedModel>& loaded, const Profile& profile,
                         const PlanOptions& options, Warnings& warnings, const Progress& progress) {
  return divide_each(loaded, [&](const Mesh& surface) {
    if (!options.split) return keep_whole(surface);
    return choose_division(surface, profile, options.hollow, options.seed, warnings, progress);
  });
}

WholeModels surfaces_of(const std::vector<LoadedModel>& loaded) {
  WholeModels surfaces;
  for (const LoadedModel& model : loaded) surfaces.push_back(model.surface);
  return surfaces;
}

WholeModels shells_of(const DividedModels& models, const Profile& profile,
                      const PlanOptions& options, Warnings& warnings, const Progress& progress) {
  std::map<const Divided*, std::shared_ptr<const Mesh>> done;
  WholeModels shells;
  for (const auto& model : models) {
    std::shared_ptr<const Mesh>& surface = done[model.get()];
    if (!surface) {
      const bool to_hollow = options.hollow && !options.split;
      surface = std::make_shared<const Mesh>(
          shell_surface(to_hollow ? hollow(model->shell.outer, profile.shape, warnings, progress)
                                  : model->shell));
    }
    shells.push_back(surface);
  }
  return shells;
}

WholePieces whole_pieces(const DividedModels& models, const PlanOptions& options) {
  const bool whole = std::all_of(models.begin(), models.end(),
                                 [](const auto& model) { return model->tets.count() == 0; });
  if (!whole) return WholePieces::kNone;
  return options.split ? WholePieces::kHollow : WholePieces::kSolid;
}

std::optional<double> resample_tolerance_mm(const DividedModels& models) {
  std::optional<double> most;
  for (const auto& model : models)
    if (const std::optional<double> tolerance = model->resample_tolerance_mm)
      most = std::max(most.value_or(0), *tolerance);
  return most;
}

namespace {

WholeModels kept_whole(const DividedModels& models) {
  std::map<const Divided*, std::shared_ptr<const Mesh>> done;
  WholeModels whole;
  for (const auto& model : models) {
    if (model->tets.count() > 0) continue;
    std::shared_ptr<const Mesh>& surface = done[model.get()];
    if (!surface) surface = std::make_shared<const Mesh>(shell_surface(model->shell));
    whole.push_back(surface);
  }
  return whole;
}

}  // namespace

void pack_into(Plan& plan, const DividedModels& models, const Profile& profile,
               const PlanOptions& options, const Progress& progress) {
  require_openings(kept_whole(models), profile, progress);
  try {
    plan.packed = pack_models(models, profile, options.seed, options.budget_s, progress);
  } catch (const Error& error) {
    if (error.fault() != Fault::kBadInput) throw;
    plan.not_packed = error;
    return;
  }
  require_no_sealed_cavity(*plan.packed, profile);
}

void record_inputs(Job& job, const std::vector<LoadedModel>& loaded) {
  for (const LoadedModel& model : loaded) {
    job.inputs.push_back(model.input);
    job.models.push_back(*model.surface);
  }
}

}  // namespace packmerger
