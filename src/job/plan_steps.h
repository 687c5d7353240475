// What comparing all ways of printing and taking one whose figures are known have in common.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "job/compare/arrangement.h"
#include "job/compare/unpacked.h"
#include "job/divide.h"
#include "job/load_models.h"
#include "job/plan.h"

namespace packmerger {

// One per input, in order; copies share an object.
using DividedModels = std::vector<std::shared_ptr<const Divided>>;

// Copies of one input are divided once.
DividedModels divide_each(const std::vector<LoadedModel>& loaded,
                          const std::function<Divided(const Mesh&)>& divide);

// As `options` say: into parts that can be packed, or kept whole.
DividedModels divide_all(const std::vector<LoadedModel>& loaded, const Profile& profile,
                         const PlanOptions& options, Warnings& warnings, const Progress& progress);

WholeModels surfaces_of(const std::vector<LoadedModel>& loaded);

// The models hollowed in one piece; models that are not divided have not been hollowed yet.
WholeModels shells_of(const DividedModels& models, const Profile& profile,
                      const PlanOptions& options, Warnings& warnings, const Progress& progress);

// Of models that are not divided: the unpacked way whose pieces are those that are packed.
enum class WholePieces { kNone, kHollow, kSolid };
WholePieces whole_pieces(const DividedModels& models, const PlanOptions& options);

// What each surface was allowed to move where any was re-sampled; empty where none was.
std::optional<double> resample_tolerance_mm(const DividedModels& models);

// Packs them. What fits no tray is an outcome that a comparison shows: plan.not_packed. Throws
// Error{kBadInput} where powder would stay in a part.
void pack_into(Plan& plan, const DividedModels& models, const Profile& profile,
               const PlanOptions& options, const Progress& progress);

// Writes the inputs down, and their surfaces.
void record_inputs(Job& job, const std::vector<LoadedModel>& loaded);

}  // namespace packmerger
