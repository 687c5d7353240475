#include "firmware_io/conversation.h"

#include <utility>

#include "base/error.h"

namespace packmerger {

void write_all(Port& port, std::string_view bytes) {
  constexpr double kStuck_s = 5;
  double moved_at = port.now_s();
  while (!bytes.empty()) {
    const std::size_t count = port.write(bytes, kSlice_s);
    bytes.remove_prefix(count);
    if (count > 0) moved_at = port.now_s();
    if (port.now_s() - moved_at > kStuck_s)
      throw Error(Fault::kIo, "The printer at " + port.name() + " takes no more data",
                  "Switch the printer off and on, check its cable, then print the job again.");
  }
}

Reporter::Reporter(const Port& port, const PrintListener& listener, std::size_t total)
    : port_(port), listener_(listener) {
  report_.total = total;
  tell();
}

void Reporter::state(PrintState state, std::string text) {
  if (state == report_.state && text == report_.text) return;
  report_.state = state;
  report_.text = std::move(text);
  tell();
}

void Reporter::done(std::size_t done) {
  constexpr double kInterval_s = 0.1;
  if (done == report_.done) return;
  report_.done = done;
  if (done == report_.total || port_.now_s() - told_at_s_ >= kInterval_s) tell();
}

void Reporter::tell() {
  told_at_s_ = port_.now_s();
  if (listener_) listener_(report_);
}

}  // namespace packmerger
