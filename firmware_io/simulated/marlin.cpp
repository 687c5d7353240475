#include "firmware_io/simulated/marlin.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace packmerger::simulated {

namespace {

constexpr std::size_t kQueue = 4;
constexpr std::size_t kLongestLine = 95;
constexpr std::size_t kReceiveRing = 128;
constexpr std::size_t kPlanner = 16;
constexpr double kBusy_s = 2;
constexpr double kReport_s = 1;

std::string without_comment(std::string line) {
  line.erase(std::min(line.find(';'), line.size()));
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0)
    line.pop_back();
  std::size_t start = 0;
  while (start < line.size() && line[start] == ' ') ++start;
  return line.substr(start);
}

}  // namespace

bool is(const std::string& command, const std::string& word) {
  if (command.compare(0, word.size(), word) != 0) return false;
  return command.size() == word.size() ||
         std::isdigit(static_cast<unsigned char>(command[word.size()])) == 0;
}

void Marlin::receive(std::string_view bytes, double now_s) {
  for (char c : bytes) {
    if (traits_.rx_overflow && received_.size() >= kReceiveRing) continue;
    received_ += c;
    if (c == '\n' || c == '\r') advance(now_s);
  }
}

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
    if (queue_.empty()) return;
    const std::string command = queue_.front();
    queue_.pop_front();
    execute(command, now_s);
  }
}

double Marlin::next_event_s() const {
  if (dead_) return kNever;
  if (!executing_) return next_auto_s_;
  double next = std::min(next_busy_s_, next_auto_s_);
  if (blocked_ == Blocked::kUntil || blocked_ == Blocked::kTool || blocked_ == Blocked::kBed)
    next = std::min(next, blocked_until_s_);
  if (blocked_ == Blocked::kTool || blocked_ == Blocked::kBed)
    next = std::min(next, next_report_s_);
  if (!planned_ends_s_.empty()) next = std::min(next, planned_ends_s_.front());
  return next;
}

void Marlin::read_lines(double now_s) {
  while (!dead_ && queue_.size() + (executing_ ? 1 : 0) < kQueue) {
    const std::size_t end = received_.find_first_of("\r\n");
    if (end == std::string::npos) return;
    std::string line = received_.substr(0, end);
    received_.erase(0, end + 1);
    take_line(std::move(line), now_s);
  }
}

void Marlin::take_line(std::string line, double now_s) {
  line = without_comment(line.substr(0, kLongestLine));
  if (line.empty()) return;  // an empty line gets no ok
  if (line[0] == 'N' && !take_number(line)) return;
  line.erase(std::min(line.rfind('*'), line.size()));
  heed_at_once(line, now_s);
  if (!dead_) queue_.push_back(without_comment(line));
}

// Checks number and checksum and removes the number. False: the line was answered or dropped.
bool Marlin::take_number(std::string& line) {
  const bool sets_count = line.find("M110") != std::string::npos;
  const std::size_t second = sets_count ? line.find('N', 4) : std::string::npos;
  const long number = std::atol(line.c_str() + (second == std::string::npos ? 1 : second + 1));
  if (!sets_count && number != last_number_ + 1) {
    const bool doubled = number == last_number_ || number == last_number_ - 1;
    if (!doubled || traits_.version_1_1) refuse_line("Line Number is not Last Line Number+1");
    return false;
  }
  const std::size_t star = line.rfind('*');
  if (star == std::string::npos) {
    refuse_line("No Checksum with line number");
    return false;
  }
  int sum = 0;
  for (std::size_t i = star; i-- > 0;) sum = (sum ^ line[i]) & 0xFF;
  if (std::atoi(line.c_str() + star + 1) != sum) {
    refuse_line("checksum mismatch");
    return false;
  }
  last_number_ = number;
  std::size_t digits = 1;
  while (digits < line.size() && std::isdigit(static_cast<unsigned char>(line[digits])) != 0)
    ++digits;
  line.erase(0, digits);
  return true;
}

// What was received behind the bad line is thrown away with it.
void Marlin::refuse_line(const std::string& why) {
  received_.clear();
  say("Error:" + why + ", Last Line: " + std::to_string(last_number_));
  say("Resend: " + std::to_string(last_number_ + 1));
  say("ok");
}

// Emergency commands work when they are read, before their turn, but only without a number.
void Marlin::heed_at_once(const std::string& line, double now_s) {
  if (is(line, "M108")) skip_wait_ = executing_;
  if (is(line, "M876") && blocked_ == Blocked::kUser) skip_wait_ = true;
  if (is(line, "M112")) kill("kill() called!");
  if (is(line, "M410")) {
    planned_ends_s_.clear();
    if (blocked_ == Blocked::kUntil) blocked_until_s_ = now_s;
  }
}

void Marlin::kill(const std::string& why) {
  executed_.emplace_back("halt");
  say("Error:Printer halted. " + why);
  dead_ = true;
  queue_.clear();
  received_.clear();
}

void Marlin::fail_heater() {
  say("Error:Thermal Runaway, system stopped! Heater_ID: 0");
  kill("kill() called!");
}

void Marlin::tell_host(const std::string& action) { say("//action:" + action); }

void Marlin::reset() {
  const Pace pace = pace_;
  const MarlinTraits traits = traits_;
  *this = Marlin(pace, traits);
  say("start");
  say("echo: External Reset");
  say("Marlin 2.1.2");
}

void Marlin::block(Blocked why, double now_s, double until_s) {
  executing_ = true;
  blocked_ = why;
  blocked_until_s_ = until_s;
  next_busy_s_ = now_s + pace_.line_s(kBusy_s);
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
      return !skip_wait_;
    case Blocked::kNo:
      break;
  }
  return false;
}

void Marlin::keep_alive(double now_s) {
  const bool heating = blocked_ == Blocked::kTool || blocked_ == Blocked::kBed;
  if (now_s >= next_busy_s_) {
    say(blocked_ == Blocked::kUser ? "echo:busy: paused for user" : "echo:busy: processing");
    next_busy_s_ = now_s + pace_.line_s(kBusy_s);
  }
  if (heating && now_s >= next_report_s_) {
    say(temperatures(now_s) + " W:?");
    next_report_s_ = now_s + kReport_s;
  }
}

void Marlin::report_by_itself(double now_s) {
  if (dead_ || now_s < next_auto_s_) return;
  say(temperatures(now_s));
  next_auto_s_ = now_s + pace_.line_s(report_every_s_);
}

void Marlin::finish() {
  say(reply_);
  reply_ = "ok";
  executing_ = false;
  skip_wait_ = false;
  blocked_ = Blocked::kNo;
}

}  // namespace packmerger::simulated
