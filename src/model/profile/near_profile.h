// Which of the profiles comes near a printer that has none.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

// A hint's first sentences: which of `ids` was meant or comes nearest, told by how the name is
// spelled, by the maker or machine that it names ("Connex"), or else the one for any machine that
// prints from filament, and how it is used for another machine. Empty where none of these is there.
std::string near_profile(std::string_view name, const std::vector<std::string>& ids);

}  // namespace packmerger
