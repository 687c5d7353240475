// The comparison as people read it: a table, the differences in per cent and a recommendation.
#pragma once

#include <string>

#include "model/estimate.h"

namespace packmerger {

// Plain text of fixed width, ending in a newline; title: the machine. Differences are against the
// cheapest way that needs no dividing (as is, solid, hollow), since that is what one would print
// otherwise.
std::string comparison_table(const Comparison& comparison, const std::string& title);

// Whether packing is worth it and what to do otherwise: one or two sentences.
std::string recommendation(const Comparison& comparison);

// "2 h 05 min", "41 min", "38 s".
std::string spoken_time(double seconds);

}  // namespace packmerger
