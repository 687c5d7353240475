// One print's numbered lines, and what the printer and its people make of them.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "firmware_io/conversation.h"
#include "firmware_io/gcode/gcode_channel.h"
#include "firmware_io/gcode/gcode_place.h"
#include "firmware_io/gcode/gcode_script.h"
#include "firmware_io/gcode/gcode_tally.h"
#include "firmware_io/gcode/heat_watch.h"
#include "firmware_io/print_state.h"

namespace packmerger {

// The rules, and why, are in docs/PROTOCOLS, "Streaming G-code". The printer's line count decides
// what was taken: an ok that came too early or never is put right by the next line, which Marlin
// answers with Resend unless it follows the last one it took. Behind the program come M400 (wait
// for the moves) and M114, whose position report proves that everything before was executed.
class GcodeStream {
 public:
  // The printer's line count is 0. commands: the program's, without numbers.
  GcodeStream(GcodeChannel& channel, GcodeScript commands, const StreamOptions& options,
              const GcodeAbilities& abilities, Reporter& reporter, PrintControl& control);

  // Returns when everything was executed, or, after a cancel, when the printer has stopped and
  // executed the safe text. Throws Error{kIo}.
  void run();

  bool was_cancelled() const { return cancelling_; }
  bool was_cancelled_at_printer() const { return cancelled_at_printer_; }
  // False once the printer was reset or stopped at once: nothing may be sent to it any more.
  bool may_send() const { return may_send_; }

 private:
  // Lines this far back may still be asked for again; a request for one further back is noise, or
  // the printer was reset.
  static constexpr std::size_t kSlack = 10;
  // Lines on their way at most: Marlin queues four and reads no further.
  static constexpr std::size_t kMostLines = 3;
  // Further answers on their way settle whether a request for a line is still true.
  static constexpr double kSettle_s = 0.05;

  // Ahead of what was given, so far that no printer takes it for a doubled line, nor one garbled
  // digit makes it one that was given: a printer that counts asks for the line that it lacks.
  static constexpr std::size_t kFarAhead = 2345;

  // A line that was sent and not answered. number 0: a question, or one without a number.
  struct Given {
    std::size_t number = 0;
    std::size_t bytes = 0;
    bool asks_temperatures = false;  // M105
    std::size_t question = 0;        // the number that a question came with
  };
  // A line that the printer asked for, and when to give it even if no further ok comes.
  struct Resend {
    std::size_t number = 0;
    double due_s = 0;
  };
  enum class LineCount { kUnknown, kKept, kIgnored };

  // gcode_stream.cpp: lines and answers
  std::string command(std::size_t number) const;
  bool is_behind_program(std::size_t number) const { return end_ > 0 && number > end_; }
  bool is_question(std::size_t number) const;
  std::size_t next_number() const;
  void tell_done(std::size_t next);
  std::size_t exchange(std::size_t number);
  std::optional<std::size_t> hear_answers();
  void give(std::size_t number);
  void open(std::size_t number);
  void ask(const std::string& question);
  bool may_give_another() const;
  void hear_what_came(double quiet_s = 0);
  bool may_pause_before(std::size_t number) const;
  void append_end();
  void handle(const GcodeReply& reply);
  void hear_position(const GcodeReply& reply);
  void send(std::string_view line, bool asks_temperatures = false);
  void show_state();
  [[noreturn]] void fail(const std::string& what, const std::string& hint) const;

  // gcode_answers.cpp: what answers are for, and signs of life
  std::size_t answered_by(const GcodeReply& ok) const;
  void handle_ok(const GcodeReply& reply);
  void handle_resend(std::size_t asked);
  void forget_question();
  bool proves_life(const GcodeReply& reply);
  void handle_busy(const GcodeReply& reply);
  void watch_silence();
  void recover();
  void ask_behind_empty_line();
  void ask_for_proof();
  bool wants_proof() const;
  void ask_temperatures();

  // gcode_doubt.cpp: printers that count no lines
  bool is_in_doubt() const;
  std::optional<std::size_t> settle_doubt();
  bool is_proven_by_oks();
  std::optional<std::size_t> learn_about_empty_lines();
  void hear_what_is_owed();
  template <typename Ask, typename IsSettled>
  std::optional<std::size_t> ask_until(const IsSettled& is_settled, const Ask& ask_once);
  std::optional<std::size_t> learn_line_count();
  void heed_probe(const GcodeReply& ok);
  std::optional<std::size_t> prove_by_position(bool answered);
  [[noreturn]] void fail_in_doubt(bool answered) const;

  // gcode_complaints.cpp: what the machine finds fault with
  void handle_error(const GcodeReply& reply);
  void settle_complaint(bool line_unanswered);
  [[noreturn]] void fail_unanswered() const;
  [[noreturn]] void fail_in_silence() const;
  void handle_unknown(const std::string& word);
  std::string printing_text() const;

  // gcode_requests.cpp: what people and the machine ask for
  void obey_requests();
  [[noreturn]] void stop_at_once();
  void handle_action(const GcodeReply& reply);
  std::size_t pause(std::size_t number);
  void pass_on(int answer);
  bool stands_still() const;
  void close_question();
  void show_pause();
  void stand_still();
  void ask_again_from(std::size_t number);
  std::size_t execute_between(std::size_t number, const std::vector<std::string>& lines);

  // gcode_cancel.cpp: how a cancel ends
  void begin_cancel();
  void hear_while_cancelling(const GcodeReply& reply);
  void press_on_with_cancel();
  [[noreturn]] void halt_in_cancel();
  [[noreturn]] void leave_at_once();
  Fault fault_of_cancel() const;

  GcodeChannel& channel_;
  GcodeScript commands_;
  const StreamOptions& options_;
  const GcodeAbilities abilities_;
  Reporter& reporter_;
  PrintControl& control_;

  bool cancelling_ = false;
  double cancelled_at_s_ = 0;
  bool asks_ = false;          // while cancelling: the printer waits for its user,
  double answer_at_s_ = 0;     // who answers then,
  double answer_every_s_ = 2;  // and again
  bool cancelled_at_printer_ = false;
  bool may_send_ = true;
  bool position_seen_ = false;        // by an M114 behind the program
  bool busy_seen_ = false;            // the printer says when it is busy
  std::string prompt_;                // what the printer asks its user,
  std::vector<std::string> choices_;  // and the answers it offers
  bool question_answered_ = false;    // and perhaps not heard yet
  double answered_at_s_ = 0;
  std::string complaint_;             // an error line that neither an ok nor a Resend followed,
  double complained_at_s_ = 0;        // and since when
  std::vector<std::string> unknown_;  // words of commands that the printer does not know

  bool paused_ = false;     // wanted; begins between two lines
  bool parks_ = false;      // the pause text is executed
  std::string pause_text_;  // why, where no person asked for it
  bool between_ = false;    // in the lines around a pause

  // of the lines that are being exchanged
  std::size_t last_ = 0;  // the one given last,
  std::size_t open_ = 0;  // and the last that is no question
  std::deque<Given> unanswered_;
  std::optional<Resend> resend_;
  bool m105_behind_ = false;        // an M105 was sent behind them
  bool taken_for_granted_ = false;  // only that M105 was answered
  double asked_temperatures_at_s_ = 0;
  double given_at_s_ = 0;
  double alive_at_s_ = 0;
  double attempt_at_s_ = 0;
  double patience_factor_ = 1;
  double busy_at_s_ = 0;
  HeatWatch heat_;
  GcodeTally tally_;
  bool in_doubt_ = false;       // what became of the line, if the printer counts none
  bool was_silent_ = false;     // so that it was asked for a sign of life behind the line
  bool probes_ = false;         // it is being asked whether it counts lines,
  double probed_at_s_ = 0;      // since then
  bool asks_position_ = false;  // M114 was sent to find out
  int positions_owed_ = 0;      // at most, by the M114 that were sent for that
  std::optional<GcodePoint> told_;

  // over several exchanges
  std::size_t end_ = 0;              // M400 behind the program, once that was given
  int position_tries_ = 0;           // M114 behind that
  std::size_t highest_ = 0;          // of all lines ever given
  std::size_t acknowledged_ = 0;     // the highest that an ok was for
  std::size_t careful_until_ = 0;    // the line from which the window may be used again
  int unproven_ = 0;                 // exchanges in a row that were taken for granted
  std::size_t asked_ = 0;            // the line last asked for,
  int asked_times_ = 0;              // and how often
  std::size_t far_back_ = 0;         // a request too far back to be true
  std::size_t asked_behind_ = 0;     // the line behind which M105 was sent last
  std::size_t proven_ = 0;           // the last one behind which M105 was answered
  std::size_t doubted_until_ = 0;    // the line until which an ok may be one too many
  bool temperatures_in_ok_ = false;  // as the printer answers M105
  bool positions_unasked_ = false;   // it reports its position of its own (M154)
  double busy_interval_s_ = 0;       // the longest
  LineCount line_count_ = LineCount::kUnknown;
  bool asked_whether_it_counts_ = false;
  bool answers_empty_ = true;    // an empty line, as Klipper does; so it is taken for
  bool empty_is_known_ = false;  // until it was asked
  std::size_t settled_ = 0;      // the line up to which nothing is in doubt any more
  GcodePlace place_;
  GcodeTrace trace_;  // of the line given last
  int missed_ = 0;    // lines that got lost on their way to a printer that counts none
  int repeated_ = 0;  // how often the line given last was given again to be sure
};

// The commands of a text of the profile.
std::vector<std::string> gcode_lines(const std::string& text);

}  // namespace packmerger
