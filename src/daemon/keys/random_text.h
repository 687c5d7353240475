// Texts that nobody can guess.
#pragma once

#include <cstddef>
#include <string>

namespace packmerger {

// `bytes` random bytes of the system, six bits a letter: A-Z, a-z, 0-9, "-" and "_". Throws
// Error{kInternal} where the system gives none.
std::string random_text(std::size_t bytes);

}  // namespace packmerger
