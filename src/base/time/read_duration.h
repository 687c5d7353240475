// Times as people write them.
#pragma once

#include <optional>
#include <string_view>

namespace packmerger {

// Seconds of "6h23m", "6 h 23 min 10 s", "1d 2h", "1.5h", "383min", "90s", "6:23:10" or, in hours
// and minutes, "6:23". Nothing for anything else: a bare number, units out of order, or not above
// 0.
std::optional<double> read_duration(std::string_view text);

}  // namespace packmerger
