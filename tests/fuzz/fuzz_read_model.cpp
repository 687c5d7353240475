// Any bytes, under any extension, give a sound model or Error{kBadInput}.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "shape/read_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace packmerger;
  constexpr std::array<std::string_view, 6> kExtensions = {"stl", "obj", "ply", "off", "3mf", ""};
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    const ModelFile file =
        read_model_bytes(bytes, kExtensions[data[0] % kExtensions.size()], Progress());
    for (const auto& triangle : file.soup.triangles)
      for (const int corner : triangle)
        if (corner < 0 || corner >= static_cast<int>(file.soup.points.size())) std::abort();
  } catch (const Error& error) {
    if (error.fault() != Fault::kBadInput || error.hint().empty()) std::abort();
  }
  return 0;
}
