#include "sim/faulty_port.h"

#include <algorithm>
#include <stdexcept>

namespace packmerger::test {

std::string FaultyPort::damaged(std::string bytes) {
  if (happens(rates_.drop_byte)) {
    ++faults_;
    bytes.erase(random_.below(bytes.size()), 1);
  } else if (happens(rates_.flip)) {
    ++faults_;
    char& byte = bytes[random_.below(bytes.size())];
    byte = static_cast<char>(byte ^ (1 << random_.below(8)));
  } else if (happens(rates_.drop_chunk)) {
    ++faults_;
    bytes.clear();
  } else if (happens(rates_.duplicate)) {
    ++faults_;
    bytes += bytes;
  }
  return bytes;
}

// Bytes never overtake each other.
void FaultyPort::pass(std::string bytes, std::deque<Chunk>& queue) {
  double due_s = now_s_;
  if (happens(rates_.delay)) {
    ++faults_;
    due_s += random_.unit() * rates_.longest_delay_s;
  }
  if (!queue.empty()) due_s = std::max(due_s, queue.back().due_s);
  bytes = damaged(std::move(bytes));
  if (!bytes.empty()) queue.push_back({due_s, std::move(bytes)});
}

void FaultyPort::step() {
  constexpr double kDay_s = 86400;
  if (now_s_ > kDay_s)
    throw std::runtime_error("The link has hung for a day; it sent last: " +
                             sent.substr(sent.size() - std::min<std::size_t>(sent.size(), 200)));
  if (on_step) on_step(written_);
  if (unplugged_ || written_ >= end_after)
    throw Error(Fault::kIo, "The channel has ended", "Plug it in.");
  deliver();
  std::string output = firmware_.take_output();
  if (lose_answers) return;
  if (on_answer) on_answer(output);
  if (!output.empty()) pass(std::move(output), to_host_);
}

void FaultyPort::deliver() {
  while (!to_printer_.empty() && to_printer_.front().due_s <= now_s_) {
    firmware_.receive(to_printer_.front().bytes, now_s_);
    to_printer_.pop_front();
  }
  firmware_.advance(now_s_);
}

std::size_t FaultyPort::read(char* data, std::size_t size, double timeout_s) {
  const double end_s = now_s_ + timeout_s;
  while (true) {
    step();
    if (!to_host_.empty() && to_host_.front().due_s <= now_s_) break;
    double next_s = std::min(end_s, firmware_.next_event_s());
    if (!to_printer_.empty()) next_s = std::min(next_s, to_printer_.front().due_s);
    if (!to_host_.empty()) next_s = std::min(next_s, to_host_.front().due_s);
    if (now_s_ >= end_s) return 0;
    now_s_ = std::max(next_s, now_s_ + 1e-6);
  }
  std::string& bytes = to_host_.front().bytes;
  std::size_t count = std::min(size, bytes.size());
  if (happens(rates_.split)) count = 1 + random_.below(count);
  std::copy_n(bytes.begin(), count, data);
  bytes.erase(0, count);
  if (bytes.empty()) to_host_.pop_front();
  return count;
}

std::size_t FaultyPort::write(std::string_view bytes, double) {
  step();
  ++written_;
  unplugged_ = unplugged_ || happens(rates_.unplug);
  if (!had_mishap_ && happens(rates_.mishap)) {
    had_mishap_ = true;
    on_mishap();
  }
  sent += bytes;
  std::string passing(bytes);
  if (on_send) on_send(passing);
  if (!passing.empty()) pass(std::move(passing), to_printer_);
  step();
  return bytes.size();
}

void FaultyPort::leave_alone(double seconds) {
  const double end_s = now_s_ + seconds;
  while (now_s_ < end_s) {
    deliver();
    firmware_.take_output();
    double next_s = std::min(end_s, firmware_.next_event_s());
    if (!to_printer_.empty()) next_s = std::min(next_s, to_printer_.front().due_s);
    now_s_ = std::max(next_s, now_s_ + 1e-3);
  }
}

const std::vector<std::string>& FaultyPort::executed() {
  for (std::string& command : firmware_.take_executed()) executed_.push_back(std::move(command));
  return executed_;
}

}  // namespace packmerger::test
