#include "firmware_io/conversation.h"

#include <algorithm>
#include <cctype>
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

void check_not_ended(const PrintControl& control) {
  if (control.cancelled() || control.stopped())
    throw Error(Fault::kInterrupted, "Cancelled before the print began", "");
}

void check_machine(const std::string& port, const std::string& says, const std::string& wanted) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) ==
           std::tolower(static_cast<unsigned char>(b));
  };
  if (std::search(says.begin(), says.end(), wanted.begin(), wanted.end(), same) != says.end() ||
      wanted.empty())
    return;
  throw Error(Fault::kUnavailable,
              "The profile wants \"" + wanted + "\", but the printer at " + port +
                  " says that it is \"" + says + "\"",
              "Name the right port, or correct the profile's link.machine.");
}

void throw_stopped() {
  throw Error(Fault::kIo, "The printer was stopped at once, as somebody asked",
              "Look at the machine, switch it off and on, then print the job again.");
}

Reporter::Reporter(const Port& port, const PrintListener& listener, std::size_t total)
    : port_(port), listener_(listener) {
  report_.total = total;
  tell();
}

void Reporter::state(PrintState state, std::string text, std::vector<std::string> choices) {
  if (state == report_.state && text == report_.text && choices == report_.choices) return;
  report_.state = state;
  report_.text = std::move(text);
  report_.choices = std::move(choices);
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
