// One build on a printer that speaks s3g: filling its buffer, watching what it makes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "base/error.h"
#include "firmware_io/conversation.h"
#include "firmware_io/print_state.h"
#include "firmware_io/s3g/s3g_actions.h"
#include "firmware_io/s3g/s3g_axes.h"
#include "firmware_io/s3g/s3g_buffer.h"
#include "firmware_io/s3g/s3g_channel.h"

namespace packmerger::s3g {

// The rules, and why, are in docs/PROTOCOLS, "Streaming x3g".
class Print {
 public:
  Print(Channel& channel, Reporter& reporter, PrintControl& control);

  // Waits for the board and makes sure that it speaks s3g, is the machine (check_machine()) and is
  // not building. Throws
  // Error{kUnavailable}, {kBusy} or {kInterrupted}; the printer was not touched then.
  void connect(double boot_wait_s, const std::string& machine);

  // Streams the actions, build start and build end among them, and returns when the printer says
  // that its build is finished. Throws Error{kIo}, or Error{kInterrupted} after a cancel that the
  // printer carried out.
  void run(const Actions& actions);

  // Best effort after a failure: stops the machine, heaters off.
  void abort_quietly();
  // The same after what run() threw. Where somebody wished the end, and the printer failed on the
  // way to it, throws Error that tells the wish as the cause, and that the heaters may be on.
  void end_by(const Error& error);

 private:
  void send(std::size_t index);
  void note_accepted(std::size_t index);
  void wait_for_room(std::size_t size);
  void finish();

  bool was_taken(std::size_t index);
  void check_nothing_taken_twice();
  std::optional<bool> has_taken(std::string_view action);
  std::optional<bool> buffer_tells(std::size_t length);
  std::optional<bool> build_tells(std::uint8_t code, BuildState state) const;
  std::optional<bool> count_tells(std::uint32_t actions);
  std::optional<bool> position_tells(std::string_view action);
  Steps position_at_rest();

  void obey();
  void cancel();
  [[noreturn]] void stop_at_once();
  [[noreturn]] void leave_at_once();
  void set_paused(bool wanted);
  void wait(double& wait_s, double longest_s);
  void watch();
  void watch_when_due();
  void judge(const Statistics& statistics);
  void show(BuildState state, std::uint8_t board_status);
  std::string_view current_action();
  std::string heating_text(std::string_view action);
  void note_heaters();
  void tell_heaters();

  Channel& channel_;
  Reporter& reporter_;
  PrintControl& control_;
  const Actions* actions_ = nullptr;

  Buffer buffer_;                  // with all that was accepted
  Axes axes_;                      // after all that was accepted
  std::size_t accepted_ = 0;       // actions
  bool counts_ = false;            // the printer counts what it executes
  std::size_t start_ = 0;          // index of the build start that was accepted last
  std::uint32_t after_start_ = 0;  // actions accepted since
  bool started_ = false;           // a build start was accepted
  bool ended_ = false;             // a build end was accepted
  bool may_have_ended_ = false;    // the answer to one got lost
  bool seen_running_ = false;
  std::optional<bool> pause_wanted_;  // asked for, until the build has begun
  bool may_abort_ = true;
  bool leaves_ = false;  // the last was said, whatever comes
  double watched_at_s_ = 0;

  std::set<std::uint8_t> tools_;  // that the program heats
  bool heats_platform_ = false;
  double heaters_at_s_ = 0;
};

}  // namespace packmerger::s3g
