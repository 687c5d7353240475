// One way of printing, with the figures of a comparison that was made before.
#pragma once

#include <optional>

#include "job/compare/advice.h"
#include "job/plan.h"
#include "model/compared_ways.h"

namespace packmerger {

// What plan() would make of it, times aside, but only with the way that `variant` asks for. Empty
// where `known` compared anything else (comparison_sha256), where a clock ended its packing and
// that is to be done again, or where it comes out otherwise this time, so that the figures and
// warnings are not its own: TetGen may have met the end of its time or its memory now, or then.
// Throws what plan() throws.
std::optional<Plan> plan_known(const Profile& profile, const PlanOptions& options,
                               const KnownWays& known, Variant variant, const Progress& progress);

}  // namespace packmerger
