// Whether a comparison of the ways of printing still holds.
#pragma once

#include <string>
#include <vector>

#include "job/plan.h"
#include "model/job.h"
#include "model/printer.h"

namespace packmerger {

// The SHA-256 of all that the figures of a comparison and its warnings depend on: the models' names
// and bytes, how large and in which way they are treated, the whole profile, and the bytes of the
// slicer and of this very build of the program and its helper. Neither the wanted way nor the
// machine. Of the inputs, file and sha256 count.
std::string comparison_sha256(const Profile& profile, const PlanOptions& options,
                              const std::vector<JobInput>& inputs);

}  // namespace packmerger
