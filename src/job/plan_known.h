// One way of printing, with the figures of a comparison that was made before.
#pragma once

#include <optional>

#include "job/advice.h"
#include "job/plan.h"
#include "model/compared_ways.h"

namespace packmerger {

// What plan() would make of it, times aside, but only with the way that `variant` asks for. Empty
// where `known` compared anything else (comparison_sha256), or where a clock ended its packing and
// that is to be done again. Throws what plan() throws, and Error{kBadInput} as it does in its
// not_packed where the parts fit no tray.
std::optional<Plan> plan_known(const Profile& profile, const PlanOptions& options,
                               const KnownWays& known, Variant variant, const Progress& progress);

}  // namespace packmerger
