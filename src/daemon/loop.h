// The daemon's loop: the one thread that owns jobs, database, watched folders and the socket.
#pragma once

#include <functional>
#include <string>

#include "daemon/settings/config.h"

namespace packmerger {

// Runs until SIGTERM or SIGINT. Then nothing new is started, children are ended, a running
// print is cancelled in the printer's own way (heaters off) and recorded as failed; a second
// signal ends the process at once. Call it on the main thread, before any other is started.
// Throws Error{kBusy} when another daemon works in the state folder, and whatever keeps it from
// starting. SIGHUP calls `read` again and takes over what it returns (reload.h). log takes one line
// without its end, from the calling thread only.
void run_daemon(const std::function<DaemonConfig()>& read,
                const std::function<void(const std::string&)>& log);

}  // namespace packmerger
