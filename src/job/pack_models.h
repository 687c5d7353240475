// Packs the divided models on the profile's tray and turns the answer into exact parts.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/progress.h"
#include "job/compare/arrangement.h"
#include "job/divide.h"
#include "model/printer.h"

namespace packmerger {

// What the packer is asked: the models' segments, or the whole models, on the profile's tray.
// models: as below.
PackProblem packing_problem(const std::vector<std::shared_ptr<const Divided>>& models,
                            const Profile& profile, std::uint64_t seed, double budget_s);

// models: one per input, in order; copies of one input may share an object. Every promise of the
// job folder on geometry is proved here on the points that are written (promises.h), after packing
// has closed and turned the parts: a layout that does not keep them is packed again with more room
// and, after some tries, refused with Error{kInternal}. Throws Error{kBadInput} when a part fits no
// tray.
Arrangement pack_models(const std::vector<std::shared_ptr<const Divided>>& models,
                        const Profile& profile, std::uint64_t seed, double budget_s,
                        const Progress& progress);

}  // namespace packmerger
