// Whether a comparison of the ways of printing still holds.
#pragma once

#include <string>
#include <vector>

#include "job/plan.h"
#include "model/printer.h"

namespace packmerger {

// The SHA-256 of all that the figures of a comparison depend on: the models' bytes, how large and
// in which way they are treated, the whole profile, the slicer and this program's version. Neither
// the wanted way nor the machine. model_sha256: one per options.models, in order.
std::string comparison_sha256(const Profile& profile, const PlanOptions& options,
                              const std::vector<std::string>& model_sha256);

}  // namespace packmerger
