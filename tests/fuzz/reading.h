// What every fuzzer of models expects of the reader.
#pragma once

#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "shape/read/read_model.h"

namespace packmerger::fuzz {

// A sound model or Error{kBadInput} with a hint; anything else aborts.
inline void check_reading(std::string_view bytes, std::string_view extension) {
  try {
    const ModelFile file = read_model_bytes(bytes, extension, Progress());
    for (const auto& triangle : file.soup.triangles)
      for (const int corner : triangle)
        if (corner < 0 || corner >= static_cast<int>(file.soup.points.size())) std::abort();
  } catch (const Error& error) {
    if (error.fault() != Fault::kBadInput || error.hint().empty()) std::abort();
  }
}

}  // namespace packmerger::fuzz
