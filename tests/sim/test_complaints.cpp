// What becomes of a print whose printer complains: which words end it, and which it goes on after.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_io/gcode/gcode.h"
#include "firmware_io/simulated/marlin.h"
#include "sim/programs.h"
#include "sim/scenario.h"

namespace packmerger::test {
namespace {

using simulated::Marlin;
using simulated::MarlinTraits;
using simulated::Pace;
using ::testing::HasSubstr;

// Answers line 7 in its own way, and others as it should.
std::optional<Error> print_with_answer(const std::string& answer,
                                       std::vector<std::string>& executed) {
  Parrot firmware([&, answered = false](const std::string& line) mutable {
    if (line.rfind("N7 ", 0) == 0 && !std::exchange(answered, true)) return answer;
    return line.find("M114") == std::string::npos ? polite(line) : "X:0 Y:0 Z:0 E:0\nok\n";
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(30)), control);
  executed = port.executed();
  return failure;
}

struct Complaint {
  const char* answer;
  const char* cause;  // empty: the print goes on
};

class Complaints : public ::testing::TestWithParam<Complaint> {};

TEST_P(Complaints, EndThePrintOrDoNot) {
  std::vector<std::string> executed;
  const auto failure = print_with_answer(GetParam().answer, executed);
  EXPECT_EQ(failure.has_value(), *GetParam().cause != '\0');
  if (!failure) return;
  EXPECT_EQ(failure->fault(), Fault::kIo);
  EXPECT_FALSE(failure->hint().empty());
  EXPECT_THAT(failure->what(), HasSubstr(GetParam().cause));
  EXPECT_EQ(executed.back(), "M140 S0") << "the safe text is sent";
}

INSTANTIATE_TEST_SUITE_P(
    All, Complaints,
    ::testing::Values(
        // harmless, because of what follows
        Complaint{"Error:checksum mismatch, Last Line: 6\nResend: 7\nok\n", ""},
        Complaint{"Error:checksum misoatch, Last Line: 6\nResend: 7\nok\n", ""},
        Complaint{"Errxr:chec\xFFsum\nResend: 7\nok\n", ""},
        Complaint{"Error:Probing Failed\nok\n", ""},
        Complaint{"// Klipper state: Ready\nok\n", ""},  // somebody asked it for its STATUS
        Complaint{"Error:default heater of tool 1 is off\nok\n", ""},
        Complaint{"echo:Disabling all heaters\nok\n", ""},  // a message of the program's own
        // not
        Complaint{"Error:Printer halted. kill() called!\n", "kill() called!"},
        Complaint{"Error:!! STOP called because of unhomed error - restart with M999\nok\n",
                  "STOP called"},
        Complaint{"fatal: extruder switch decoupled\nok\n", "fatal: extruder"},
        Complaint{"!! Must home axis first\nok\n", "!! Must home axis first"},
        Complaint{"// Klipper state: Shutdown\n", "Klipper state: Shutdown"},
        Complaint{"// Klipper state: Disconnect\n", "Klipper state: Disconnect"},
        Complaint{"Error:Heating failed, system stopped! Heater_ID: 0\n",
                  "A heater of the printer"},
        // Repetier, which says ok to every line that follows
        Complaint{
            "Error:One heater seems decoupled from thermistor - disabling all for safety!\nok\n",
            "A heater of the printer failed: Error:One heater seems decoupled"},
        Complaint{"Error:Heater decoupled\nok\n", "A heater of the printer"},
        Complaint{"Error:Printer set into dry run mode until restart!\nok\n", "dry run mode"},
        Complaint{"extruder 0: temp sensor defect marked defect\nok\n",
                  "A heater of the printer failed: extruder 0: temp sensor defect"},
        Complaint{"Disabling all heaters due to detected sensor defect.\nok\n",
                  "Disabling all heaters"},
        // RepRapFirmware
        Complaint{"Error: Heater 1 fault: temperature excursion exceeded 15.0C\nok\n",
                  "A heater of the printer failed: Error: Heater 1 fault"},
        Complaint{"Error: Heating fault on heater 1, temperature rising much more slowly than the "
                  "expected 1.5C/sec\nok\n",
                  "A heater of the printer"},
        Complaint{"Error: Temperature reading fault on heater 0: sensor open circuit\nok\n",
                  "A heater of the printer"},
        // Smoothieware, and old Marlin without its stop
        Complaint{"ERROR: MINTEMP or MAXTEMP triggered. Check your temperature sensors!\nok\n",
                  "A heater of the printer"},
        Complaint{"HALT asserted - reset or M999 required\nok\n", "HALT asserted"},
        Complaint{"Error:0\n: Extruder switched off. MAXTEMP triggered !\nok\n",
                  "A heater of the printer failed: : Extruder switched off"}));

// Repetier's own words, beside or instead of "// action:cancel".
TEST(Requests, OfRepetierAreHeard) {
  EXPECT_EQ(read_gcode_reply("RequestPause:").kind, GcodeReplyKind::kPause);
  EXPECT_EQ(read_gcode_reply("RequestContinue:\r").kind, GcodeReplyKind::kResume);
  std::vector<std::string> executed;
  const auto failure = print_with_answer("RequestStop:\n// action:cancel\nok\n", executed);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("cancelled at the printer"));
  EXPECT_THAT(executed, ::testing::Not(::testing::Contains(HasSubstr("G1 X20.5"))));
}

// Klipper names the cause of its shutdown only to the commands that it refuses.
TEST(Shutdown, IsToldWithItsCause) {
  bool down = false;
  Parrot firmware([&](const std::string& line) -> std::string {
    if (line.rfind("N7 ", 0) == 0) down = true;
    if (!down) return polite(line);
    return line[0] == 'N' ? "// Klipper state: Shutdown\n"
                          : "// Printer is shutdown\n!! MCU 'mcu' shutdown: Timer too close\nok\n";
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(30)), control);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("Klipper state: Shutdown"));
  EXPECT_THAT(failure->what(), HasSubstr("!! MCU 'mcu' shutdown: Timer too close"));
}

// A halt whose words are garbled is known by the silence that follows, and told in its words.
TEST(GarbledHalt, IsToldOnceNothingFollows) {
  bool halted = false;
  Parrot firmware([&](const std::string& line) {
    if (line.rfind("N7 ", 0) != 0 && !halted) return polite(line);
    return std::exchange(halted, true) ? std::string() : "Error:Printer halxed. ki#l() caled!\n";
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(30)), control);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("Error:Printer halxed. ki#l() caled!"));
  EXPECT_LT(port.now_s(), 40);
}

// A machine that complains of a line, never says ok to it, and answers everything else. Where
// `counts`, it refuses lines that do not follow; else it answers empty lines too.
class Complainer : public simulated::Firmware {
 public:
  Complainer(bool counts, bool autoreport) : counts_(counts), autoreport_(autoreport) {}

  void receive(std::string_view bytes, double) override {
    for (const char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      answer();
      line_.clear();
    }
  }
  void advance(double) override {}
  double next_event_s() const override { return simulated::kNever; }

 private:
  void answer() {
    const std::string command = command_of(line_);
    const std::size_t number = line_.starts_with("N") ? std::stoul(line_.substr(1)) : 0;
    if (command == "M110 N0") last_ = 0;
    if (counts_ && number > 0 && number != last_ + 1) {
      output_ += "Resend: " + std::to_string(last_ + 1) + "\nok\n";
      return;
    }
    if (number > 0) last_ = number;
    if (!line_.empty()) executed_.push_back(command);
    if (command == "M115" && autoreport_) output_ += "Cap:AUTOREPORT_TEMP:1\n";
    if (command == "M115") output_ += "FIRMWARE_NAME:Complainer\n";
    if (command.starts_with("G1 X")) at_ = "X:" + command.substr(4, command.find(" Y") - 4);
    if (command == "M114") output_ += at_ + " Y:" + std::to_string(last_y_) + " Z:0 E:0\n";
    if (command.starts_with("G1 X")) last_y_ = command[command.find('Y') + 1] - '0';
    if (command.starts_with("G1 X20.5"))
      output_ += "Error:Endstop failure, axis lost\n";
    else if (command == "M105")
      output_ += "ok T:200 /200\n";
    else if (!line_.empty() || !counts_)
      output_ += "ok\n";
  }

  bool counts_;
  bool autoreport_;  // it can: no temperatures are asked for then, and silence has to tell
  std::string line_;
  std::size_t last_ = 0;
  std::string at_ = "X:0";
  int last_y_ = 0;
};

// The ok to what is asked behind the line is none for the line.
TEST(Complaint, IsNotForgottenBecauseAQuestionIsAnswered) {
  for (const bool counts : {true, false})
    for (const bool autoreport : {true, false})
      for (const std::size_t window : {0, 96}) {
        Complainer firmware(counts, autoreport);
        FaultyPort port(firmware);
        PrintControl control;
        StreamOptions options = scenario_options();
        options.window_bytes = window;
        const auto failure = print(port, true, joined(gcode_program(100)), control, {}, options);
        ASSERT_TRUE(failure) << counts << autoreport << window;
        EXPECT_THAT(failure->what(), HasSubstr("Endstop failure, axis lost"));
        EXPECT_EQ(count(port.executed(), "G1 X25.5 Y4 F6000"), 0u);
        EXPECT_THAT(port.executed(), ::testing::Contains("M140 S0"));
      }
}

class Talkative : public Marlin {
 public:
  using Marlin::Marlin;
  void add(const std::string& line) { output_ += line + "\n"; }
};

// A slow line that is complained of and answered all the same, after it was asked what is up.
TEST(Complaint, OfASlowLineIsHarmlessWhereItsOwnOkComes) {
  MarlinTraits traits;
  traits.busy = false;
  Talkative firmware(Pace{1, false}, traits);
  FaultyPort port(firmware);
  port.on_step = [&, said = false](std::size_t) mutable {
    if (port.now_s() > 4 && !std::exchange(said, true)) firmware.add("Error:Probing Failed");
  };
  PrintControl control;
  StreamOptions options = scenario_options();
  options.timeout_s = 30;
  const auto failure = print(port, true, "G1 X1\nG4 S20\nG1 X2\nG1 X3\n", control, {}, options);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_THAT(port.executed(), ::testing::Contains("M105")) << "it was asked";
}

// The error line is read before the request behind it, when the printer has been silent for long.
TEST(Complaint, BehindALongSilenceIsNoReasonToGiveUp) {
  MarlinTraits traits;
  traits.busy = false;
  Marlin firmware(Pace{1, true}, traits);
  FaultyPort port(firmware);
  bool lost = false;
  port.on_send = [&](std::string& bytes) {
    if (bytes.find("G28 W") != std::string::npos && !std::exchange(lost, true)) bytes.clear();
  };
  PrintControl control;
  StreamOptions options = scenario_options();
  options.timeout_s = 5;
  const auto failure = print(port, true, joined(gcode_program(30)), control, {}, options);
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(only(port.executed(), gcode_program(30)), gcode_program(30));
}

MarlinTraits without_filament_change(bool comments) {
  MarlinTraits traits;
  traits.filament_change = false;
  traits.comment_blank = comments;
  return traits;
}

// A filament change that the printer does not know is made by hand: the print stands until then.
TEST(UnknownCommands, WhatAPersonWasToDoIsWaitedFor) {
  for (const bool comments : {true, false}) {
    Marlin firmware(Pace{1, false}, without_filament_change(comments));
    FaultyPort port(firmware);
    PrintControl control;
    std::vector<std::string> program = gcode_program(100);
    program.insert(program.begin() + 50, "M600 U5");
    std::string told;
    std::size_t done = 0;
    StreamOptions options = scenario_options();
    options.pause_gcode = "M117 parked\n";
    options.window_bytes = 96;
    const auto failure = print(
        port, true, joined(program), control,
        [&](const PrintReport& report) {
          if (report.state != PrintState::kPaused) return;
          if (told.empty()) told = report.text;
          done = report.done;
          if (port.now_s() > 3600) control.resume();
        },
        options);
    EXPECT_FALSE(failure) << failure->what();
    EXPECT_THAT(told, HasSubstr("does not know \"M600 U5\""));
    EXPECT_EQ(done, 51u) << "it stands behind that line";
    EXPECT_EQ(count(port.executed(), "M117 parked"), 1u);
    EXPECT_EQ(only(port.executed(), program), program);
  }
}

TEST(UnknownCommands, WhatThePrintCannotDoWithoutEndsIt) {
  for (const char* command : {"G2 X1 Y1 I1", "M109 S200", "T1"}) {
    Parrot firmware([&](const std::string& line) {
      const bool unknown = line.find(command) != std::string::npos;
      return unknown ? "// Unknown command:\"" + std::string(gcode_word(command)) + "\"\nok\n"
                     : polite(line);
    });
    FaultyPort port(firmware);
    PrintControl control;
    const auto failure =
        print(port, true, std::string("G28\nG1 X1\n") + command + "\nG1 X2\n", control);
    ASSERT_TRUE(failure) << command;
    EXPECT_THAT(failure->what(), HasSubstr(command));
    EXPECT_EQ(port.executed().back(), "M140 S0");
  }
}

TEST(UnknownCommands, OthersAreToldOnce) {
  Parrot firmware([&](const std::string& line) {
    for (const char* word : {"M73", "M204", "T0"})
      if (line.find(word) != std::string::npos)
        return "// Unknown command:\"" + std::string(word) + "\"\nok\n";
    return line.find("M114") == std::string::npos ? polite(line) : "X:0 Y:0 Z:0 E:0\nok\n";
  });
  FaultyPort port(firmware);
  PrintControl control;
  std::string told;
  const auto failure = print(port, true, "M73 P0\nT0\nM204 S1\nM73 P9\nG1 X2\nG1 X3\n", control,
                             [&](const PrintReport& report) {
                               if (report.state == PrintState::kPrinting) told = report.text;
                             });
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_EQ(told, "the printer passes over what it does not know: M73, T0, M204");
}

TEST(Complaint, WhatAPrinterSaysSteersNoTerminal) {
  std::vector<std::string> executed;
  const auto failure = print_with_answer(
      "Error:Printer halted.\x1B[2J\x1B]0;x\x07 \xE2\x80\xAE\xFF kill() called!\n", executed);
  ASSERT_TRUE(failure);
  EXPECT_THAT(failure->what(), HasSubstr("Printer halted.?[2J?]0;x? ?? kill() called!"));
}

// A flipped bit in the N makes line 1 a line without a number, which gets an ok all the same.
TEST(Complaint, ALineOneThatLostItsNumberIsNoReset) {
  bool seen = false;
  bool has_one = false;
  Parrot firmware([&](const std::string& line) -> std::string {
    if (line.rfind("N1 ", 0) == 0) has_one = std::exchange(seen, true);
    const bool numbered = line.rfind("N", 0) == 0 && line.find("M110") == std::string::npos;
    if (numbered && seen && !has_one && line.rfind("N1 ", 0) != 0)
      return "Error:Line Number is not Last Line Number+1, Last Line: 0\nResend: 1\nok\n";
    return line.find("M114") == std::string::npos ? polite(line) : "X:0 Y:0 Z:0 E:0\nok\n";
  });
  FaultyPort port(firmware);
  PrintControl control;
  const auto failure = print(port, true, joined(gcode_program(30)), control);
  EXPECT_FALSE(failure) << failure->what();
}

}  // namespace
}  // namespace packmerger::test
