// What the daemon answers to the requests of docs/DAEMON.md: JSON in, JSON out. Runs on the loop's
// thread and touches nothing but the job manager and the keys.
#pragma once

#include <string>
#include <string_view>

#include "daemon/jobs/job_manager.h"
#include "daemon/keys/key_ring.h"
#include "daemon/orders/messages.h"

namespace packmerger {

// One request, one reply, both without a line end. A request that cannot be understood or done is
// answered too: {"ok": false, "error": {"fault", "what", "hint"}}; nothing is thrown for it.
std::string answer(JobManager& job_manager, KeyRing& keys, std::string_view request);

// The same for a file that came over the web: the job that it became.
std::string answer_upload(JobManager& job_manager, const UploadedJob& upload);

}  // namespace packmerger
