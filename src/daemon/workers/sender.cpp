#include "base/time/clock.h"
#include "daemon/workers/print_clock.h"
#include "daemon/workers/worker.h"
#include "delivery/send.h"
#include "delivery/way.h"

namespace packmerger {
namespace {

SendOutcome outcome_of(const Error& error, bool begun, const PrintControl& control) {
  if (error.fault() == Fault::kInterrupted || control.cancelled()) return SendOutcome::kCancelled;
  const bool later = error.fault() == Fault::kUnavailable || error.fault() == Fault::kBusy ||
                     error.fault() == Fault::kCannotWrite ||
                     (error.fault() == Fault::kIo && !control.stopped());
  return later && !begun ? SendOutcome::kNotStarted : SendOutcome::kFailed;
}

SendEnded send(const SendOrder& order, Queue<Event>& events, const PrinterConfig& printer,
               Pulse& pulse) {
  bool begun = false;
  PrintClock clock;
  const auto listener = [&](const PrintReport& report) {
    begun = begun || has_begun(report);
    clock.report(report.state, steady_now_s());
    events.push(SendProgress{order.job, report});
  };
  try {
    if (order.control->cancelled()) throw Error(Fault::kInterrupted, "Cancelled", "");
    if (printer.hands_over()) {
      const Pulse::Stroke stroke(pulse);
      const fs::path target =
          hand_over(order.folder, printer.handoff_folder, order.handoff_name, order.tray_files);
      return {order.job, SendOutcome::kDone, {}, "handed over in " + target.string()};
    }
    send_tray(order.folder, order.tray, printer.port, order.told_file, listener, *order.control,
              order.tray_files);
    clock.end(steady_now_s());
    // a document was only taken: how long it is printed, the printer does not tell
    if (!way_of(printer.abilities).tells_end) return {order.job, SendOutcome::kDone, {}, ""};
    return {order.job, SendOutcome::kDone, {}, "", clock.printed_s(), clock.paused_s()};
  } catch (const Error& error) {
    return {order.job,
            outcome_of(error, begun, *order.control),
            {error.fault(), error.what(), error.hint()},
            "",
            0,
            0,
            !begun && error.fault() != Fault::kBusy};
  } catch (const std::exception& error) {
    return {order.job,
            SendOutcome::kFailed,
            {Fault::kInternal, error.what(), "Look into the daemon's messages."},
            ""};
  }
}

}  // namespace

void run_sender(Queue<SendOrder>& orders, Queue<Event>& events, const PrinterConfig& printer,
                Pulse& pulse) {
  while (const std::optional<SendOrder> order = orders.pop())
    events.push(send(*order, events, printer, pulse));
}

}  // namespace packmerger
