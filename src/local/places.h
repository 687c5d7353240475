// Where a daemon keeps its state, and where its socket is: known to the daemon and to those who
// speak to it.
#pragma once

#include <filesystem>

namespace packmerger {

// What an environment variable says; empty where it is not set.
std::filesystem::path environment_path(const char* name);

// $STATE_DIRECTORY, or packmerger below $XDG_STATE_HOME, or ~/.local/state/packmerger.
std::filesystem::path default_state_folder();

// The socket's name in a folder.
std::filesystem::path socket_in(const std::filesystem::path& folder);

// $PACKMERGER_SOCKET, or the socket in the user's own state folder, or, where only that one is
// there, that of the system's daemon in /run/packmerger.
std::filesystem::path default_socket();

}  // namespace packmerger
