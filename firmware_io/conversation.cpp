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

void throw_failed_cancel(const Error& error, bool at_printer) {
  throw Error(at_printer ? Fault::kIo : Fault::kInterrupted,
              std::string("The print was cancelled") + (at_printer ? " at the printer" : "") +
                  ", but it is not certain that the printer obeyed: " + error.what(),
              kMayBeHot);
}

Reporter::Reporter(const Port& port, const PrintListener& listener, const StreamOptions& options,
                   std::size_t total, RemainingTime remaining)
    : port_(port),
      listener_(listener),
      options_(options),
      remaining_(std::move(remaining)),
      began_at_s_(port.now_s()),
      told_at_s_(began_at_s_),
      counted_at_s_(began_at_s_) {
  report_.total = total;
  acknowledge();
  tell();
}

void Reporter::state(PrintState state, std::string text, std::vector<std::string> choices) {
  if (state == report_.state && text == report_.text && choices == report_.choices) return;
  count_time();
  report_.state = state;
  report_.text = std::move(text);
  report_.choices = std::move(choices);
  tell();
}

void Reporter::done(std::size_t done) {
  constexpr double kInterval_s = 0.1;
  if (done == report_.done) return;
  report_.done = done;
  acknowledge();
  if (done == report_.total || port_.now_s() - told_at_s_ >= kInterval_s) tell();
}

void Reporter::heaters(std::vector<HeaterReport> heaters) {
  if (!heaters.empty()) report_.heaters = std::move(heaters);
}

void Reporter::tick() {
  constexpr double kInterval_s = 1;
  if (port_.now_s() - told_at_s_ < kInterval_s) return;
  acknowledge();
  tell();
}

void Reporter::acknowledge() {
  if (options_.on_acknowledged) options_.on_acknowledged(report_.done, report_.total);
}

void Reporter::count_time() {
  const double now = port_.now_s();
  if (report_.state == PrintState::kPrinting) printed_s_ += now - counted_at_s_;
  counted_at_s_ = now;
}

void Reporter::tell() {
  count_time();
  told_at_s_ = port_.now_s();
  report_.elapsed_s = told_at_s_ - began_at_s_;
  report_.remaining_s = remaining_.remaining_s(report_.done, printed_s_);
  if (report_.state == PrintState::kConnecting || report_.state == PrintState::kCancelling)
    report_.remaining_s.reset();
  if (listener_) listener_(report_);
}

}  // namespace packmerger
