// The threads that do the daemon's slow work: workers prepare jobs in child processes, a sender per
// printer prints. Each takes orders from its queue until that is closed, and answers through
// `events`.
#pragma once

#include <string>
#include <thread>
#include <vector>

#include "daemon/orders/messages.h"
#include "daemon/orders/pulse.h"
#include "daemon/settings/config.h"

namespace packmerger {

// Each runs on the calling thread until its orders are closed and done. Workers may share their
// orders: each job has a folder of its own, below which alone its child may write.
void run_worker(Queue<PrepareOrder>& orders, Queue<Event>& events);
// pulse: while it is at a hand-over folder.
void run_sender(Queue<SendOrder>& orders, Queue<Event>& events, const PrinterConfig& printer,
                Pulse& pulse);

// "[ 42%] packing", as packmerger writes it where standard error is no terminal.
struct ProgressLine {
  std::string stage;
  double fraction = 0;
};
std::optional<ProgressLine> progress_line(std::string_view line);

// What a child process that failed wrote last: "error: …" and "hint: …".
Failure child_failure(int exit_code, int signal, std::string_view standard_error);

}  // namespace packmerger
