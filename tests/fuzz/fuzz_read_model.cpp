// Any bytes, under any extension, give a sound model or Error{kBadInput}.
// The first byte chooses the extension: 0 to 5 in the seeds.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fuzz/reading.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<std::string_view, 6> kExtensions = {"stl", "obj", "ply", "off", "3mf", ""};
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  packmerger::fuzz::check_reading(bytes, kExtensions[data[0] % kExtensions.size()]);
  return 0;
}
