#include "local/places.h"

#include <cstdlib>
#include <system_error>

namespace packmerger {

namespace fs = std::filesystem;

fs::path environment_path(const char* name) {
  const char* text = std::getenv(name);
  return text != nullptr ? text : "";
}

fs::path default_state_folder() {
  if (const fs::path given = environment_path("STATE_DIRECTORY"); given.is_absolute()) return given;
  if (const fs::path base = environment_path("XDG_STATE_HOME"); base.is_absolute())
    return base / "packmerger";
  const fs::path home = environment_path("HOME");
  return home.is_absolute() ? home / ".local/state/packmerger" : fs::path();
}

fs::path socket_in(const fs::path& folder) { return folder / "packmergerd.sock"; }

fs::path default_socket() {
  if (const fs::path given = environment_path("PACKMERGER_SOCKET"); !given.empty()) return given;
  std::error_code ignored;
  const fs::path own = socket_in(default_state_folder());
  const fs::path system = socket_in("/run/packmerger");
  const bool only_system = !fs::exists(own, ignored) && fs::exists(system, ignored);
  return only_system ? system : own;
}

}  // namespace packmerger
