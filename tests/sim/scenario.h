// What the tests of whole prints in simulated time share.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "firmware_io/gcode/gcode_link.h"
#include "firmware_io/s3g/s3g_link.h"
#include "sim/faulty_port.h"

namespace packmerger::test {

inline StreamOptions scenario_options() {
  StreamOptions options;
  options.boot_wait_s = 0.1;
  options.safe_gcode = "M104 S0\nM140 S0\n";
  options.build_name = "scenario";
  return options;
}

// What ended the print before its end.
inline std::optional<Error> print(FaultyPort& port, bool gcode, const std::string& program,
                                  PrintControl& control, const PrintListener& listener = {},
                                  const StreamOptions& options = scenario_options()) {
  try {
    if (gcode)
      print_gcode(port, program, options, listener, control);
    else
      print_x3g(port, program, options, listener, control);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

inline std::size_t count(const std::vector<std::string>& list, const std::string& text) {
  return static_cast<std::size_t>(std::count(list.begin(), list.end(), text));
}

// What the machine says in the tenth of a second after the chunk with this number gets lost; what
// it tells of its own goes on behind that.
inline void lose_answers_behind(FaultyPort& port, std::size_t chunk) {
  port.on_step = [&port, chunk, since_s = simulated::kNever](std::size_t written) mutable {
    if (written == chunk) since_s = std::min(since_s, port.now_s());
    port.lose_answers = written == chunk && port.now_s() < since_s + 0.1;
  };
}

// "G1 X1" of "N7 G1 X1*83".
inline std::string command_of(const std::string& line) {
  const std::size_t begin = line.starts_with("N") ? line.find(' ') + 1 : 0;
  return line.substr(begin, line.rfind('*') - begin);
}

// Those of `executed` that belong to the program.
inline std::vector<std::string> only(const std::vector<std::string>& executed,
                                     const std::vector<std::string>& program) {
  const std::unordered_set<std::string> known(program.begin(), program.end());
  std::vector<std::string> kept;
  for (const std::string& command : executed)
    if (known.count(command) > 0) kept.push_back(command);
  return kept;
}

// A firmware of a few words, for what the simulated ones never do.
class Parrot : public simulated::Firmware {
 public:
  explicit Parrot(std::function<std::string(const std::string&)> answer)
      : answer_(std::move(answer)) {}
  void receive(std::string_view bytes, double) override {
    for (char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      if (!line_.empty()) {
        output_ += answer_(line_);
        executed_.push_back(line_);
      }
      line_.clear();
    }
  }
  void advance(double) override {}
  double next_event_s() const override { return simulated::kNever; }

 private:
  std::function<std::string(const std::string&)> answer_;
  std::string line_;
};

inline std::string polite(const std::string& line) {
  return line == "M115" ? "FIRMWARE_NAME:Parrot\nok\n" : "ok\n";
}

}  // namespace packmerger::test
