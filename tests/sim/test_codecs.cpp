// The codecs against vectors that real firmware and gpx produced.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/error.h"
#include "firmware_io/gcode/gcode.h"
#include "firmware_io/gcode/gcode_link.h"
#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_actions.h"
#include "firmware_io/s3g/s3g_link.h"
#include "sim/programs.h"

namespace packmerger::test {
namespace {

using ::testing::HasSubstr;

template <typename Check>
std::string refusal(const Check& check) {
  try {
    check();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_FALSE(error.hint().empty());
    return error.what();
  }
  ADD_FAILURE() << "was not refused";
  return "";
}

TEST(GcodeCodec, NumbersAndSums) {
  EXPECT_EQ(numbered_gcode(0, "M110 N0"), "N0 M110 N0*125\n");
  EXPECT_EQ(numbered_gcode(1, "G28"), "N1 G28*18\n");
  EXPECT_EQ(numbered_gcode(2, "G1 X10 F3000"), "N2 G1 X10 F3000*54\n");
}

TEST(GcodeCodec, LeavesCommentsAndEmptyLinesOut) {
  std::vector<GcodeCommand> commands;
  for (const GcodeCommand& command :
       gcode_commands("; \xC3\xA9\n\n  G28 ; home\r\nM117 a*b\n\t;\nM84"))
    commands.push_back(command);
  ASSERT_EQ(commands.size(), 3u);
  EXPECT_EQ(commands[0].text, "G28");
  EXPECT_EQ(commands[0].line, 3u);
  EXPECT_EQ(commands[1].text, "M117 a*b");
  EXPECT_EQ(commands[2].text, "M84");
}

TEST(GcodeCodec, RefusesWhatTheWireCannotCarry) {
  EXPECT_NO_THROW(check_gcode("M117 " + std::string(76, 'a')));
  EXPECT_THAT(refusal([] { check_gcode("G28\nM117 " + std::string(77, 'a')); }),
              HasSubstr("Line 2 of the program is too long"));
  EXPECT_THAT(refusal([] { check_gcode("M117 \xC3\xA9"); }), HasSubstr("ASCII"));
  EXPECT_THAT(refusal([] { check_gcode(std::string("G28\0", 4)); }), HasSubstr("ASCII"));
  EXPECT_THAT(refusal([] { check_gcode("N1 G28*18"); }), HasSubstr("numbered"));
  EXPECT_THAT(refusal([] { check_gcode("M117 M1100"); }), HasSubstr("M110"));
  EXPECT_THAT(refusal([] { check_gcode("; nothing\n"); }), HasSubstr("no command"));
}

TEST(GcodeCodec, LongestAcceptedLineFitsMarlin) {
  EXPECT_TRUE(rc::check([] {
    const auto text = *rc::gen::container<std::string>(rc::gen::inRange<char>('A', 'Z'));
    const std::string program = "G1 X" + text;
    const std::string framed = numbered_gcode(99'999'999, program);
    bool refused = false;
    try {
      check_gcode(program);
    } catch (const Error&) {
      refused = true;
    }
    RC_ASSERT(refused == (program.size() > 81 || program.find("M110") != std::string::npos));
    RC_ASSERT(refused || framed.size() - 1 <= 95);
  }));
}

GcodeReplyKind kind(std::string_view line) { return read_gcode_reply(line).kind; }

TEST(GcodeCodec, ReadsReplies) {
  EXPECT_EQ(kind("ok"), GcodeReplyKind::kOk);
  EXPECT_EQ(kind("ok N2 P14 B3\r"), GcodeReplyKind::kOk);
  EXPECT_TRUE(read_gcode_reply("ok T:21.87 /0.00 B:21.87 /0.00 @:0 B@:0").has_temperature);
  EXPECT_FALSE(read_gcode_reply("ok").has_temperature);
  EXPECT_TRUE(read_gcode_reply("ok PROTOCOL_VERSION:0.1 FIRMWARE_NAME:Sailfish").has_firmware);
  EXPECT_EQ(kind("okay"), GcodeReplyKind::kOther);
  EXPECT_EQ(kind(" T:21.87 /0.00 B:21.87 /0.00 @:0 B@:0 W:?"), GcodeReplyKind::kTemperature);
  for (const char* line : {"Resend: 3", "Resend:3", "rs 3", "Resend: N:3", "resend 3", "rs N3"}) {
    EXPECT_EQ(kind(line), GcodeReplyKind::kResend) << line;
    EXPECT_EQ(read_gcode_reply(line).number, 3u) << line;
  }
  EXPECT_EQ(kind("echo:busy: processing"), GcodeReplyKind::kBusy);
  EXPECT_TRUE(read_gcode_reply("echo:busy: paused for user").waiting);
  EXPECT_EQ(kind("wait"), GcodeReplyKind::kIdle);
  EXPECT_EQ(kind("start"), GcodeReplyKind::kStart);
  EXPECT_EQ(kind("echo: External Reset"), GcodeReplyKind::kStart);
  EXPECT_EQ(read_gcode_reply("//action:prompt_begin Change tool").text, "Change tool");
}

// Steps are counted by letters that are heaters' too: no bed has 9864 °C, and M105 is not answered.
TEST(GcodeCodec, APositionOnOneLineIsNoTemperature) {
  const GcodeReply reply =
      read_gcode_reply("ok X:12.00 Y:3.00 Z:0.30 E:0.00 Count: A:0 B:9864 C:2460");
  EXPECT_EQ(reply.kind, GcodeReplyKind::kOk);
  EXPECT_TRUE(reply.has_position);
  EXPECT_FALSE(reply.has_temperature);
  EXPECT_TRUE(reply.heaters.empty());
  EXPECT_EQ(kind("X:12.00 Y:3.00 Z:0.30 E:0.00 Count A:0 B:9864"), GcodeReplyKind::kPosition);
}

// Marlin's, Repetier's and Klipper's words for having stopped.
TEST(GcodeCodec, WordsOfAStop) {
  for (const char* line :
       {"Error:Printer halted. kill() called!", "Error:!! KILL caused by KILL button/pin",
        "Error:!! STOP called because of unhomed error - restart with M999",
        "Error:Printer stopped due to errors. Fix the error and use M999 to restart",
        "Printer stopped due to errors. Fix the error and use M999 to restart.",
        "fatal: Heater/sensor error - Printer stopped and heaters disabled due to this error.",
        "!! Shutdown due to M112 command", "error:printer HALTED"})
    EXPECT_EQ(kind(line), GcodeReplyKind::kStopped) << line;
  for (const char* line : {"Error:MAXTEMP triggered, system stopped! Heater_ID: bed",
                           "Error:Heating failed, system stopped! Heater_ID: 0"}) {
    EXPECT_EQ(kind(line), GcodeReplyKind::kStopped) << line;
    EXPECT_TRUE(read_gcode_reply(line).heater_failed) << line;
  }
  EXPECT_EQ(kind("!! Move out of range: 500.000 0.000 0.000 [0.000]"), GcodeReplyKind::kRefused);
  EXPECT_EQ(kind("echo:halted"), GcodeReplyKind::kOther) << "what a program has it say";
}

TEST(GcodeCodec, CommandsThatThePrinterDoesNotKnow) {
  for (const char* line : {"// Unknown command:\"M600\"", "echo:Unknown command: \"M600 U5 L5\"",
                           "Unknown command:M600"}) {
    EXPECT_EQ(kind(line), GcodeReplyKind::kUnknown) << line;
    EXPECT_EQ(read_gcode_reply(line).text, "M600") << line;
  }
}

TEST(GcodeCodec, ActionsHoweverTheyAreSpelt) {
  for (const std::string start : {"//action:", "// action:", "//  action:"}) {
    EXPECT_EQ(kind(start + "cancel"), GcodeReplyKind::kCancel);
    EXPECT_EQ(kind(start + "pause"), GcodeReplyKind::kPause);
    EXPECT_FALSE(read_gcode_reply(start + "pause").waiting);
    EXPECT_TRUE(read_gcode_reply(start + "paused").waiting);
    EXPECT_EQ(kind(start + "resume"), GcodeReplyKind::kResume);
    EXPECT_EQ(kind(start + "resumed"), GcodeReplyKind::kResume);
  }
  EXPECT_EQ(kind("// what action:cancel does"), GcodeReplyKind::kOther);
}

// The Resend that follows says what to do.
TEST(GcodeCodec, ErrorsThatMayBeHarmless) {
  for (const char* line : {"Error:checksum mismatch, Last Line: 2", "Error:checksum misoatch",
                           "Error:Line Number is not Last Line Number+1, Last Line: 3",
                           "Error:No Checksum with line number, Last Line: 8"})
    EXPECT_EQ(kind(line), GcodeReplyKind::kError) << line;
}

TEST(S3gCodec, FramesAsTheFirmwareExpects) {
  EXPECT_EQ(hex(s3g::packet(std::string("\0\x64\0", 3))), "d50300640061");
  EXPECT_EQ(hex(s3g::packet("\x81\xC4\x02")), "d50381c402fa");
  EXPECT_EQ(hex(s3g::packet("\x80")), "d501808c");
  EXPECT_EQ(hex(s3g::packet("\x83")), "d501836e");
  EXPECT_EQ(hex(s3g::packet("\x84")), "d50184ed");
  EXPECT_EQ(hex(s3g::packet("\x85")), "d50185b3");
  EXPECT_EQ(hex(s3g::packet("\x8C")), "d5018c2f");
}

TEST(S3gCodec, ReadsRepliesInPiecesAndBetweenNoise) {
  EXPECT_TRUE(rc::check([](const std::vector<std::string>& payloads) {
    std::string bytes;
    std::vector<std::string> sent;
    for (const std::string& payload : payloads) {
      if (payload.empty() || payload.size() > 32) continue;
      sent.push_back(payload);
      bytes += "\x01\x02" + s3g::packet(payload);
    }
    s3g::ReplyReader reader;
    std::vector<std::string> got;
    for (char c : bytes) {
      reader.push({&c, 1});
      while (const auto reply = reader.next())
        if (reply->intact) got.push_back(reply->payload);
    }
    RC_ASSERT(got == sent);
  }));
}

TEST(S3gCodec, SplitsAProgram) {
  const X3gProgram program = x3g_program(20);
  std::vector<std::string> actions;
  for (std::string_view action : s3g::Actions(program.bytes))
    actions.push_back(hex(std::string(action)));
  EXPECT_EQ(actions, program.actions);
}

TEST(S3gCodec, RefusesWhatTheFirmwareWouldChokeOn) {
  const std::string start("\x99\0\0\0\0a\0", 7);
  EXPECT_THAT(refusal([&] { check_x3g(start + "\xFF"); }), HasSubstr("unknown action 0xFF"));
  EXPECT_THAT(refusal([&] { check_x3g(start + "\x9B\x01"); }), HasSubstr("cut short"));
  EXPECT_THAT(refusal([&] { check_x3g(start + std::string("\x98\0", 2)); }),
              HasSubstr("factory settings"));
  EXPECT_THAT(
      refusal([&] { check_x3g(start + std::string("\x88\0\x03\x40", 4) + std::string(64, 'a')); }),
      HasSubstr("too long"));
  EXPECT_THAT(refusal([] { check_x3g(""); }), HasSubstr("empty"));
}

TEST(S3gCodec, AnyBytesAreSplitOrRefused) {
  EXPECT_TRUE(rc::check([](const std::string& bytes) {
    try {
      std::size_t total = 0;
      for (std::string_view action : s3g::Actions(bytes)) total += action.size();
      RC_ASSERT(total == bytes.size());
    } catch (const Error& error) {
      RC_ASSERT(error.fault() == Fault::kBadInput);
    }
  }));
}

TEST(S3gCodec, CutsTheBuildName) {
  EXPECT_EQ(hex(s3g::build_start("bunny")), "990000000062756e6e7900");
  EXPECT_EQ(s3g::build_start(std::string(100, 'a')).size(), 32u);
}

}  // namespace
}  // namespace packmerger::test
