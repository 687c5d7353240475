// One print's numbered lines, each sent once the one before is acknowledged.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware_io/conversation.h"
#include "firmware_io/gcode_channel.h"
#include "firmware_io/print_state.h"

namespace packmerger {

// The rules, and why, are in docs/PROTOCOLS, "Streaming G-code". The printer's line count decides
// what was taken: an ok that came too early or never is put right by the next line, which Marlin
// answers with Resend unless it follows the last one it took. Behind the program come M400 (wait
// for the moves) and M114, whose position report proves that everything before was executed.
class GcodeStream {
 public:
  // The printer's line count is 0. commands: the program's, without numbers.
  GcodeStream(GcodeChannel& channel, std::vector<std::string> commands,
              const StreamOptions& options, const GcodeAbilities& abilities, Reporter& reporter,
              PrintControl& control);

  // Returns when everything was executed, or, after a cancel, when the printer has stopped and
  // executed the safe text. Throws Error{kIo}.
  void run();

  bool was_cancelled() const { return cancelling_; }
  // False once the printer halted or was reset: nothing may be sent to it any more.
  bool may_send() const { return may_send_; }

 private:
  // A line that the printer asked for, and when to give it even if no further ok comes.
  struct Resend {
    std::size_t number = 0;
    double due_s = 0;
  };

  std::string command(std::size_t number) const;
  std::size_t exchange(std::size_t number);
  void handle(const GcodeReply& reply, std::size_t number);
  void handle_ok(const GcodeReply& reply);
  void handle_resend(std::size_t asked, std::size_t number);
  void handle_failed_heater(const GcodeReply& reply);
  void obey_requests(std::size_t number);
  void begin_cancel(std::size_t number);
  void watch_silence(std::size_t number);
  void recover();
  void send_raw(std::string_view line);
  void show_state(std::size_t number);
  [[noreturn]] void fail(const std::string& what, const std::string& hint) const;

  GcodeChannel& channel_;
  std::vector<std::string> commands_;
  const StreamOptions& options_;
  const GcodeAbilities abilities_;
  Reporter& reporter_;
  PrintControl& control_;

  bool cancelling_ = false;
  bool may_send_ = true;
  bool position_seen_ = false;  // by an M114 behind the program
  bool busy_seen_ = false;      // the printer says when it is busy
  std::string prompt_;          // what the printer asks its user

  // of the line that is being exchanged
  int owed_oks_ = 0;
  std::optional<Resend> resend_;
  bool recovering_ = false;         // an M105 was sent behind it
  bool taken_for_granted_ = false;  // only that M105 was answered
  int attempts_ = 0;
  double sent_at_s_ = 0;
  double alive_at_s_ = 0;
  double attempt_at_s_ = 0;

  // over several lines
  int unproven_ = 0;          // lines in a row that were taken for granted
  std::size_t asked_ = 0;     // the line last asked for,
  int asked_times_ = 0;       // and how often
  std::size_t far_back_ = 0;  // a request too far back to be true
};

}  // namespace packmerger
