// The firmware of a simulated RepRap (Marlin), as simulator.h describes it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "firmware_io/simulated/firmware.h"
#include "firmware_io/simulated/traits.h"

namespace packmerger::simulated {

class Marlin : public Firmware {
 public:
  explicit Marlin(Pace pace, MarlinTraits traits = {}) : pace_(pace), traits_(std::move(traits)) {
    if (traits_.reports_unasked) report_every(1, 0);
    if (traits_.positions_unasked) positions_every_s_ = 1, next_position_s_ = 0;
    if (traits_.chatters) next_chatter_s_ = 0;
  }

  void receive(std::string_view bytes, double now_s) override;
  void advance(double now_s) override;
  double next_event_s() const override;

  // What the machine may do in the middle of a print.
  void reset();
  void fail_heater();
  void run_out();  // of filament: it changes it by itself, as by an M600 that nobody sent
  void tell_host(const std::string& action);  // "pause", "resume", "cancel": pressed at its panel

 private:
  enum class Blocked { kNo, kUntil, kPlannerFull, kPlannerEmpty, kTool, kBed, kUser };

  struct Queued {
    std::string command;
    std::optional<long> number;
  };

  static constexpr std::size_t kQueue = 4;
  static constexpr double kIdle_s = 1;

  static bool is(const std::string& command, const std::string& word);

  void parse_emergency(char c, double now_s);
  void read_lines(double now_s);
  void take_line(std::string line, double now_s);
  bool take_number(std::string& line);
  void refuse_line(const std::string& why);
  void ask_for(long number);
  void heed_answer(const std::string& line);
  void heed_at_once(const std::string& line, double now_s);
  void say(const std::string& line) { output_ += line + "\n"; }

  void execute(const std::string& command, double now_s);
  void count_line(double now_s);
  bool execute_move(const std::string& command, double now_s);
  void execute_report(const std::string& command, double now_s);
  void execute_pause(const std::string& command, double now_s);
  void change_filament(double now_s);
  void ask(const std::string& question, const std::vector<std::string>& choices);
  void say_unknown(const std::string& command);
  void block(Blocked why, double now_s, double until_s = kNever);
  bool still_blocked(double now_s);
  bool ask_again();
  void keep_alive(double now_s);
  void report_idle(double now_s);
  void report_by_itself(double now_s);
  void report_every(double seconds, double now_s);
  void finish();
  std::string advanced_ok() const;
  void plan(double seconds, double now_s);
  void kill(const std::string& why);
  std::string temperatures(double now_s) const;
  std::string position() const;
  double next_report_by_itself_s() const {
    return std::min({next_auto_s_, next_position_s_, next_chatter_s_});
  }

  Pace pace_;
  MarlinTraits traits_;
  bool dead_ = false;
  bool stopped_ = false;
  bool refuses_move_ = false;
  std::size_t lines_ = 0;  // executed since it booted

  // the line
  std::string received_;
  std::string emergency_line_;
  std::deque<Queued> queue_;
  std::string injected_;  // a command of its own, which goes first and gets no ok
  long last_number_ = 0;
  double next_idle_s_ = 0;

  // the command being executed
  Blocked blocked_ = Blocked::kNo;
  bool executing_ = false;
  std::optional<long> number_;  // of its line
  bool is_injected_ = false;
  std::string reply_ = "ok";
  double blocked_until_s_ = 0;
  double next_busy_s_ = 0;
  double next_report_s_ = 0;
  bool skip_wait_ = false;   // M108 came
  bool asks_again_ = false;  // behind the question that it asks now
  bool asks_to_purge_ = false;
  double report_every_s_ = 0;  // M155
  double next_auto_s_ = kNever;
  bool says_position_ = false;    // before the ok, as behind homing
  double positions_every_s_ = 0;  // M154
  double next_position_s_ = kNever;
  double next_chatter_s_ = kNever;
  double busy_every_s_ = 2;  // M113
  std::size_t oks_ = 0;

  // the machine
  std::deque<double> planned_ends_s_;
  std::array<double, 4> position_{};  // x, y, z, e
  bool relative_ = false;
  bool relative_e_ = false;
  double feed_mm_s_ = 20;
  Heater tool_{4};
  Heater bed_{1};
};

}  // namespace packmerger::simulated
