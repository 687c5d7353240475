#include "firmware_io/simulated/marlin.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>

namespace packmerger::simulated {

namespace {

constexpr std::size_t kPlanner = 16;
constexpr double kReport_s = 1;
constexpr double kChatter_s = 1;

}  // namespace

void Marlin::advance(double now_s) {
  report_by_itself(now_s);
  while (!dead_) {
    while (!planned_ends_s_.empty() && planned_ends_s_.front() <= now_s)
      planned_ends_s_.pop_front();
    read_lines(now_s);
    if (executing_) {
      keep_alive(now_s);
      if (still_blocked(now_s)) return;
      finish();
      continue;
    }
    if (!injected_.empty()) {
      is_injected_ = true;
      execute(std::exchange(injected_, {}), now_s);
      continue;
    }
    if (queue_.empty()) return report_idle(now_s);
    const Queued next = queue_.front();
    queue_.pop_front();
    number_ = next.number;
    execute(next.command, now_s);
  }
}

// What it says of itself while it has nothing to do.
void Marlin::report_idle(double now_s) {
  if (traits_.idle_wait && now_s >= next_idle_s_) {
    say("wait");
    next_idle_s_ = now_s + pace_.line_s(kIdle_s);
  }
}

void Marlin::report_by_itself(double now_s) {
  if (dead_) return;
  if (now_s >= next_auto_s_) {
    say(temperatures(now_s));
    next_auto_s_ = now_s + pace_.line_s(report_every_s_);
  }
  if (now_s >= next_position_s_) {
    say(position());
    next_position_s_ = now_s + pace_.line_s(positions_every_s_);
  }
  if (now_s >= next_chatter_s_) {
    say("echo:Active Extruder: 0");
    say("// probe accuracy: 0.01");
    next_chatter_s_ = now_s + pace_.line_s(kChatter_s);
  }
}

void Marlin::report_every(double seconds, double now_s) {
  report_every_s_ = seconds;
  next_auto_s_ = seconds > 0 ? now_s + pace_.line_s(seconds) : kNever;
}

double Marlin::next_event_s() const {
  if (dead_) return kNever;
  const double report_s = next_report_by_itself_s();
  if (!executing_) return traits_.idle_wait ? std::min(report_s, next_idle_s_) : report_s;
  double next = std::min(next_busy_s_, report_s);
  if (blocked_ == Blocked::kUntil || blocked_ == Blocked::kTool || blocked_ == Blocked::kBed)
    next = std::min(next, blocked_until_s_);
  if (blocked_ == Blocked::kTool || blocked_ == Blocked::kBed)
    next = std::min(next, next_report_s_);
  if (!planned_ends_s_.empty()) next = std::min(next, planned_ends_s_.front());
  return next;
}

void Marlin::kill(const std::string& why) {
  executed_.emplace_back("halt");
  say("Error:Printer halted. " + why);
  if (traits_.prompts) say("//action:poweroff");
  dead_ = true;
  queue_.clear();
  received_.clear();
}

void Marlin::fail_heater() {
  say("Error:Thermal Runaway, system stopped! Heater_ID: 0");
  kill("kill() called!");
}

// What its traits have it do with a certain line.
void Marlin::count_line(double now_s) {
  ++lines_;
  if (lines_ == traits_.stops_at) {
    say("Error:!! STOP called because of unhomed error - restart with M999");
    stopped_ = true;
    tool_.set_target(0, now_s);
    bed_.set_target(0, now_s);
  }
  if (lines_ == traits_.fatal_at)
    say("fatal: Heater/sensor error - Printer stopped and heaters disabled due to this error. Fix "
        "error and restart with M999.");
  if (lines_ == traits_.refuses_at) refuses_move_ = true;
}

void Marlin::run_out() {
  ask("FilamentRunout T0", {});
  tell_host("paused filament_runout 0");
  injected_ = "M600";
}

void Marlin::tell_host(const std::string& action) {
  say((traits_.comment_blank ? "// action:" : "//action:") + action);
}

void Marlin::reset() {
  std::vector<std::string> executed = take_executed();
  *this = Marlin(pace_, traits_);
  executed_ = std::move(executed);
  say("start");
  say("echo: External Reset");
  say("Marlin " + traits_.version);
  say("echo: Last Updated: 2020-12-02 | Author: (none, default config)");
  say("echo:  G21    ; Units in mm (mm)");
  say("echo:  M92 X80.00 Y80.00 Z4000.00 E500.00");
  if (traits_.prompts) say("//action:notification Marlin Ready.\r");
}

void Marlin::block(Blocked why, double now_s, double until_s) {
  executing_ = true;
  blocked_ = why;
  blocked_until_s_ = until_s;
  next_busy_s_ = now_s + pace_.line_s(busy_every_s_);
  next_report_s_ = now_s + kReport_s;
}

bool Marlin::still_blocked(double now_s) {
  switch (blocked_) {
    case Blocked::kUntil:
      return now_s < blocked_until_s_;
    case Blocked::kPlannerFull:
      return planned_ends_s_.size() > kPlanner;
    case Blocked::kPlannerEmpty:
      return !planned_ends_s_.empty();
    case Blocked::kTool:
    case Blocked::kBed:
      return now_s < blocked_until_s_ && !skip_wait_;
    case Blocked::kUser:
      return !skip_wait_ || ask_again();
    case Blocked::kNo:
      break;
  }
  return false;
}

// True where a filament change has another question.
bool Marlin::ask_again() {
  asks_to_purge_ = false;
  if (!std::exchange(asks_again_, false)) return false;
  skip_wait_ = false;
  asks_to_purge_ = true;
  ask("Paused", {"Purge More", "Continue"});
  return true;
}

void Marlin::keep_alive(double now_s) {
  const bool heating = blocked_ == Blocked::kTool || blocked_ == Blocked::kBed;
  if (now_s >= next_busy_s_) {
    if (traits_.busy && !(heating && traits_.heats_quietly))
      say(blocked_ == Blocked::kUser ? "echo:busy: paused for user" : "echo:busy: processing");
    next_busy_s_ = now_s + pace_.line_s(busy_every_s_);
  }
  if (heating && now_s >= next_report_s_) {
    say(temperatures(now_s) + (traits_.heats_quietly ? "" : " W:?"));
    next_report_s_ = now_s + kReport_s;
  }
}

void Marlin::finish() {
  if (std::exchange(says_position_, false)) say(position());
  if (std::exchange(is_injected_, false)) {
    tell_host("resumed");
  } else {
    say(reply_ == "ok" && traits_.advanced_ok ? advanced_ok() : reply_);
    constexpr std::size_t kDoubled = 5;
    if (traits_.doubled_ok && ++oks_ % kDoubled == 0) say(reply_);
  }
  reply_ = "ok";
  executing_ = false;
  skip_wait_ = false;
  blocked_ = Blocked::kNo;
}

// The line's number, free places among the planned moves, free places for commands.
std::string Marlin::advanced_ok() const {
  const std::string number = number_ ? " N" + std::to_string(*number_) : "";
  const std::size_t moves = std::min(planned_ends_s_.size(), kPlanner - 1);
  return "ok" + number + " P" + std::to_string(kPlanner - 1 - moves) + " B" +
         std::to_string(kQueue - queue_.size());
}

}  // namespace packmerger::simulated
