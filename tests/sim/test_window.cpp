// What is on its way to a printer and not yet acknowledged, counted on the wire.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <deque>
#include <numeric>

#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::Pace;

// A clean channel that weighs, in the order of time, each line written against each "ok" read.
class WeighingPort : public Port {
 public:
  explicit WeighingPort(FaultyPort& port) : port_(port) {}

  std::size_t read(char* data, std::size_t size, double timeout_s) override {
    const std::size_t count = port_.read(data, size, timeout_s);
    for (const char c : std::string_view(data, count)) {
      if (c != '\n') {
        heard_ += c;
        continue;
      }
      if (heard_.starts_with("ok") && !heard_.starts_with("ok T") && !unanswered_.empty())
        unanswered_.pop_front();
      heard_.clear();
    }
    return count;
  }

  std::size_t write(std::string_view bytes, double timeout_s) override {
    const std::size_t count = port_.write(bytes, timeout_s);
    for (const char c : bytes.substr(0, count)) {
      said_ += c;
      if (c != '\n') continue;
      // An empty line gets no answer; M105, now and then, has room in the ring beside the window.
      if (said_ != "\n" && said_.find(" M105*") == std::string::npos) weigh();
      said_.clear();
    }
    return count;
  }

  double now_s() const override { return port_.now_s(); }
  std::string name() const override { return port_.name(); }

  // Of lines of the program; what is asked beside it is not weighed.
  std::size_t most_bytes = 0;
  std::size_t most_lines = 0;

 private:
  void weigh() {
    unanswered_.push_back(said_.size());
    if (unanswered_.size() == 1) return;  // one line may be as long as it likes
    most_lines = std::max(most_lines, unanswered_.size());
    most_bytes = std::max(most_bytes,
                          std::accumulate(unanswered_.begin(), unanswered_.end(), std::size_t{0}));
  }

  FaultyPort& port_;
  std::string heard_;
  std::string said_;
  std::deque<std::size_t> unanswered_;
};

// Heating, homing, and moves of many lengths.
std::vector<std::string> uneven_program() {
  std::vector<std::string> program{"M109 S200", "G28"};
  const int moves = *rc::gen::inRange(20, 200);
  for (int i = 0; i < moves; ++i)
    program.push_back("G1 X" + std::to_string(i) + "." +
                      std::string(*rc::gen::inRange<std::size_t>(1, 50), '1'));
  return program;
}

WeighingPort weighed(const std::vector<std::string>& program, std::size_t window_bytes) {
  Marlin firmware(Pace{1, false});
  FaultyPort channel(firmware);
  WeighingPort port(channel);
  StreamOptions options = scenario_options();
  options.window_bytes = window_bytes;
  PrintControl control;
  print_gcode(port, joined(program), options, {}, control);
  EXPECT_EQ(only(channel.executed(), program), program);
  return port;
}

TEST(Window, UnacknowledgedBytesStayWithinIt) {
  EXPECT_TRUE(rc::check([] {
    const std::vector<std::string> program = uneven_program();
    const auto window_bytes = *rc::gen::inRange<std::size_t>(1, 97);
    RC_ASSERT(weighed(program, window_bytes).most_bytes <= window_bytes);
  }));
}

TEST(Window, WithoutOneASingleLineIsOnItsWay) {
  EXPECT_TRUE(
      rc::check([] { RC_ASSERT(weighed(uneven_program(), 0).most_lines == std::size_t{0}); }));
}

TEST(Window, ShortLinesShareIt) { EXPECT_GE(weighed(gcode_program(200), 96).most_lines, 3u); }

}  // namespace
}  // namespace packmerger::test
