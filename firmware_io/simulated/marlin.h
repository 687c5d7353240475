// The firmware of a simulated RepRap (Marlin), as simulator.h describes it.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

#include "firmware_io/simulated/firmware.h"

namespace packmerger::simulated {

struct MarlinTraits {
  bool version_1_1 = false;  // a doubled line is answered with Resend; 2.1 says nothing
  bool prompts = true;       // asks its user through the host
  bool autoreport = true;    // temperatures of its own (M155)
  bool rx_overflow = false;  // what does not fit the 128 bytes of its receive ring is lost
};

// Whether a command's first word is `word`: "G1 X2" is "G1", "G10" is not.
bool is(const std::string& command, const std::string& word);

class Marlin : public Firmware {
 public:
  explicit Marlin(Pace pace, MarlinTraits traits = {}) : pace_(pace), traits_(traits) {}

  void receive(std::string_view bytes, double now_s) override;
  void advance(double now_s) override;
  double next_event_s() const override;

  // What the machine may do in the middle of a print.
  void reset();
  void fail_heater();
  void tell_host(const std::string& action);  // "pause", "resume", "cancel": pressed at its panel

 private:
  enum class Blocked { kNo, kUntil, kPlannerFull, kPlannerEmpty, kTool, kBed, kUser };

  void read_lines(double now_s);
  void take_line(std::string line, double now_s);
  bool take_number(std::string& line);
  void refuse_line(const std::string& why);
  void heed_at_once(const std::string& line, double now_s);
  void say(const std::string& line) { output_ += line + "\n"; }

  void execute(const std::string& command, double now_s);
  bool execute_move(const std::string& command, double now_s);
  void execute_report(const std::string& command, double now_s);
  void report_by_itself(double now_s);
  void execute_pause(const std::string& command, double now_s);
  void block(Blocked why, double now_s, double until_s = kNever);
  bool still_blocked(double now_s);
  void keep_alive(double now_s);
  void finish();
  void plan(double seconds, double now_s);
  void kill(const std::string& why);
  std::string temperatures(double now_s) const;

  Pace pace_;
  MarlinTraits traits_;
  bool dead_ = false;

  // the line
  std::string received_;
  std::deque<std::string> queue_;
  long last_number_ = 0;

  // the command being executed
  Blocked blocked_ = Blocked::kNo;
  bool executing_ = false;
  std::string reply_ = "ok";
  double blocked_until_s_ = 0;
  double next_busy_s_ = 0;
  double next_report_s_ = 0;
  bool skip_wait_ = false;     // M108 came
  double report_every_s_ = 0;  // M155
  double next_auto_s_ = kNever;

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
