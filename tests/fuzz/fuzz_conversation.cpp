// The printer says whatever the fuzzer likes, in simulated time: a print ends, done or with an
// Error, in bounded time and with bounded output, and sends nothing but what turns the heaters off
// once the printer has halted. tests/fuzz/seeds/conversation holds what firmwares say, one reply a
// line: its blank says after what time, and that nothing is put before it.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "base/error.h"
#include "firmware_io/gcode/gcode_link.h"
#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_link.h"

namespace {

using namespace packmerger;

// Takes single bytes from the front of the input; 0 once it is at its end.
class Script {
 public:
  explicit Script(std::string_view bytes) : bytes_(bytes) {}

  bool ended() const { return bytes_.empty(); }
  std::uint8_t byte() {
    const std::string_view taken = bytes_.substr(0, 1);
    bytes_.remove_prefix(taken.size());
    return taken.empty() ? 0 : static_cast<std::uint8_t>(taken[0]);
  }
  std::string_view bytes(std::size_t count) {
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(taken.size());
    return taken;
  }
  // Up to and with the line ending.
  std::string_view line() { return bytes(std::min(bytes_.find('\n'), bytes_.size() - 1) + 1); }

 private:
  std::string_view bytes_;
};

// With or without number and checksum; the count of the lines begins anew for it.
bool turns_off(std::string_view line) {
  line = line.substr(0, line.find_first_of("*\n"));
  if (line.starts_with('N')) line.remove_prefix(std::min(line.find(' ') + 1, line.size()));
  return line == "M104 S0" || line == "M155 S0" || line == "M110 N0";
}

class ScriptedPort : public Port {
 public:
  ScriptedPort(Script script, bool gcode, PrintControl& control)
      : script_(script), gcode_(gcode), control_(control) {}

  std::size_t read(char* data, std::size_t size, double timeout_s) override {
    if (said_.empty()) think();
    const double wait_s = due_s_ - now_s_;
    if (said_.empty() || wait_s > timeout_s) {
      now_s_ += std::max(timeout_s, 1e-3);
      watch_the_clock();
      return 0;
    }
    now_s_ = std::max(now_s_, due_s_) + 1e-4;
    const std::size_t count = std::min(size, said_.size());
    std::copy_n(said_.begin(), count, data);
    said_.erase(0, count);
    if (said_.empty() && gcode_ && in_program_ && halts_) dead_ = true;
    return count;
  }

  std::size_t write(std::string_view bytes, double) override {
    if (dead_ && !turns_off(bytes)) std::abort();
    constexpr std::size_t kMost = std::size_t{1} << 20;
    sent_ += bytes.size();
    if (sent_ > kMost) std::abort();
    in_program_ = in_program_ || bytes.substr(0, 3) == "N1 ";
    now_s_ += 1e-4;
    return bytes.size();
  }

  double now_s() const override { return now_s_; }
  std::string name() const override { return "a scripted channel"; }

 private:
  // What comes next, and when.
  void think() {
    halts_ = false;
    if (script_.ended()) return;
    const std::uint8_t control = script_.byte();
    due_s_ = now_s_ + (control >> 4U) * 0.2;
    if (gcode_) {
      constexpr std::array<std::string_view, 8> kWords = {
          "",          "ok\n",    "Resend: ",      "ok T:20 /0\n",
          "echo:busy", "start\n", "X:0 Y:0 Z:0\n", "//action:"};
      const std::string_view word = kWords[control % 8];
      said_ = word;
      if (word.empty() || word.back() != '\n') said_ += script_.line();
      halts_ = said_.rfind("Error:Printer halted", 0) == 0 && said_.back() == '\n';
      return;
    }
    const std::string_view payload = script_.bytes(1 + control % 16);
    said_ = control % 16 == 15 ? std::string(payload) : s3g::packet(payload);
  }

  // A machine that says it stands still is waited for until somebody cancels.
  void watch_the_clock() {
    constexpr double kPatience_s = 5000;
    constexpr double kHang_s = 50000;
    if (script_.ended() && now_s_ > kPatience_s) control_.cancel();
    if (now_s_ > kHang_s) std::abort();
  }

  Script script_;
  bool gcode_;
  PrintControl& control_;
  double now_s_ = 0;
  double due_s_ = 0;
  std::string said_;
  bool halts_ = false;  // what is said is the printer's last word
  bool dead_ = false;
  bool in_program_ = false;
  std::size_t sent_ = 0;
};

void print(std::string_view bytes) {
  Script script(bytes);
  const std::uint8_t way = script.byte();
  const bool gcode = way % 2 == 0;
  PrintControl control;
  ScriptedPort port(script, gcode, control);
  StreamOptions options;
  options.timeout_s = 5;
  options.boot_wait_s = 0;
  options.safe_gcode = "M104 S0\n";
  options.pause_gcode = "G1 Z10\n";
  options.window_bytes = (way & 2U) != 0 ? 96 : 0;
  const PrintListener answers = [&](const PrintReport& report) {
    if (report.state == PrintState::kWaiting) control.answer(0);
  };
  try {
    if (gcode)
      print_gcode(port, "M109 S200\nG28\nG1 X1\nG1 X2\nG1 X3\nM84\n", options, answers, control);
    else
      print_x3g(port, std::string_view("\x86\0\x97\x01\x96\x64\0", 7), options, answers, control);
  } catch (const Error& error) {
    const bool expected = error.fault() == Fault::kIo || error.fault() == Fault::kUnavailable ||
                          error.fault() == Fault::kBusy || error.fault() == Fault::kInterrupted;
    if (!expected || std::string_view(error.what()).empty()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  print({reinterpret_cast<const char*>(data), size});
  return 0;
}
