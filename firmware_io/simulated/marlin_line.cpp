// The simulated Marlin's side of the line: what it makes of the bytes that it receives.
#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "firmware_io/simulated/marlin.h"

namespace packmerger::simulated {

namespace {

constexpr std::size_t kLongestLine = 95;
constexpr std::size_t kReceiveRing = 128;

std::string without_comment(std::string line) {
  line.erase(std::min(line.find(';'), line.size()));
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0)
    line.pop_back();
  std::size_t start = 0;
  while (start < line.size() && line[start] == ' ') ++start;
  return line.substr(start);
}

// Where the command begins: behind "N12 " or "N-1 ".
std::size_t behind_number(const std::string& line) {
  if (line.empty() || line[0] != 'N') return 0;
  const std::size_t end = line.find_first_not_of("-0123456789 ", 1);
  return std::min(end, line.size());
}

bool has_right_sum(const std::string& line) {
  const std::size_t star = line.rfind('*');
  if (star == std::string::npos) return false;
  int sum = 0;
  for (std::size_t i = star; i-- > 0;) sum = (sum ^ line[i]) & 0xFF;
  return std::atoi(line.c_str() + star + 1) == sum;
}

}  // namespace

bool Marlin::is(const std::string& command, const std::string& word) {
  if (command.compare(0, word.size(), word) != 0) return false;
  return command.size() == word.size() ||
         std::isdigit(static_cast<unsigned char>(command[word.size()])) == 0;
}

void Marlin::receive(std::string_view bytes, double now_s) {
  for (char c : bytes) {
    if (dead_) return;
    if (traits_.emergency_parser) parse_emergency(c, now_s);
    if (traits_.rx_overflow && received_.size() >= kReceiveRing) continue;
    received_ += c;
    if (c == '\n' || c == '\r') advance(now_s);
  }
}

// Sees every byte as it comes in, whatever waits, and looks neither at number nor checksum.
void Marlin::parse_emergency(char c, double now_s) {
  if (c != '\n' && c != '\r') {
    if (emergency_line_.size() < kLongestLine) emergency_line_ += c;
    return;
  }
  const std::string line = without_comment(std::exchange(emergency_line_, {}));
  heed_at_once(line.substr(behind_number(line)), now_s);
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
  if (line.empty() && (traits_.counts_lines || traits_.checks_sums)) return;  // gets no ok
  const bool numbered = traits_.counts_lines && line[0] == 'N';
  if (numbered && !take_number(line)) return;
  if (!numbered && traits_.refuses_raw && last_number_ > 0 && !is(line, "M112"))
    return refuse_line("Missing checksum");
  const bool checks_sum = !traits_.counts_lines && traits_.checks_sums && line[0] == 'N';
  if (checks_sum && !has_right_sum(line)) {
    if (!traits_.drops_garbled) ask_for(std::atol(line.c_str() + 1));
    return;
  }
  line.erase(std::min(line.rfind('*'), line.size()));
  if (!traits_.counts_lines) line.erase(0, behind_number(line));
  // Without an emergency parser a command acts before its turn when its line is read, and only
  // where the line begins with it.
  if (!traits_.emergency_parser && !numbered && !is(line, "M876")) heed_at_once(line, now_s);
  if (dead_) return;
  next_idle_s_ = now_s + pace_.line_s(kIdle_s);
  queue_.push_back({without_comment(line), numbered ? std::optional(last_number_) : std::nullopt});
}

// Checks number and checksum and removes the number. False: the line was answered or dropped.
bool Marlin::take_number(std::string& line) {
  const bool sets_count = traits_.m110_anywhere ? line.find("M110") != std::string::npos
                                                : is(line.substr(behind_number(line)), "M110");
  const std::size_t second = sets_count ? line.find('N', 4) : std::string::npos;
  const long number = std::atol(line.c_str() + (second == std::string::npos ? 1 : second + 1));
  if (!sets_count && number != last_number_ + 1) {
    const bool doubled = number == last_number_ || number == last_number_ - 1;
    if (!doubled || !traits_.doubled_silent) refuse_line("Line Number is not Last Line Number+1");
    return false;
  }
  const std::size_t star = line.rfind('*');
  if (star == std::string::npos) {
    refuse_line("No Checksum with line number");
    return false;
  }
  if (!has_right_sum(line)) {
    refuse_line("checksum mismatch");
    return false;
  }
  last_number_ = number;
  line.erase(0, behind_number(line));
  return true;
}

// What was received behind the bad line is thrown away with it.
void Marlin::refuse_line(const std::string& why) {
  received_.clear();
  if (traits_.resend_error) say("Error:" + why + ", Last Line: " + std::to_string(last_number_));
  ask_for(last_number_ + 1);
}

void Marlin::ask_for(long number) {
  say((traits_.resend_short ? "rs N" : "Resend: ") + std::to_string(number));
  if (traits_.resend_ok) say("ok");
}

// Asked whether to purge more, 0 does so and it asks again.
void Marlin::heed_answer(const std::string& line) {
  skip_wait_ = true;
  asks_again_ = asks_again_ || (asks_to_purge_ && line.find("S0") != std::string::npos);
}

void Marlin::heed_at_once(const std::string& line, double now_s) {
  // Whether to purge more, Marlin's M108 does not answer.
  if (is(line, "M108")) skip_wait_ = executing_ && !asks_to_purge_;
  if (is(line, "M876") && blocked_ == Blocked::kUser) heed_answer(line);
  if (is(line, "M112")) kill("kill() called!");
  if (is(line, "M410")) {
    planned_ends_s_.clear();
    if (blocked_ == Blocked::kUntil) blocked_until_s_ = now_s;
  }
}

}  // namespace packmerger::simulated
