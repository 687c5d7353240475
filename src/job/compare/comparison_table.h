// The comparison as people read it: what each way takes and costs, and which is best.
#pragma once

#include <string>
#include <string_view>

#include "model/estimate.h"

namespace packmerger {

// Plain text, ending in a newline; title: the machine. Differences are against the cheapest way
// that needs no dividing (as is, solid, hollow), since that is what one would print otherwise. Ways
// whose figures read the same share a line. prepared: the variant that was prepared, empty before;
// taking: what is typed to take another, before its name. Neither is said where there is nothing to
// do.
std::string comparison_table(const Comparison& comparison, const std::string& title,
                             std::string_view prepared = {},
                             const std::string& taking = "--variant");

// "2 h 05 min", "41 min", "38 s".
std::string spoken_time(double seconds);

}  // namespace packmerger
