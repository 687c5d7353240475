// For what somebody may have meant who mistyped a word.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

// The word among `known` that takes the fewest letters put in, left out, changed or swapped with
// their neighbour, capitals or not; nothing where that is more than a third of what was given.
std::optional<std::string> nearest(std::string_view given, const std::vector<std::string>& known);

// The same as a hint's first sentence, "Did you mean \"prepare\"? ", or nothing.
std::string did_you_mean(std::string_view given, const std::vector<std::string>& known);

}  // namespace packmerger
