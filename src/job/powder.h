// What is printed in a bed of powder must let the powder out.
#pragma once

#include "base/progress.h"
#include "job/compare/arrangement.h"
#include "job/compare/unpacked.h"

namespace packmerger {

// Of models that are printed whole. Nothing where the profile is not one of powder. Throws
// Error{kBadInput} where powder would stay in a cavity: it has not two openings of 5 mm, and none of
// 9 mm.
void require_openings(const WholeModels& models, const Profile& profile, const Progress& progress);

// Of parts that were cut: an opening that a cut left is wide. The same error where a cavity was not
// cut at all.
void require_no_sealed_cavity(const Arrangement& arrangement, const Profile& profile);

}  // namespace packmerger
