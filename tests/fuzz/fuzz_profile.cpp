// Any text as a profile, or as a setting of one, gives a profile or an Error that says what to do.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/files.h"
#include "model/printer.h"

namespace {

using namespace packmerger;

void profile_file(std::string_view text) {
  static const TemporaryFolder folder;
  const fs::path path = folder.path() / "fuzz.toml";
  write_file_whole(path, text);
  try {
    profile_toml(read_profile(path.string()));
  } catch (const Error& error) {
    // a base may be named that is not there
    const bool expected = error.fault() == Fault::kBadProfile || error.fault() == Fault::kNoInput;
    if (!expected || error.hint().empty()) std::abort();
  }
}

void setting(std::string_view text) {
  Profile profile;
  try {
    set_profile_key(profile, text);
    profile_toml(profile);
  } catch (const Error& error) {
    if (error.fault() != Fault::kUsage || error.hint().empty()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  data[0] % 2 == 0 ? profile_file(text) : setting(text);
  return 0;
}
